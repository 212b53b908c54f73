"""What was recorded is replayed: the same bytes at the same times lead to the same events."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from daemon.cli.__main__ import main
from daemon.config import AnyMachine, DobotMachine, EmcoMachine, GrblMachine
from daemon.errors import DiskTrouble, LinedrawError
from daemon.jobs.devices import opened, program_of, replayed
from daemon.jobs.grbl import moved
from daemon.machine.recorder import Recorder, read_recording
from daemon.machine.replay import Happened, Replay
from daemon.shapes import Program, ProgramLine
from firmware_protocol.session import Accepted, Ended, Event, Paused, Verdict
from tests.daemon.program.examples import TOOLPATH

GOLDEN = Path(__file__).parents[2] / "golden" / "recordings"


def drawn(machine: AnyMachine, file: Path) -> list[Event]:
    """A drawing on the simulated machine, recorded; what was heard."""
    heard: list[Event] = []
    with closing(Recorder(file)) as recorder:
        way = opened(machine, heard.append, False, recorder)
        way.connect()
        way.draw(program_of(TOOLPATH, machine, "000001-example"))
        way.close()
    return heard


def replay(file: Path) -> list[Happened]:
    return list(Replay(replayed).run(read_recording(file)))


def events(happened: Sequence[Happened]) -> list[Event]:
    return [event for each in happened for event in each.events]


@pytest.mark.parametrize(
    ("machine", "verdict"),
    [
        (GrblMachine(url="sim://grbl"), Verdict.FINISHED),
        (GrblMachine(url="sim://grbl?brownout=2"), Verdict.RESTARTED),
        (GrblMachine(url="sim://grbl?unplug=2"), Verdict.UNPLUGGED),
        (EmcoMachine(device="emco", url="sim://emco"), Verdict.FINISHED),
        (EmcoMachine(device="emco", url="sim://emco?lose_ack=9", link="blocks"), Verdict.SILENT),
        (DobotMachine(device="dobot", url="sim://dobot?drop=9"), Verdict.FINISHED),
        (DobotMachine(device="dobot", url="sim://dobot?hang=12"), Verdict.SILENT),
    ],
)
def test_a_recording_leads_to_the_events_that_were_heard(machine: Any, verdict: Verdict, tmp_path: Path) -> None:
    heard = drawn(machine, tmp_path / "recording.txt")
    happened = replay(tmp_path / "recording.txt")
    assert events(happened) == heard
    assert [each.differs for each in happened if each.differs] == []
    assert isinstance(heard[-1], Ended)
    assert heard[-1].verdict is verdict


def test_a_report_from_the_field_is_a_test() -> None:
    """A controller that fell silent in the first stroke."""
    (ended,) = [event for event in events(replay(GOLDEN / "grbl_hang.txt")) if isinstance(event, Ended)]
    assert (ended.verdict, ended.strokes_certain, ended.pen_lifted) == (Verdict.SILENT, 0, False)


def test_a_session_that_says_something_else_is_noticed(tmp_path: Path) -> None:
    drawn(GrblMachine(url="sim://grbl"), tmp_path / "recording.txt")
    text = (tmp_path / "recording.txt").read_text()
    (tmp_path / "other.txt").write_text(text.replace('"flow": "count"', '"flow": "line"'))
    assert any(each.differs for each in replay(tmp_path / "other.txt"))


def test_orders_are_recorded_too(tmp_path: Path) -> None:
    """Home, another feed, a pause at once, a resume and a stop."""
    machine = GrblMachine(url="sim://grbl?22=1&132=50&switches=-300:-300:0&23=3&130=300&131=300", home="start")
    program = program_of(TOOLPATH, machine, "x")
    below_home = [ProgramLine(moved(line.text, (-290.0, -290.0)), line.stroke) for line in program.lines]
    heard: list[Event] = []

    def hear(event: Event) -> None:
        heard.append(event)
        if event == Accepted(5):
            way.feed(150)
            way.pause(at_once=True)
        if isinstance(event, Paused):
            way.resume()
        if isinstance(event, Accepted) and any(isinstance(each, Paused) for each in heard):
            way.stop()

    with closing(Recorder(tmp_path / "recording.txt")) as recorder:
        way = opened(machine, hear, False, recorder)
        way.connect()
        way.home(program)
        assert way.draw(Program(tuple(below_home), program.strokes)).verdict is Verdict.STOPPED
    kinds = {entry.kind for entry in read_recording(tmp_path / "recording.txt")}
    assert kinds >= {"open", "home", "start", "feed", "pause", "resume", "stop"}
    assert events(replay(tmp_path / "recording.txt")) == heard


def test_a_recording_is_bounded(tmp_path: Path) -> None:
    recorder = Recorder(tmp_path / "recording.txt", limit_bytes=1000)
    for number in range(500):
        recorder.turned(float(number), b"ok\r\n", b"", [])
    recorder.close()
    lines = (tmp_path / "recording.txt").read_text().splitlines()
    assert lines[-1].split()[1:] == ["full", "null"]
    assert 900 < (tmp_path / "recording.txt").stat().st_size < 1100


def test_every_byte_is_kept(tmp_path: Path) -> None:
    every = bytes(range(256))
    with closing(Recorder(tmp_path / "recording.txt")) as recorder:
        recorder.turned(1 / 3, every, every[::-1], [])
    first, second = read_recording(tmp_path / "recording.txt")
    assert (first.at_s, first.value.encode("latin-1")) == (1 / 3, every)
    assert second.value.encode("latin-1") == every[::-1]


def test_a_full_disk_ends_the_recording_and_nothing_else() -> None:
    with closing(Recorder(Path("/dev/full"))) as recorder:
        recorder.turned(1.0, b"ok", b"", [])
        recorder.turned(2.0, b"ok", b"", [])


def test_a_file_that_cannot_be_made_is_said(tmp_path: Path) -> None:
    with pytest.raises(DiskTrouble, match="record into another place"):
        Recorder(tmp_path / "none" / "recording.txt")


@pytest.mark.parametrize("line", ["", "x", "1.0 < nonsense", "1.0 what null", "x < null", "1.0 open {}", "é"])
def test_what_is_no_recording_is_refused_with_its_line(tmp_path: Path, line: str) -> None:
    (tmp_path / "recording.txt").write_text(f"{line}\n")
    with pytest.raises(LinedrawError, match=r"line 1 is no line|cannot be read|of another version"):
        replay(tmp_path / "recording.txt")


def test_the_command_prints_what_happened(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    drawn(GrblMachine(url="sim://grbl"), tmp_path / "recording.txt")
    assert main(["replay", str(tmp_path / "recording.txt")]) == 0
    said = capsys.readouterr().out.splitlines()
    assert re.match(r" +\d+\.\d{3}  Ready\(firmware='Grbl 1\.1h", said[0])
    assert said[-1] == "the same is said as was"
    text = (tmp_path / "recording.txt").read_text().replace('"flow": "count"', '"flow": "line"')
    (tmp_path / "recording.txt").write_text(text)
    assert main(["replay", str(tmp_path / "recording.txt")]) == 1
    assert "times something else is said than was" in capsys.readouterr().out


def test_draw_records(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setattr("daemon.jobs.pool.PLANNER", "tests.daemon.planned")
    (tmp_path / "a.png").write_text("a picture")
    file = tmp_path / "recording.txt"
    options = ["--device", "sim", "--state-dir", str(tmp_path / "state"), "--record", str(file)]
    assert main(["draw", str(tmp_path / "a.png"), *options]) == 0
    first = next(read_recording(file))
    assert (first.kind, first.value["machine"]["device"], json.dumps(first.value["still"])) == ("open", "grbl", "false")
    assert isinstance(events(replay(file))[-1], Ended)
