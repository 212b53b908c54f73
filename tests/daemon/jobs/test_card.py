"""The test card as a machine draws it, from the settings to the ink; and the corrections that its picture leads to."""

from __future__ import annotations

import struct
import zlib
from contextlib import closing
from pathlib import Path

import cv2
import numpy as np
import pytest

from daemon.cli.__main__ import main
from daemon.config import Options, Settings, load_settings
from daemon.errors import MachineFault, OutOfReach, SettingsError
from daemon.jobs.card import card_programs, draw_card, gauge_words
from daemon.jobs.devices import opened
from daemon.setup.card import Card
from daemon.setup.find import find_marks
from daemon.setup.fit import by_resolution, errors_of
from firmware_protocol.ink import Polyline
from tests.daemon.setup.scanned import PX_PER_MM, scanned

CROOKED = "sim://grbl?scale=1.012:0.991&skew=0.35&backlash=0.3:0.2"
CARD = Card(60.0, 60.0)


def settings_of(folder: Path, text: str) -> Settings:
    file = folder / "linedrawd.toml"
    file.write_text(text)
    return load_settings(Options(config=file, state_dir=folder / "state"), environment={"HOME": str(folder)})


def plotter(url: str = "sim://grbl", more: str = "") -> str:
    return (
        f'# mine\n[machines.left]\ndevice = "grbl"   # old\nurl = "{url}"\n{more}\n[sheet]\nbox_origin_mm = [20, 20]\n'
    )


def drawn(settings: Settings, *, corrected: bool = False) -> list[Polyline]:
    name, machine = next(iter(settings.machines.items()))
    programs = card_programs(settings.sheet_of(name), machine, corrected=corrected)
    with closing(opened(machine, lambda event: None, False)) as found:
        ink = draw_card(programs, found)
    assert ink is not None
    return [list(line) for line in ink]


def save_scan(path: Path, ink: list[Polyline]) -> None:
    """A PNG that says 300 dpi."""
    png = bytes(cv2.imencode(".png", scanned(ink))[1])
    chunk = b"pHYs" + struct.pack(">IIB", round(1000 * PX_PER_MM), round(1000 * PX_PER_MM), 1)
    head = 8 + 25
    path.write_bytes(png[:head] + struct.pack(">I", 9) + chunk + struct.pack(">I", zlib.crc32(chunk)) + png[head:])


def test_a_true_machine_draws_the_card_where_the_box_is(tmp_path: Path) -> None:
    ink = drawn(settings_of(tmp_path, plotter()))
    frame = np.array(ink[0])
    assert (frame.min(axis=0).tolist(), frame.max(axis=0).tolist()) == ([22, 22], [82, 82])
    # The gauge's strokes above the sheet leave nothing: the long one and the three below it do.
    assert len(ink) == len(CARD.strokes_mm) + 4


def test_a_crooked_machine_draws_straight_once_its_card_was_looked_at(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "linedrawd.toml"
    save_scan(tmp_path / "scan.png", drawn(settings_of(tmp_path, plotter(CROOKED))))
    before = file.read_text()
    assert main(["calibrate", str(tmp_path / "scan.png"), "--config", str(file)]) == 0
    said = capsys.readouterr().out
    assert "X is drawn 1.20 % too long" in said
    assert "80 of its 80 marks" in said
    assert (tmp_path / "scan-marks.png").exists()
    assert (tmp_path / "linedrawd.toml.before").read_text() == before
    after = load_settings(Options(config=file, state_dir=tmp_path / "state"), environment={"HOME": str(tmp_path)})
    machine = after.machines["left"]
    assert (machine.scale_x, machine.skew_deg) == (pytest.approx(1.012, abs=5e-4), pytest.approx(0.35, abs=0.03))
    assert '# mine\n[machines.left]\ndevice = "grbl"   # old\n' in file.read_text()
    found, _ = find_marks(scanned(drawn(after, corrected=True)), CARD)
    assert errors_of(found, px_to_mm=by_resolution(PX_PER_MM)).before_mm < 0.1
    # Drawn without them it is as crooked as it was: what is measured is the machine, not its settings.
    found, _ = find_marks(scanned(drawn(after)), CARD)
    assert errors_of(found, px_to_mm=by_resolution(PX_PER_MM)).before_mm > 0.4


def test_a_check_writes_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    settings = settings_of(tmp_path, plotter(CROOKED))
    save_scan(tmp_path / "scan.png", drawn(settings))
    before = (tmp_path / "linedrawd.toml").read_text()
    picture, file = str(tmp_path / "scan.png"), str(tmp_path / "linedrawd.toml")
    assert main(["calibrate", picture, "--config", file, "--check"]) == 0
    assert "the farthest mark lies 0.50 mm from where it should" in capsys.readouterr().out
    assert (tmp_path / "linedrawd.toml").read_text() == before


def test_a_picture_without_a_resolution_needs_a_length(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture, file = tmp_path / "photo.png", tmp_path / "linedrawd.toml"
    cv2.imwrite(str(picture), scanned(drawn(settings_of(tmp_path, plotter()))))
    assert main(["calibrate", str(picture), "--config", str(file)]) == 1
    assert "--known-mm" in capsys.readouterr().err
    assert main(["calibrate", str(picture), "--config", str(file), "--known-mm", "60.6"]) == 0
    assert "X is drawn 1.00 % too long" in capsys.readouterr().out


def test_a_photo_that_claims_72_dpi_is_not_believed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    ink = drawn(settings_of(tmp_path, plotter()))
    save_scan(tmp_path / "scan.png", ink)
    data = (tmp_path / "scan.png").read_bytes()
    chunk = b"pHYs" + struct.pack(">IIB", 2835, 2835, 1)
    where = data.index(b"pHYs")
    (tmp_path / "scan.png").write_bytes(
        data[:where] + chunk + struct.pack(">I", zlib.crc32(chunk)) + data[where + len(chunk) + 4 :]
    )
    assert main(["calibrate", str(tmp_path / "scan.png"), "--config", str(tmp_path / "linedrawd.toml")]) == 1
    assert "by its resolution of 72 dpi" in capsys.readouterr().err


@pytest.mark.parametrize("device", ["emco", "dobot"])
def test_other_machines_draw_it_too(tmp_path: Path, device: str) -> None:
    text = f'[machines.m]\ndevice = "{device}"\nurl = "sim://{device}"\n'
    ink = drawn(settings_of(tmp_path, text))
    frame = np.array(max(ink, key=lambda line: float(np.ptp(np.array(line), axis=0).prod())))
    assert np.ptp(frame, axis=0) == pytest.approx([60, 60], abs=0.05)


def test_a_card_that_the_machine_does_not_reach_is_refused(tmp_path: Path) -> None:
    settings = settings_of(tmp_path, plotter(more="reach_mm = [80, 80]"))
    with pytest.raises(OutOfReach):
        drawn(settings)


def test_a_box_too_small_for_a_card_is_refused(tmp_path: Path) -> None:
    settings = settings_of(tmp_path, plotter() + "box_mm = [50, 50]\n")
    with pytest.raises(SettingsError, match="60 x 60"):
        drawn(settings)


def test_a_machine_that_fails_says_so(tmp_path: Path) -> None:
    with pytest.raises(MachineFault):
        drawn(settings_of(tmp_path, plotter("sim://grbl?limit=20")))


def test_the_gauge_is_explained_in_the_words_of_the_pen(tmp_path: Path) -> None:
    said: list[str] = []
    for pen in ("", '[machines.left.pen]\nkind = "servo"\nup_s = 200\ndown_s = 800\n'):
        settings = settings_of(tmp_path, plotter() + pen)
        gauge_words(settings.machines["left"], said.append)
    assert "down_mm = 0" in said[0]
    assert "down_s = 800, each one above it 30 nearer" in said[1]


def test_a_servo_pen_has_a_gauge_of_angles(tmp_path: Path) -> None:
    pen = '[machines.left.pen]\nkind = "servo"\nup_s = 200\ndown_s = 800\n'
    settings = settings_of(tmp_path, plotter() + pen)
    programs = card_programs(settings.sheet, settings.machines["left"])
    angles = [
        next(line.text for line in program.lines if line.stroke == 0 and "M3" in line.text) for program in programs[1:]
    ]
    assert angles == [f"M3 S{800 - 30 * step} G4 P0.2" for step in (3, 2, 1, 0, -1, -2, -3)]
