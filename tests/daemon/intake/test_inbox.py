"""A picture is claimed once it has stopped growing; what is no picture is refused with a sentence and left."""

from __future__ import annotations

import os
import stat
import tempfile
from collections.abc import Iterator
from pathlib import Path
from threading import Event

import pytest

from daemon.errors import DiskTrouble
from daemon.intake.inbox import AT_ONCE, Inbox

SETTLE_S = 1.0
NOBODY = 65534


class Desk:
    """An inbox whose pictures are moved to a second folder, and all that it said."""

    def __init__(self, root: Path) -> None:
        self.inbox_dir, self.taken_dir = root / "inbox", root / "taken"
        self.inbox_dir.mkdir()
        self.taken_dir.mkdir()
        self.taken: list[str] = []
        self.refused: list[str] = []
        self.sheets = 0
        self.full = False
        self.took = Event()
        self.inbox = Inbox(
            self.inbox_dir,
            settle_s=SETTLE_S,
            claim=self.claim,
            refuse=self.refused.append,
            signs={"NEXT": self.sheet},
        )

    def claim(self, picture: Path, beside: Path | None) -> None:
        if self.full:
            raise DiskTrouble("the disk is full: free it")
        picture.rename(self.taken_dir / f"{len(self.taken)}")
        self.taken.append(picture.name)
        self.took.set()

    def sheet(self) -> None:
        self.sheets += 1

    def drop(self, name: str, text: str = "picture") -> Path:
        (self.inbox_dir / name).write_text(text)
        return self.inbox_dir / name


@pytest.fixture
def desk(tmp_path: Path) -> Desk:
    return Desk(tmp_path)


def test_a_picture_that_was_closed_is_claimed_after_the_settling_time(desk: Desk) -> None:
    desk.drop("a.png")
    desk.inbox.notice("a.png", closed=True)
    assert desk.inbox.step(10.0) == 11.0
    desk.inbox.step(10.9)
    assert desk.taken == []
    assert desk.inbox.step(11.0) is None
    assert desk.taken == ["a.png"]


def test_a_picture_that_nobody_closed_settles_three_times_longer(desk: Desk) -> None:
    desk.drop("a.png")
    assert desk.inbox.step(10.0) == 13.0
    desk.inbox.step(13.0)
    assert desk.taken == ["a.png"]


def test_a_picture_that_has_lain_there_since_long_before_the_start_is_claimed_at_once(tmp_path: Path) -> None:
    desk = Desk(tmp_path)
    changed_ns = desk.drop("old.png").lstat().st_ctime_ns
    for whole_before_ns, claimed in ((changed_ns, []), (changed_ns + 1, ["old.png"])):
        inbox = Inbox(
            desk.inbox_dir,
            settle_s=SETTLE_S,
            claim=desk.claim,
            refuse=desk.refused.append,
            signs={},
            whole_before_ns=whole_before_ns,
        )
        inbox.step(0.0)
        assert desk.taken == claimed


def test_a_growing_picture_is_left_until_it_has_stopped(desk: Desk) -> None:
    for second in range(20):
        desk.drop("slow.png", "x" * second)
        desk.inbox.notice("slow.png", closed=True)
        desk.inbox.step(second * 0.9)
    assert desk.taken == []
    desk.inbox.step(19 * 0.9 + SETTLE_S)
    assert desk.taken == ["slow.png"]


def test_two_hundred_pictures_are_claimed_in_the_order_in_which_they_came(desk: Desk) -> None:
    names = [f"{number:03d}.png" for number in range(200)]
    for order, name in enumerate(reversed(names)):
        os.utime(desk.drop(name), ns=(order, order))
    desk.inbox.step(0.0)
    for _ in range(200 // AT_ONCE):
        desk.inbox.step(3.0)
    assert desk.taken == names[::-1]


def test_a_second_picture_of_the_same_name_is_claimed_too(desk: Desk) -> None:
    desk.drop("a.png", "first")
    desk.inbox.step(0.0)
    desk.inbox.step(3.0)
    desk.drop("a.png", "second")
    desk.inbox.step(4.0)
    desk.inbox.step(7.0)
    assert [(desk.taken_dir / number).read_text() for number in "01"] == ["first", "second"]


@pytest.mark.parametrize("name", [".hidden.png", "a.png.part", "a.tmp", "a.crdownload", "a.png~", ".~lock.a.png#"])
def test_what_a_sender_has_not_finished_is_ignored(desk: Desk, name: str) -> None:
    desk.drop(name)
    assert desk.inbox.step(0.0) is None
    assert desk.refused == []


def test_a_symbolic_link_is_refused_once_and_left(desk: Desk) -> None:
    (desk.inbox_dir / "link.png").symlink_to("/etc/passwd")
    desk.inbox.step(0.0)
    desk.inbox.step(100.0)
    assert desk.refused == ["link.png in the inbox is a symbolic link, no file: put the picture itself there"]
    assert (desk.inbox_dir / "link.png").is_symlink()


def test_a_pipe_is_refused_and_does_not_block(desk: Desk) -> None:
    os.mkfifo(desk.inbox_dir / "pipe.png")
    desk.inbox.step(0.0)
    desk.inbox.step(100.0)
    assert desk.refused == ["pipe.png in the inbox is a pipe, no file: put the picture itself there"]
    assert stat.S_ISFIFO((desk.inbox_dir / "pipe.png").stat().st_mode)


def test_a_folder_is_refused(desk: Desk) -> None:
    (desk.inbox_dir / "holiday").mkdir()
    desk.inbox.step(0.0)
    assert desk.refused == ["holiday in the inbox is a folder, no file: put the picture itself there"]


@pytest.fixture
def nobodys_desk() -> Iterator[Desk]:
    """Root reads everything, so root becomes nobody for the time of the test."""
    with tempfile.TemporaryDirectory() as root:
        os.chmod(root, 0o777)
        before = os.geteuid()
        if before == 0:
            os.seteuid(NOBODY)
        try:
            yield Desk(Path(root))
        finally:
            os.seteuid(before)


def test_an_unreadable_picture_is_refused_once_and_claimed_when_its_rights_are_right(nobodys_desk: Desk) -> None:
    desk = nobodys_desk
    desk.drop("secret.png").chmod(0)
    for second in range(0, 40, 4):
        desk.inbox.step(float(second))
    assert desk.refused == [
        "secret.png in the inbox cannot be read (Permission denied): correct its rights or drop it again"
    ]
    assert desk.inbox.step(40.0) is None
    (desk.inbox_dir / "secret.png").chmod(0o600)
    desk.inbox.step(41.0)
    desk.inbox.step(44.0)
    assert desk.taken == ["secret.png"]


def test_a_name_that_is_no_text_is_told_as_one_line(desk: Desk) -> None:
    os.mkfifo(os.fsencode(desk.inbox_dir) + b"/a\n\xff.png")
    desk.inbox.step(0.0)
    assert desk.refused[0].startswith("a\\n\\xff.png in the inbox is a pipe")


def test_a_picture_stays_and_is_tried_again_when_it_cannot_be_claimed(desk: Desk) -> None:
    desk.drop("a.png")
    desk.full = True
    desk.inbox.step(0.0)
    with pytest.raises(DiskTrouble):
        desk.inbox.step(3.0)
    assert (desk.inbox_dir / "a.png").exists()
    desk.full = False
    desk.inbox.step(13.0)
    desk.inbox.step(16.0)
    assert desk.taken == ["a.png"]


def test_the_file_next_says_that_a_new_sheet_is_in_and_is_removed(desk: Desk) -> None:
    desk.drop("NEXT", "")
    assert desk.inbox.step(0.0) is None
    assert desk.sheets == 1
    assert not (desk.inbox_dir / "NEXT").exists()


def test_an_inbox_that_has_gone_is_told(desk: Desk) -> None:
    desk.inbox_dir.rmdir()
    with pytest.raises(DiskTrouble, match="make it again"):
        desk.inbox.step(0.0)
