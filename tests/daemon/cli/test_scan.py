"""`linedrawd scan`, alone and through the running daemon, with a scanimage of ours on the path."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from threading import Thread

import pytest

from daemon.cli.__main__ import main
from daemon.config import Options, Scanner, Settings, load_settings
from daemon.control import Order, give_order
from daemon.errors import LinedrawError, SettingsError
from daemon.jobs.scanning import scanner_of
from tests.daemon.intake.scans import Fake, fake_on_path
from tests.daemon.test_service import ended, running


@pytest.fixture
def fake(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Fake]:
    monkeypatch.setenv("HOME", str(tmp_path))
    made = fake_on_path(tmp_path, {}, monkeypatch=monkeypatch)
    yield made
    made.scanner.close()


def settings_of(text: str, folder: Path, *, scanner: str | None = None) -> Settings:
    file = folder / "linedrawd.toml"
    file.write_text(f"[intake]\nsettle_s = 0.02\n[planning]\nmemory_mb = 256\n{text}")
    options = Options(config=file, device="sim", state_dir=folder / "state", scanner=scanner)
    return load_settings(options, environment={"HOME": str(folder)})


def test_without_a_daemon_the_page_waits_in_the_inbox(
    fake: Fake, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    inbox = tmp_path / "state" / "inbox"
    assert main(["scan", "--scanner", "fake:7", "--state-dir", str(tmp_path / "state")]) == 0
    assert capsys.readouterr().out == f"1 page scanned into the inbox {inbox}, where they wait for a daemon\n"
    (page,) = inbox.iterdir()
    assert page.name.startswith("scan-")
    assert fake.calls[0].startswith("-d fake:7 ")


def test_without_a_scanner_in_the_settings_it_says_how_to_set_one(
    fake: Fake, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["scan", "--state-dir", str(tmp_path / "state")]) == 2
    assert "give --scanner sane, or a section [scanner]" in capsys.readouterr().err
    assert fake.calls == []


def test_the_running_daemon_scans_and_draws_what_it_has_scanned(
    fake: Fake, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    settings = settings_of("", tmp_path, scanner="sane")
    with running(settings) as daemon:
        assert main(["scan", "--state-dir", str(tmp_path / "state")]) == 0
        assert capsys.readouterr().out == "1 page scanned into the inbox\n"
        (job,) = daemon.wait_for(ended)
        assert job.name.startswith("scan-")
        assert "1 page scanned into the inbox" in daemon.log()


def test_a_daemon_without_a_scanner_says_so(tmp_path: Path) -> None:
    with (
        running(settings_of("", tmp_path)) as daemon,
        pytest.raises(LinedrawError, match="no scanner is set: start linedrawd with --scanner sane"),
    ):
        give_order(daemon.settings.paths.control, Order(order="scan"))


def test_the_button_of_the_scanner_is_heard_by_the_daemon(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pressed = {"options": "    --scan[=(yes|no)] [yes] [hardware]"}
    fake = fake_on_path(tmp_path, pressed, {}, pressed, monkeypatch=monkeypatch)
    with running(settings_of("[scanner]\ndevice = 'fake:0'\nbutton = 'scan'", tmp_path)) as daemon:
        (job,) = daemon.wait_for(ended)
    assert job.name.startswith("scan-")
    fake.scanner.close()


def test_an_end_of_the_daemon_breaks_the_scan_off(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pressed = {"options": "    --scan[=(yes|no)] [yes] [hardware]"}
    fake = fake_on_path(tmp_path, pressed, {"pages": 0, "then": "hang"}, monkeypatch=monkeypatch)
    with running(settings_of("[scanner]\ndevice = 'fake:0'\nbutton = 'scan'", tmp_path)) as daemon:
        fake.wait_for_call("hangs")
    assert fake.calls[-1] == "died"
    assert "broken off, because linedrawd ends" in daemon.log()
    assert list(daemon.settings.paths.inbox.iterdir()) == []
    fake.scanner.close()


def test_the_daemon_hears_other_orders_while_it_scans(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fake, refused = fake_on_path(tmp_path, {"pages": 0, "then": "hang"}, monkeypatch=monkeypatch), list[str]()
    with running(settings_of("[scanner]\ndevice = 'fake:0'", tmp_path)) as daemon:

        def scan() -> None:
            try:
                daemon.order("scan")
            except LinedrawError as error:
                refused.append(str(error))

        asking = Thread(target=scan)
        asking.start()
        fake.wait_for_call("hangs")
        assert daemon.order("ping") == "linedrawd runs"
    asking.join(20)
    assert "broken off, because linedrawd ends" in refused[0]
    fake.scanner.close()


def test_a_section_is_enough_to_have_a_scanner_and_the_command_line_wins(tmp_path: Path) -> None:
    assert settings_of("", tmp_path).scanner.kind == "none"
    assert settings_of("[scanner]", tmp_path).scanner == Scanner(kind="sane")
    assert settings_of("[scanner]\ndevice = 'a:1'", tmp_path, scanner="sane").scanner.device == "a:1"
    assert settings_of("[scanner]\ndevice = 'a:1'", tmp_path, scanner="b:2").scanner.device == "b:2"
    assert settings_of("[scanner]", tmp_path, scanner="none").scanner.kind == "none"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("resolution = 300", "[scanner] resolution is unknown: did you mean resolution_dpi?"),
        ("resolution_dpi = 20", "[scanner] resolution_dpi: Input should be greater than or equal to 50"),
        ("options = {batch-count = 3}", "'batch-count' is not the driver's: set it by a key of [scanner]"),
        ("options = {form = 'pnm'}", "'form' is not the driver's"),
        ("options = {'-o' = 'x'}", "String should match pattern"),
        ("kind = 'twain'", "[scanner] kind: Input should be 'sane' or 'none'"),
    ],
)
def test_a_wrong_setting_of_the_scanner_is_refused_with_its_cure(text: str, sentence: str, tmp_path: Path) -> None:
    with pytest.raises(SettingsError) as refused:
        settings_of(f"[scanner]\n{text}", tmp_path)
    assert sentence in str(refused.value)


def test_options_of_the_driver_are_said_as_scanimage_takes_them(fake: Fake, tmp_path: Path) -> None:
    text = "[scanner]\ndevice = 'fake:0'\noptions = {button-update = true, gamma = 1.5, preview = 'no'}"
    settings = settings_of(text, tmp_path)
    settings.paths.inbox.mkdir(parents=True)
    scanner = scanner_of(settings)
    scanner.scan()
    scanner.close()
    assert "--button-update --gamma=1.5 --preview=no" in fake.calls[-1]
    assert os.listdir(settings.paths.inbox)[0].endswith("-1.tiff")
