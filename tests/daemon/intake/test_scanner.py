"""Scans with a scanimage of ours: what it is asked, what comes into the inbox, and what is said when nothing does."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from daemon.errors import DiskTrouble
from daemon.intake.decode import decode
from daemon.intake.sane import ScannerTrouble, trouble_of
from daemon.intake.scan_button import UNREACHABLE_RETRY_S, ScanButton
from daemon.intake.scanimage import Scanimage
from daemon.intake.scanner import BUSY_RETRY_S, BUSY_TRIES, Scanner, Wanted, is_scan
from daemon.intake.spool import remove_leftovers, spool_in
from tests.daemon.intake.scans import ANY, PAGE, Fake

FEEDER = Wanted(device="fake:0", source="ADF Front")
ONE = Wanted(device="fake:0")


@contextmanager
def fake(folder: Path, *turns: dict[str, Any], wanted: Wanted = ONE, **plan: Any) -> Iterator[Fake]:
    made = Fake(folder, *(turns or ({},)), wanted=wanted, **plan)
    try:
        yield made
    finally:
        made.scanner.close()


def test_a_page_comes_into_the_inbox_whole_and_knows_its_resolution(tmp_path: Path) -> None:
    with fake(tmp_path) as scans:
        assert scans.scanner.scan() == "1 page scanned into the inbox"
        assert scans.pages == ["scan-20261124-125043-1.tiff"]
        page = scans.inbox / scans.pages[0]
        assert page.read_bytes() == PAGE
        assert decode(page).px_per_mm == pytest.approx(300 / 25.4)
        assert is_scan(page.name)


def test_it_is_asked_for_one_page_of_the_glass_as_tiff_in_a_batch(tmp_path: Path) -> None:
    wanted = Wanted("fake:0", 600, "Color", "Flatbed", (210, 297), {"brightness": "10", "button-update": ""})
    with fake(tmp_path, wanted=wanted) as scans:
        scans.scanner.scan()
    (call,) = scans.calls
    spool = call.partition("--batch=")[2].partition("/%d.tiff")[0]
    assert Path(spool).parent == scans.inbox
    assert call.replace(spool, "SPOOL") == (
        "-d fake:0 --format=tiff --batch-print --batch=SPOOL/%d.tiff --batch-count=1 --source=Flatbed --mode=Color "
        "--resolution=600 --brightness=10 --button-update -x 210 -y 297"
    )


def test_a_feeder_is_emptied_and_each_page_is_a_picture(tmp_path: Path) -> None:
    with fake(tmp_path, {"pages": 12}, wanted=FEEDER) as scans:
        assert scans.scanner.scan() == "12 pages scanned into the inbox"
        assert len(scans.pages) == 12
        assert "--batch-count" not in scans.calls[0]


def test_a_second_scan_of_the_same_second_replaces_nothing(tmp_path: Path) -> None:
    with fake(tmp_path) as scans:
        scans.scanner.scan()
        scans.scanner.scan()
        assert scans.pages == ["scan-20261124-125043-1.tiff", "scan-20261124-125043-2.tiff"]


def test_pages_that_are_claimed_at_once_still_have_names_of_their_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    claimed, rename = list[str](), Path.rename

    def rename_and_claim(page: Path, name: Path) -> Path:
        rename(page, name).unlink()
        claimed.append(name.name)
        return name

    with fake(tmp_path, {"pages": 3}, wanted=FEEDER) as scans:
        monkeypatch.setattr(Path, "rename", rename_and_claim)
        scans.scanner.scan()
    assert claimed == [f"scan-20261124-125043-{number}.tiff" for number in (1, 2, 3)]


def test_the_only_scanner_is_taken_and_cameras_are_none(tmp_path: Path) -> None:
    with fake(tmp_path, wanted=ANY, devices=["v4l:/dev/video0", "airscan:e0:Office"]) as scans:
        scans.scanner.scan()
        scans.scanner.scan()
    listed, *calls = scans.calls
    assert listed == "--formatted-device-list=%d%n"
    assert [call.split(" --")[0] for call in calls] == ["-d airscan:e0:Office"] * 2


def test_two_scanners_are_named_and_none_is_chosen(tmp_path: Path) -> None:
    with (
        fake(tmp_path, wanted=ANY, devices=["a:1", "b:2"]) as scans,
        pytest.raises(ScannerTrouble, match="2 scanners, a:1, b:2: say which one with --scanner"),
    ):
        scans.scanner.scan()


def test_without_a_scanner_it_says_so(tmp_path: Path) -> None:
    with (
        fake(tmp_path, wanted=ANY, devices=[]) as scans,
        pytest.raises(ScannerTrouble, match="no scanner is found: switch it on"),
    ):
        scans.scanner.scan()


def test_a_busy_scanner_is_tried_again(tmp_path: Path) -> None:
    busy = {"pages": 0, "status": 3, "words": "scanimage: sane_start: Device busy"}
    with fake(tmp_path, busy, busy, {}) as scans:
        assert scans.scanner.scan() == "1 page scanned into the inbox"
        assert scans.waited == [BUSY_RETRY_S] * 2


def test_a_scanner_that_stays_busy_is_given_up(tmp_path: Path) -> None:
    busy = {"pages": 0, "status": 1, "words": "scanimage: open of device fake:0 failed: Device busy"}
    with fake(tmp_path, busy) as scans:
        with pytest.raises(ScannerTrouble, match="in use by another program"):
            scans.scanner.scan()
        assert len(scans.calls) == BUSY_TRIES


@pytest.mark.parametrize(
    ("status", "sentence"),
    [
        (1, "does not do what it was asked"),
        (2, "cancelled at the scanner: scan again"),
        (4, "does not take a setting"),
        (6, "paper is jammed"),
        (7, "feeder is empty: put pages in"),
        (8, "lid is open: close it"),
        (9, "connection to the scanner broke off"),
        (10, "no memory left"),
        (11, "add the user to the group scanner"),
        (77, "status 77"),
    ],
)
def test_every_other_status_is_said_at_once_with_its_remedy(tmp_path: Path, status: int, sentence: str) -> None:
    with fake(tmp_path, {"pages": 0, "status": status}) as scans:
        with pytest.raises(ScannerTrouble, match=sentence):
            scans.scanner.scan()
        assert len(scans.calls) == 1
        assert scans.pages == []


def test_the_drivers_own_words_stand_before_the_remedy_without_our_folders() -> None:
    assert trouble_of(8, "Scanning page 1\nscanimage: sane_start: Scanner cover is open\nBatch terminated") == (
        "the scanner's lid is open (sane_start: Scanner cover is open): close it, then scan again"
    )
    assert "(sane_start: x)" in trouble_of(9, "scanimage: rounded value of x\nscanimage: sane_start: x")


def test_pages_before_a_jam_are_kept_and_counted_and_not_scanned_again(tmp_path: Path) -> None:
    with fake(tmp_path, {"pages": 3, "status": 6}, wanted=FEEDER) as scans:
        with pytest.raises(ScannerTrouble, match=r"^3 pages scanned into the inbox, then paper is jammed"):
            scans.scanner.scan()
        assert len(scans.pages) == 3


def test_busy_in_the_middle_of_a_feeder_repeats_no_page(tmp_path: Path) -> None:
    with fake(tmp_path, {"pages": 2, "status": 3}, wanted=FEEDER) as scans:
        with pytest.raises(ScannerTrouble, match="2 pages"):
            scans.scanner.scan()
        assert len(scans.calls) == 1


def test_no_page_and_no_word_of_trouble_is_trouble(tmp_path: Path) -> None:
    with fake(tmp_path, {"pages": 0}) as scans, pytest.raises(ScannerTrouble, match="had no more to give"):
        scans.scanner.scan()


def test_a_crash_of_the_driver_is_named_and_leaves_nothing(tmp_path: Path) -> None:
    with fake(tmp_path, {"pages": 0, "then": "crash"}) as scans:
        with pytest.raises(ScannerTrouble, match=r"driver has crashed \(SIGABRT\)"):
            scans.scanner.scan()
        assert scans.pages == []


@pytest.mark.parametrize(("then", "last"), [("hang", "died"), ("hang deaf", "hangs")])
def test_a_scanner_that_gives_nothing_is_stopped_gently_then_by_force(tmp_path: Path, then: str, last: str) -> None:
    wanted = Wanted(device="fake:0", page_within_s=1.5)
    with fake(tmp_path, {"then": then}, wanted=wanted) as scans:
        with pytest.raises(
            ScannerTrouble, match=r"^1 page scanned into the inbox, then the scanner gave nothing for 1.5 s"
        ):
            scans.scanner.scan()
        assert scans.calls[-1] == last
        assert scans.pages == ["scan-20261124-125043-1.tiff"]


def test_what_the_driver_has_started_ends_with_it(tmp_path: Path) -> None:
    with fake(tmp_path, {"then": "child stays"}) as scans:
        scans.scanner.scan()
        stat = Path(f"/proc/{scans.calls[-1].removeprefix('child ')}/stat")
    for _ in range(3000):
        if not stat.exists() or ") Z " in stat.read_text():
            return
        threading.Event().wait(0.01)
    pytest.fail("the child of the driver lives on")


def test_parts_of_pages_are_removed(tmp_path: Path) -> None:
    with fake(tmp_path, {"pages": 1, "then": "page half written"}) as scans:
        scans.scanner.scan()
        assert scans.pages == ["scan-20261124-125043-1.tiff"]


def test_an_end_stops_the_scan_and_none_begins_after_it(tmp_path: Path) -> None:
    with fake(tmp_path, {"pages": 0, "then": "hang"}) as scans:
        said = list[str]()

        def scan() -> None:
            try:
                scans.scanner.scan()
            except ScannerTrouble as error:
                said.append(str(error))

        thread = threading.Thread(target=scan)
        thread.start()
        scans.wait_for_call("hangs")
        with pytest.raises(ScannerTrouble, match="is scanning: wait"):
            scans.scanner.scan()
        assert scans.scanner.pressed("scan") is False
        scans.scanner.end()
        thread.join(20)
        assert scans.calls[-1] == "died"
        assert "broken off, because linedrawd ends" in said[0]
        with pytest.raises(ScannerTrouble, match="is ending"):
            scans.scanner.scan()


def test_without_scanimage_it_names_the_package(tmp_path: Path) -> None:
    scanner = Scanner(ONE, tmp_path, scanimage=Scanimage(program=str(tmp_path / "none")))
    with pytest.raises(ScannerTrouble, match="install the package sane-utils"):
        scanner.scan()
    scanner.close()


def test_an_inbox_that_takes_no_page_says_so(tmp_path: Path) -> None:
    with fake(tmp_path) as scans:
        scans.inbox.rename(tmp_path / "gone")
        with pytest.raises(DiskTrouble, match="nothing can be put into the inbox"):
            scans.scanner.scan()


def test_what_a_power_cut_left_is_removed_and_what_another_scans_is_not(tmp_path: Path) -> None:
    (tmp_path / ".scan-old").mkdir()
    (tmp_path / ".scan-old" / "1.tiff.part").write_bytes(b"II")
    with spool_in(tmp_path) as spool:
        assert list(tmp_path.iterdir()) == [spool]
        remove_leftovers(tmp_path)
        assert spool.is_dir()
    assert list(tmp_path.iterdir()) == []


def options(value: str) -> dict[str, str]:
    shown = f"  Sensors:\n    --scan[=(yes|no)] [{value}] [hardware]\n        Scan button.\n"
    return {"options": shown + "    --gain <int> [3] [advanced]\n    --button-1 <int> [0] [read-only]"}


def test_the_button_scans_once_each_time_that_it_is_pressed(tmp_path: Path) -> None:
    turns = [options("no"), options("yes"), {}, options("yes"), options("no"), options("yes"), {}]
    with fake(tmp_path, *turns) as scans:
        said, trouble = list[str](), list[str]()
        button = ScanButton(scans.scanner, "scan", every_s=0.5, said=said.append, trouble=trouble.append)
        counts = []
        for _ in range(5):
            assert button.step() == 0.5
            counts.append(len(said))
        assert counts == [0, 1, 1, 1, 2]
        assert trouble == []
        assert len(scans.pages) == 2


def test_a_button_that_the_scanner_does_not_have_is_told_once_with_those_it_has(tmp_path: Path) -> None:
    with fake(tmp_path, options("no")) as scans:
        trouble = list[str]()
        button = ScanButton(scans.scanner, "copy", every_s=0.5, said=print, trouble=trouble.append)
        assert [button.step(), button.step()] == [UNREACHABLE_RETRY_S] * 2
        assert len(trouble) == 1
        assert "nothing of a button 'copy', but of scan, button-1: correct button" in trouble[0]


def test_a_scan_by_the_button_that_fails_is_told(tmp_path: Path) -> None:
    with fake(tmp_path, options("yes"), {"pages": 0, "status": 8}) as scans:
        trouble = list[str]()
        ScanButton(scans.scanner, "scan", every_s=0.5, said=print, trouble=trouble.append).step()
        assert "lid is open" in trouble[0]
