"""The settings are checked at the door, and an error names its place and its cure."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from daemon.config import (
    DobotMachine,
    EmcoMachine,
    GrblMachine,
    Intake,
    Options,
    ServoPenSettings,
    Settings,
    load_settings,
)
from daemon.errors import SettingsError
from daemon.intake.side import parse


def settings(text: str, folder: Path, **said: str) -> Settings:
    file = folder / "linedrawd.toml"
    file.write_text(text, encoding="utf-8")
    options: dict[str, Any] = {"config": file, **said}
    machine = "machine" in said
    return load_settings(Options(**options), environment={"HOME": str(folder)}, one_machine=machine)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("[machines.left]\ndraw_mms = 3", "[machines.left] draw_mms is unknown: did you mean draw_mm_s?"),
        ("[plannning]\nthreads = 1", "plannning is unknown: did you mean planning?"),
        ("[planning]\ntime_limits = 3", "[planning] time_limits is unknown: did you mean time_limit_s?"),
        ("[machines.left.pen]\nkind = 'z'\nupmm = 3", "upmm is unknown: did you mean up_mm?"),
        ("[machines.left.pen]\nkind = 'brush'", "[machines.left] pen: a pen has kind = 'z' or 'servo'"),
        ("[machines.left.pen]\nkind = 'servo'\nup = 3", "up is unknown: did you mean up_s?"),
        ("[paths]\nstate = 'x'", "[paths] state is unknown: did you mean state_dir?"),
        ("[machines.left]\nqqq = 1", "[machines.left] qqq is unknown: known are device, url"),
        ("[machines.left]\nbaud = 'fast'", "[machines.left] baud: Input should be a valid integer"),
        ("[machines.left]\nreach_mm = 3", "[machines.left] reach_mm: Input should be a valid tuple"),
        ("machines = 3", "machines: Input should be a valid dictionary"),
        ("[machines]\nleft = 3", "[machines] left: "),
        ("paths = 3", "paths: Input should be a valid dictionary"),
        ("[sheet]\nerror_mm = inf", "[sheet] error_mm: Input should be a finite number"),
        ("[machines.left]\nurl = 'usb:3'", "use auto, serial:///dev/NAME, usb://PLACE, tcp://HOST:PORT or sim://grbl"),
        ("[machines.left]\nurl = 'sim://emco'", "use sim://grbl"),
        (
            "[machines.left]\ndevice = 'laser'",
            "[machines] left: a machine is a section with device = 'grbl', 'emco' or",
        ),
        ("[machines.left]\ndevice = 'emco'\nflow = 'line'", "[machines.left] flow is unknown: known are device, url"),
        ("[machines.a]\ndevice = 'emco'\nlink = 'blocks'\nurl = 'file:///d'", "link = 'blocks' does not go with url"),
        ("[machines.a]\ndevice = 'emco'\nhome = 'job'", "an EMCO is homed at its control"),
        ("[machines.a]\ndevice = 'emco'\nurl = 'sim://dobot'", "is not simulated for device 'emco': use sim://emco"),
        ("[machines.a]\ndevice = 'emco'\npen = {kind = 'servo'}", "[machines.a.pen] kind: Input should be 'z'"),
        (
            "[machines.a]\ndevice = 'dobot'\nurl = 'file:///x'",
            "no way to a machine of device 'dobot': use auto, serial",
        ),
        (
            "[machines.a]\ndevice = 'dobot'\n[machines.a.pen]\nupmm = 3",
            "[machines.a.pen] upmm is unknown: did you mean",
        ),
        ("[machines.a]\norigin = 'homed'\nhome = 'never'", "origin = 'homed' and home = 'never' contradict each other"),
        ("[machines.left.pen]\nkind = 'z'\nup_mm = -1", "pen.up_mm = -1 must be above pen.down_mm = 0"),
        ("[machines.left]\n[machines.right]", "left and right have the same url = 'auto': give each its own"),
        (
            "[machines.left]\nurl = '/dev/ttyUSB7'\n[machines.right]\nurl = 'serial:///dev/../dev/ttyUSB7'",
            "left and right have the same url = 'serial:///dev/../dev/ttyUSB7': give each its own",
        ),
        (
            "[machines.left]\n[machines.right]\nurl = '/dev/ttyUSB7'",
            "left has url = 'auto' and could be found at the port",
        ),
        ("[machines.a]\nurl = 'sim://grbl'\ninbox = 'inbox'", "are or hold each other: give it another folder"),
        ("[machines.a]\nurl = 'sim://grbl'\ninbox = '.'", "are or hold each other: give it another folder"),
        ("[sheet]\nmargin_mm = 30\n[machines.a]\nbox_mm = [50, 80]", "margin_mm = 30 leaves no room in box_mm"),
        ("[sheet]\nmargin_mm = 32", "sheet: margin_mm = 32 leaves no room in box_mm: make it smaller"),
        ("[sheet]\nrotate = 45", "[sheet] rotate: Input should be 0, 90, 180 or 270"),
        ("[planning", "is not TOML"),
    ],
)
def test_a_wrong_setting_is_refused_with_its_place_and_its_cure(text: str, sentence: str, tmp_path: Path) -> None:
    with pytest.raises(SettingsError) as refused:
        settings(text, tmp_path)
    assert sentence in str(refused.value)
    assert "linedrawd.toml" in str(refused.value)


def test_a_settings_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match=r"absent\.toml cannot be read .*--config"):
        load_settings(Options(config=tmp_path / "absent.toml"), environment={})


def test_no_machine_is_ever_chosen_by_itself() -> None:
    with pytest.raises(SettingsError, match="give --device grbl"):
        load_settings(Options(), environment={"HOME": "/nonexistent"}, machine_needed=True)


def test_a_machine_is_simulated_only_where_somebody_asked_for_it(tmp_path: Path) -> None:
    machine = settings("", tmp_path, device="grbl").machines["plotter"]
    assert (machine.url, machine.simulated, machine.asks_for_sheets) == ("auto", False, True)
    machine = settings("", tmp_path, device="sim").machines["plotter"]
    assert (machine.url, machine.simulated, machine.asks_for_sheets) == ("sim://grbl", True, False)


def test_the_command_line_wins_over_the_file(tmp_path: Path) -> None:
    machine = settings("[machines.left]\nurl = 'auto'\nbaud = 9600", tmp_path, port="/dev/ttyACM1").machines["left"]
    assert (machine.url, machine.baud) == ("serial:///dev/ttyACM1", 9600)


TWO = "[machines.left]\nurl = '/dev/ttyUSB7'\n[machines.right]\nurl = '/dev/ttyUSB8'\nbox_mm = [20, 30]"


def test_the_command_line_tells_of_one_of_several_machines_only_by_its_name(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match=r"2 are set \(left, right\): say it in their sections"):
        settings(TWO, tmp_path, port="/dev/ttyACM1")
    only = settings(TWO, tmp_path, machine="right", port="/dev/ttyACM1")
    assert {name: machine.url for name, machine in only.machines.items()} == {"right": "serial:///dev/ttyACM1"}
    with pytest.raises(SettingsError, match="the machine rihgt is unknown: did you mean right"):
        settings(TWO, tmp_path, machine="rihgt")


def test_a_machine_may_have_a_sheet_of_its_own(tmp_path: Path) -> None:
    both = settings(TWO + "\n[sheet]\nbox_mm = [50, 60]\nmargin_mm = 5", tmp_path)
    assert (both.sheet_of("left").box_mm, both.sheet_of("right").box_mm) == ((50.0, 60.0), (20.0, 30.0))
    assert both.sheet_of("right").margin_mm == 5.0
    assert not both.machines["left"].draws_like(both.machines["right"])


def test_machines_that_differ_in_their_port_alone_draw_each_others_programs(tmp_path: Path) -> None:
    both = settings(TWO.replace("box_mm = [20, 30]", "sheet = 'feed'\ninbox = 'right'"), tmp_path)
    assert both.machines["left"].draws_like(both.machines["right"])
    assert both.sharing == {"left"}
    assert both.inboxes == {"": both.paths.inbox, "right": both.paths.inbox.parent / "right"}


def test_each_device_is_named_on_the_command_line(tmp_path: Path) -> None:
    assert isinstance(settings("", tmp_path, device="dobot").machines["plotter"], DobotMachine)
    emco = settings("", tmp_path, device="emco", port="file:///srv/programs").machines["plotter"]
    assert isinstance(emco, EmcoMachine)
    assert emco.link == "file"


def test_an_emco_is_never_found_by_itself(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match="is not found by itself: say its url"):
        settings("", tmp_path, device="emco").machines["plotter"].check_streamable()


@pytest.mark.parametrize(
    ("text", "home", "origin"),
    [
        ("", "never", "here"),
        ("home = 'job'", "job", "homed"),
        ("origin = 'homed'", "start", "homed"),
        ("origin = 'homed'\nhome = 'job'", "job", "homed"),
    ],
)
def test_homed_positions_are_counted_from_home(text: str, home: str, origin: str, tmp_path: Path) -> None:
    machine = settings(f"[machines.a]\n{text}", tmp_path).machines["a"]
    assert isinstance(machine, GrblMachine)
    assert (machine.home, machine.origin) == (home, origin)


def test_a_servo_pen_is_read(tmp_path: Path) -> None:
    pen = settings("[machines.a.pen]\nkind = 'servo'\nup_s = 10\ndown_s = 90", tmp_path).machines["a"].pen
    assert pen == ServoPenSettings(kind="servo", up_s=10, down_s=90, dwell_s=0.2)


def test_the_paper_dialect_is_streamed_only_where_minus_five_is_up(tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match=r"say pen\.up_mm = -5"):
        settings("[machines.a]\ndialect = 'paper'", tmp_path).machines["a"].check_streamable()
    text = "[machines.a]\ndialect = 'paper'\npen = {kind = 'z', up_mm = -5}"
    settings(text, tmp_path).machines["a"].check_streamable()
    with pytest.raises(SettingsError, match="units = 'cm' is for files"):
        settings(text + "\nunits = 'cm'", tmp_path).machines["a"].check_streamable()
    settings("[machines.a]", tmp_path).machines["a"].check_streamable()


def test_a_simulated_machine_may_be_told_to_fail(tmp_path: Path) -> None:
    assert settings("", tmp_path, port="sim://grbl?hang=2").machines["plotter"].url == "sim://grbl?hang=2"


def test_everything_lies_below_a_chosen_state_folder(tmp_path: Path) -> None:
    paths = load_settings(Options(state_dir=tmp_path / "s"), environment={"XDG_RUNTIME_DIR": "/run/user/1"}).paths
    assert {paths.inbox.parent, paths.log_dir.parent, paths.runtime_dir.parent} == {tmp_path / "s"}


def test_the_folders_of_the_service_are_taken_from_its_environment() -> None:
    environment = {"STATE_DIRECTORY": "/s:/t", "LOGS_DIRECTORY": "/l", "RUNTIME_DIRECTORY": "/r"}
    paths = load_settings(Options(), environment=environment).paths
    assert (paths.state_dir, paths.inbox, paths.log_dir) == (Path("/s"), Path("/s/inbox"), Path("/l"))
    assert paths.runtime_dir == Path("/r")


def test_settings_travel_to_the_worker_and_back(tmp_path: Path) -> None:
    given = settings("[machines.a.pen]\nkind = 'servo'\n[sheet]\nbox_mm = [10, 20]", tmp_path)
    assert Settings.model_validate_json(given.model_dump_json()) == given


def test_the_settings_that_the_inbox_page_shows_are_settings(tmp_path: Path) -> None:
    page = (Path(__file__).parents[2] / "docs" / "inbox.md").read_text(encoding="utf-8")
    _, side, _, shown, _ = page.split("```")
    (tmp_path / "linedrawd.toml").write_text(shown.removeprefix("toml"))
    settings = load_settings(Options(config=tmp_path / "linedrawd.toml"), environment={"HOME": str(tmp_path)})
    assert settings.keep.free_mb == 200
    assert settings.intake == Intake()
    assert parse(side.removeprefix("toml").encode(), "house.toml").copies == 3


def test_pens_keep_their_order_and_colours_are_said_by_name_or_number(tmp_path: Path) -> None:
    said = settings('[pens]\ncolours = { red = "tomato", black = "#1A1A1A" }\nskip = ["black"]\n', tmp_path)
    assert list(said.pens.colours.items()) == [("red", "#ff6347"), ("black", "#1a1a1a")]
    assert said.pens.skip == ("black",)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('colours = { red = "rde" }', "'rde' is no colour: write it as"),
        ('colours = { "red pen" = "red" }', "should match pattern"),
        ('colours = { red = "red" }\nskip = ["rad"]', "'rad' is none of the colours"),
        ('color = { red = "red" }', "did you mean colours"),
    ],
)
def test_pens_that_are_none_are_refused(text: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(SettingsError, match=words):
        settings(f"[pens]\n{text}\n", tmp_path)
