"""Many pictures, names of any kind, senders with habits of their own, and side files."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from daemon.errors import DiskTrouble, SettingsError
from daemon.intake.inbox import ALONE_S, AT_ONCE, Inbox
from daemon.intake.rank import Order
from tests.daemon.intake.test_inbox import SETTLE_S, Desk

LATER_S = 3 * SETTLE_S
MANY, WAITING = 400, 10_000
"""Enough to tell looking at each from looking at all for each."""


@pytest.fixture
def desk(tmp_path: Path) -> Desk:
    return Desk(tmp_path)


class Counted(Inbox):
    """Counts how often a file is looked at."""

    looks = 0

    def _looks(self, name: str) -> tuple[int, int, int, int]:
        self.looks += 1
        return super()._looks(name)


def counted(desk: Desk) -> Counted:
    inbox = Counted(desk.inbox_dir, settle_s=SETTLE_S, claim=desk.claim, refuse=desk.refused.append, signs={})
    desk.inbox = inbox
    return inbox


def claim_all(desk: Desk, now: float) -> None:
    while desk.inbox.step(now, everything=False) == now:
        pass


def test_pictures_that_arrive_one_by_one_are_each_looked_at_a_few_times(desk: Desk) -> None:
    inbox = counted(desk)
    for number in range(MANY):
        desk.drop(f"{number}.png", "")
        inbox.notice(f"{number}.png")
        inbox.notice(f"{number}.png", closed=True)
        inbox.step(0.0, everything=False)
    claim_all(desk, LATER_S)
    assert len(desk.taken) == MANY
    assert inbox.looks <= 6 * MANY


def test_ten_thousand_pictures_that_wait_are_claimed_in_steps_that_a_stop_need_not_wait_for(desk: Desk) -> None:
    inbox = counted(desk)
    for number in range(WAITING):
        desk.drop(f"{number}.png", "")
    inbox.step(0.0)
    inbox.step(LATER_S, everything=False)
    assert len(desk.taken) == AT_ONCE
    claim_all(desk, LATER_S)
    assert len(desk.taken) == WAITING
    assert inbox.looks <= 6 * WAITING


@pytest.mark.parametrize(
    "name",
    [
        b"my house.png",
        "Häuschen.png".encode(),
        "😀.png".encode(),
        b"two\nlines.png",
        b"x" * 251 + b".png",
        b"y" * 255,
        b"\xff\xfe\x80.png",
        b"-rf",
        b"100%.png",
    ],
)
def test_a_name_of_any_kind_is_claimed(desk: Desk, name: bytes) -> None:
    desk.drop(os.fsdecode(name))
    desk.inbox.step(0.0)
    desk.inbox.step(LATER_S)
    assert [os.fsencode(taken) for taken in desk.taken] == [name]
    assert desk.refused == []


def test_rsync_writes_beside_and_renames(desk: Desk) -> None:
    desk.drop(".a.png.Xy12Zq", "pict")
    desk.inbox.notice(".a.png.Xy12Zq", closed=True)
    assert desk.inbox.step(0.0, everything=False) is None
    (desk.inbox_dir / ".a.png.Xy12Zq").rename(desk.inbox_dir / "a.png")
    desk.inbox.notice("a.png", closed=True)
    assert desk.inbox.step(5.0, everything=False) == 5.0 + SETTLE_S
    desk.inbox.step(5.0 + SETTLE_S, everything=False)
    assert desk.taken == ["a.png"]


def test_a_sender_that_closes_twice_has_not_finished_after_the_first_time(desk: Desk) -> None:
    """SMB, and transfers that are taken up again."""
    desk.drop("a.png", "pict")
    desk.inbox.notice("a.png", closed=True)
    desk.inbox.step(0.0, everything=False)
    desk.drop("a.png", "picture whole")
    desk.inbox.step(SETTLE_S, everything=False)
    assert desk.taken == []
    desk.inbox.notice("a.png", closed=True)
    desk.inbox.step(SETTLE_S + 0.1, everything=False)
    desk.inbox.step(2 * SETTLE_S + 0.1, everything=False)
    assert [(desk.taken_dir / name).read_text() for name in "0"] == ["picture whole"]


def test_a_picture_that_grows_in_silence_is_looked_at_again_before_it_is_claimed(desk: Desk) -> None:
    """scp over a slow line: created, then nothing is told until it is closed."""
    desk.drop("a.png", "p")
    desk.inbox.notice("a.png")
    for second in range(1, 30):
        desk.inbox.step(float(second), everything=False)
        desk.drop("a.png", "p" * (second + 1))
    assert desk.taken == []
    desk.inbox.step(32.0, everything=False)
    desk.inbox.step(32.0 + LATER_S, everything=False)
    assert desk.taken == ["a.png"]


@pytest.mark.parametrize(
    ("order", "first"),
    [
        ("arrival", ["10-c.png", "b 10.png", "b 9.png", "2-a.png"]),
        ("name", ["2-a.png", "10-c.png", "b 9.png", "b 10.png"]),
        ("priority", ["2-a.png", "10-c.png", "b 10.png", "b 9.png"]),
    ],
)
def test_what_is_claimed_first(tmp_path: Path, order: Order, first: list[str]) -> None:
    desk = Desk(tmp_path)
    desk.inbox = Inbox(desk.inbox_dir, settle_s=SETTLE_S, claim=desk.claim, refuse=print, signs={}, order=order)
    for moment, name in enumerate(["10-c.png", "b 10.png", "b 9.png", "2-a.png"]):
        os.utime(desk.drop(name), ns=(moment, moment))
    desk.inbox.step(0.0)
    desk.inbox.step(LATER_S)
    assert desk.taken == first


class Wishing(Desk):
    """Remembers what lay beside each picture, and takes no picture whose side file says `wrong`."""

    def __init__(self, root: Path) -> None:
        super().__init__(root)
        self.beside: list[str | None] = []

    def claim(self, picture: Path, beside: Path | None) -> None:
        if beside is not None and beside.read_text() == "wrong":
            raise SettingsError(f"{beside.name}: that is wrong: write it right")
        super().claim(picture, beside)
        self.beside.append(None if beside is None else beside.read_text())
        if beside is not None:
            beside.unlink()


def test_a_side_file_goes_with_its_picture(tmp_path: Path) -> None:
    desk = Wishing(tmp_path)
    desk.drop("house.png")
    desk.drop("house.toml", "copies = 2")
    desk.drop("tree.png")
    desk.inbox.step(0.0)
    desk.inbox.step(LATER_S)
    assert dict(zip(desk.taken, desk.beside, strict=True)) == {"house.png": "copies = 2", "tree.png": None}
    desk.inbox.step(LATER_S + ALONE_S)
    assert desk.refused == []


def test_a_picture_waits_for_a_side_file_that_is_being_written(tmp_path: Path) -> None:
    desk = Wishing(tmp_path)
    desk.drop("house.png")
    desk.inbox.step(0.0)
    desk.drop("house.toml", "copies = 2")
    desk.inbox.notice("house.toml")
    desk.inbox.step(LATER_S, everything=False)
    assert desk.taken == []
    desk.inbox.step(2 * LATER_S, everything=False)
    assert desk.beside == ["copies = 2"]


def test_a_wrong_side_file_is_told_once_and_its_picture_is_claimed_when_it_is_right(tmp_path: Path) -> None:
    desk = Wishing(tmp_path)
    desk.drop("house.png")
    desk.drop("house.toml", "wrong")
    for moment in range(5):
        desk.inbox.step(moment * LATER_S)
    assert desk.refused == ["house.toml: that is wrong: write it right"]
    desk.drop("house.toml", "copies = 2")
    desk.inbox.notice("house.toml", closed=True)
    desk.inbox.step(20 * LATER_S, everything=False)
    desk.inbox.step(21 * LATER_S, everything=False)
    assert desk.beside == ["copies = 2"]


def test_a_side_file_alone_is_no_picture_and_that_is_told(desk: Desk) -> None:
    desk.drop("house.toml")
    desk.inbox.step(0.0)
    desk.inbox.step(ALONE_S - 0.1)
    assert desk.refused == []
    desk.inbox.step(ALONE_S)
    assert desk.refused == ["house.toml in the inbox has no picture beside it: put its picture there, or remove it"]
    assert desk.taken == []


def test_after_a_full_disk_all_that_waits_is_tried_again(desk: Desk) -> None:
    for number in range(3):
        desk.drop(f"{number}.png")
    desk.full = True
    desk.inbox.step(0.0)
    with pytest.raises(DiskTrouble):
        desk.inbox.step(LATER_S)
    desk.full = False
    desk.inbox.step(20.0)
    desk.inbox.step(20.0 + LATER_S)
    assert sorted(desk.taken) == ["0.png", "1.png", "2.png"]


def test_a_picture_that_has_gone_before_it_settled_is_forgotten(desk: Desk) -> None:
    desk.drop("a.png").unlink()
    desk.drop("b.png")
    desk.inbox.step(0.0)
    (desk.inbox_dir / "b.png").unlink()
    assert desk.inbox.step(LATER_S, everything=False) is None
    assert (desk.taken, desk.refused) == ([], [])
