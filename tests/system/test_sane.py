"""Scans with SANE itself: its test backend with every fault it can play, and a network scanner of ours.

Needs the packages sane-utils and sane-airscan; without them these tests fail.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import cv2
import numpy as np
import pytest

from daemon.config import Options, Settings, load_settings
from daemon.intake.decode import decode
from daemon.intake.sane import ScannerTrouble
from daemon.intake.scanner import BUSY_RETRY_S, BUSY_TRIES, Scanner, Wanted
from daemon.jobs.journal import Job
from daemon.jobs.states import State
from tests.daemon.test_every_device import check_ink
from tests.daemon.test_service import Daemon, ended, running
from tests.system import escl

pytestmark = pytest.mark.system

DRAWINGS = Path(__file__).parents[1] / "drawings"
SMALL = (40.0, 30.0)
DPI = 150
PAGE_DPI = 300
_BOX = "[sheet]\nbox_mm = [190, 190]\nbox_origin_mm = [5, 5]\n"
"""The middle of a true-size page lies in the middle of the box."""


@pytest.fixture
def sane(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """SANE's settings, of this test alone: nothing but the test backend."""
    folder = tmp_path / "sane"
    folder.mkdir()
    (folder / "dll.conf").write_text("test\n")
    (folder / "test.conf").write_text("number_of_devices 1\n")
    monkeypatch.setenv("SANE_CONFIG_DIR", str(folder))
    return folder


@contextmanager
def scanner_of(
    folder: Path,
    *,
    device: str = "test:0",
    source: str = "",
    page_within_s: float = 30.0,
    size_mm: tuple[float, float] = SMALL,
    **options: str,
) -> Iterator[tuple[Scanner, Path, list[float]]]:
    """The scanner, its inbox, and how long it has waited. A key of options with _ stands for one with -."""
    (folder / "inbox").mkdir()
    said = {name.replace("_", "-"): value for name, value in options.items()}
    wanted = Wanted(device, DPI, "Gray", source, size_mm, said, page_within_s)
    waited = list[float]()
    with closing(Scanner(wanted, folder / "inbox", wait=waited.append)) as scanner:
        yield scanner, folder / "inbox", waited
    assert [path.name for path in (folder / "inbox").iterdir() if path.name.startswith(".")] == []


def test_a_page_is_as_large_as_was_asked_for_and_states_its_resolution(sane: Path, tmp_path: Path) -> None:
    with scanner_of(tmp_path, test_picture="Grid") as (scanner, inbox, _):
        assert scanner.scan() == "1 page scanned into the inbox"
        (path,) = inbox.iterdir()
        page = decode(path)
    assert page.px_per_mm == pytest.approx(DPI / 25.4)
    assert page.grey.shape == pytest.approx((SMALL[1] * DPI / 25.4, SMALL[0] * DPI / 25.4), abs=1)
    assert set(np.unique(page.grey)) == {0, 255}


def test_the_resolution_is_the_scanners_own_where_it_takes_another(sane: Path, tmp_path: Path) -> None:
    with scanner_of(tmp_path, resolution="5000") as (scanner, inbox, _):
        scanner.scan()
        page = decode(next(inbox.iterdir()))
    assert page.px_per_mm == pytest.approx(1200 / 25.4)
    assert page.grey.shape == pytest.approx((SMALL[1] * 1200 / 25.4, SMALL[0] * 1200 / 25.4), abs=1)


@pytest.mark.parametrize(
    ("mode", "depth"), [("Gray", "1"), ("Gray", "8"), ("Gray", "16"), ("Color", "8"), ("Color", "16")]
)
def test_pages_of_every_depth_are_read(sane: Path, tmp_path: Path, mode: str, depth: str) -> None:
    with scanner_of(tmp_path, mode=mode, depth=depth, test_picture="Solid black") as (scanner, inbox, _):
        scanner.scan()
        assert decode(next(inbox.iterdir())).grey.max() == 0


def test_the_only_scanner_is_found_and_of_two_none_is_chosen(sane: Path, tmp_path: Path) -> None:
    with scanner_of(tmp_path, device="") as (scanner, inbox, _):
        scanner.scan()
        assert len(list(inbox.iterdir())) == 1
    (sane / "test.conf").write_text("number_of_devices 2\n")
    with (
        closing(Scanner(Wanted(), inbox)) as scanner,
        pytest.raises(ScannerTrouble, match="2 scanners, test:0, test:1"),
    ):
        scanner.scan()


def test_without_any_scanner_it_says_what_to_look_for(sane: Path, tmp_path: Path) -> None:
    (sane / "dll.conf").write_text("\n")
    with (
        scanner_of(tmp_path, device="") as (scanner, _, _),
        pytest.raises(ScannerTrouble, match="no scanner is found: switch it on"),
    ):
        scanner.scan()


def test_a_feeder_gives_its_ten_pages(sane: Path, tmp_path: Path) -> None:
    with scanner_of(tmp_path, source="Automatic Document Feeder") as (scanner, inbox, _):
        assert scanner.scan() == "10 pages scanned into the inbox"
        assert len(list(inbox.iterdir())) == 10


@pytest.mark.parametrize(
    ("status", "sentence"),
    [
        ("UNSUPPORTED", "does not do what it was asked"),
        ("CANCELLED", "was cancelled at the scanner"),
        ("INVAL", "does not take a setting"),
        ("JAMMED", "paper is jammed in the scanner's feeder"),
        ("NO_DOCS", r"feeder is empty \(sane_read: Document feeder out of documents\): put pages in"),
        ("COVER_OPEN", r"lid is open \(sane_read: Scanner cover is open\): close it"),
        ("IO_ERROR", "connection to the scanner broke off"),
        ("NO_MEM", "no memory left for the page"),
        ("ACCESS_DENIED", "add the user to the group scanner"),
    ],
)
def test_each_status_is_said_with_its_remedy_and_not_tried_again(
    sane: Path, tmp_path: Path, status: str, sentence: str
) -> None:
    with scanner_of(tmp_path, read_return_value=f"SANE_STATUS_{status}") as (scanner, inbox, waited):
        with pytest.raises(ScannerTrouble, match=sentence):
            scanner.scan()
        assert list(inbox.iterdir()) == []
        assert waited == []


def test_busy_is_tried_again_and_then_said(sane: Path, tmp_path: Path) -> None:
    with scanner_of(tmp_path, read_return_value="SANE_STATUS_DEVICE_BUSY") as (scanner, _, waited):
        with pytest.raises(ScannerTrouble, match=r"in use by another program or computer \(sane_read: Device busy\)"):
            scanner.scan()
        assert waited == [BUSY_RETRY_S] * (BUSY_TRIES - 1)


@pytest.mark.parametrize(
    "oddity",
    [
        {"hand_scanner": "yes"},
        {"mode": "Color", "three_pass": "yes"},
        {"fuzzy_parameters": "yes"},
        {"ppl_loss": "7"},
        {"non_blocking": "yes"},
        {"select_fd": "yes"},
        {"read_limit": "yes", "read_limit_size": "7"},
        {"read_delay": "yes", "read_delay_duration": "1000"},
        {"depth": "16", "invert_endianess": "yes"},
    ],
)
def test_odd_scanners_still_give_a_page_that_is_read(sane: Path, tmp_path: Path, oddity: dict[str, str]) -> None:
    with scanner_of(tmp_path, **oddity) as (scanner, inbox, _):
        assert scanner.scan() == "1 page scanned into the inbox"
        assert min(decode(next(inbox.iterdir())).grey.shape) > 100


def test_a_scanner_that_takes_too_long_is_stopped_and_leaves_no_part_of_a_page(sane: Path, tmp_path: Path) -> None:
    slow = {"resolution": "600", "read_delay": "yes", "read_delay_duration": "200000"}
    with scanner_of(tmp_path, page_within_s=1.0, size_mm=(200.0, 200.0), **slow) as (scanner, inbox, _):
        with pytest.raises(ScannerTrouble, match="the scanner gave nothing for 1 s"):
            scanner.scan()
        assert list(inbox.iterdir()) == []


@pytest.mark.parametrize(
    ("device", "options", "sentence"),
    [
        ("nosuch:0", {}, "there is no such scanner"),
        ("test:0", {"mode": "Sepia"}, r"does not take a setting \(setting of option --mode failed"),
        ("test:0", {"colour": "yes"}, r"does not take a setting \(unrecognized option '--colour=yes'"),
    ],
)
def test_a_setting_that_does_not_suit_the_scanner_is_named(
    sane: Path, tmp_path: Path, device: str, options: dict[str, str], sentence: str
) -> None:
    with (
        scanner_of(tmp_path, device=device, **options) as (scanner, _, _),
        pytest.raises(ScannerTrouble, match=sentence),
    ):
        scanner.scan()


def test_a_sensor_of_the_scanner_is_read(sane: Path, tmp_path: Path) -> None:
    with scanner_of(tmp_path, enable_test_options="yes") as (scanner, _, _):
        assert scanner.pressed("bool-hard-select-soft-detect") is False
        with pytest.raises(ScannerTrouble, match=r"nothing of a button 'mode', but of .*bool-hard-select-soft-detect"):
            scanner.pressed("mode")


def airscan(sane: Path, url: str) -> None:
    (sane / "dll.conf").write_text("airscan\n")
    (sane / "airscan.conf").write_text(
        f'[devices]\n"Ours" = {url}, eSCL\n[options]\ndiscovery = disable\nsocket_dir = {sane}\n'
    )


def jpeg_of(name: str, folder: Path) -> Path:
    """A drawing of ours as a scanner sends it."""
    picture = cv2.imread(str(DRAWINGS / name), cv2.IMREAD_GRAYSCALE)
    path = folder / f"{name}.jpg"
    assert cv2.imwrite(str(path), np.asarray(picture), [cv2.IMWRITE_JPEG_QUALITY, 92])
    return path


def settings_of(root: Path, pages: list[Path], scanner: str = "") -> Settings:
    """The glass is scanned as far as the largest of the pages reaches."""
    shapes = [np.asarray(cv2.imread(str(page), cv2.IMREAD_GRAYSCALE)).shape for page in pages]
    high_mm, wide_mm = np.max(shapes, axis=0) * 25.4 / PAGE_DPI
    scanner = f"size_mm = [{wide_mm}, {high_mm}]\n{scanner}"
    file = root / "linedrawd.toml"
    file.write_text(f"[intake]\nsettle_s = 0.02\n{_BOX}[scanner]\nresolution_dpi = {PAGE_DPI}\n{scanner}\n")
    options = Options(config=file, device="sim", state_dir=root / "state", scanner="sane")
    return load_settings(options, environment={"HOME": str(root)})


def scanned(daemon: Daemon, pages: int) -> list[Job]:
    assert f"{pages} page" in daemon.order("scan")
    return daemon.wait_for(lambda jobs: len(jobs) == pages and ended(jobs))


def test_from_paper_to_ink_in_its_true_size(sane: Path, tmp_path: Path) -> None:
    page = jpeg_of("house.png", tmp_path)
    with escl.serving(escl.Scanner([page])) as url:
        airscan(sane, url)
        with running(settings_of(tmp_path, [page]), planner=None) as daemon:
            (job,) = scanned(daemon, 1)
            report = check_ink(daemon.folder(job))
    assert report["fidelity"]["f1"] > 0.98
    assert report["from_px"][0][0] == pytest.approx(25.4 / PAGE_DPI)
    ink_px = np.argwhere(np.asarray(cv2.imread(str(page), cv2.IMREAD_GRAYSCALE)) < 128)
    high_mm, wide_mm = np.ptp(ink_px, axis=0) * 25.4 / PAGE_DPI
    ink = json.loads((daemon.folder(job) / "ink.json").read_text())["strokes"]
    drawn_mm = np.ptp(np.concatenate([np.array(stroke) for stroke in ink if len(stroke) > 1]), axis=0)
    # A pen line of a few pixels is drawn along its middle.
    assert drawn_mm == pytest.approx((wide_mm, high_mm), abs=6 * 25.4 / PAGE_DPI)


def test_each_page_of_a_network_scanners_feeder_is_drawn(sane: Path, tmp_path: Path) -> None:
    names = ["star.png", "spiral.png", "flower.png"]
    pages = [jpeg_of(name, tmp_path) for name in names]
    scanner = escl.Scanner(pages)
    with escl.serving(scanner) as url:
        airscan(sane, url)
        with running(settings_of(tmp_path, pages, "source = 'ADF'"), planner=None) as daemon:
            jobs = scanned(daemon, 3)
            for job in jobs:
                assert job.state is State.DONE, job.words
                check_ink(daemon.folder(job))
    assert "Feeder" in scanner.asked[0]
    assert [job.name[-7:] for job in jobs] == ["-1.tiff", "-2.tiff", "-3.tiff"]


def test_a_network_scanner_that_is_busy_for_a_while_is_waited_for(sane: Path, tmp_path: Path) -> None:
    scanner = escl.Scanner([jpeg_of("star.png", tmp_path)], busy=2)
    with escl.serving(scanner) as url:
        airscan(sane, url)
        with scanner_of(tmp_path, device="") as (ours, inbox, _):
            assert ours.scan() == "1 page scanned into the inbox"
            assert len(list(inbox.iterdir())) == 1
    assert len(scanner.asked) == 3


def test_a_network_scanner_that_is_switched_off_is_named_with_a_remedy(sane: Path, tmp_path: Path) -> None:
    with escl.serving(escl.Scanner([])) as url:
        airscan(sane, url)
    with (
        scanner_of(tmp_path, device="") as (scanner, _, _),
        pytest.raises(ScannerTrouble, match=r"connection to the scanner broke off .*: check its cable or network"),
    ):
        scanner.scan()
