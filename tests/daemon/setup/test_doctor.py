"""Each thing that may be wrong is found, and said with its remedy."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

import daemon.models
from daemon.setup import doctor
from daemon.setup.doctor import Finding

MODELS = Path(daemon.models.__file__).parent
BOX = [(20.0, 20.0), (120.0, 20.0), (120.0, 80.0), (20.0, 80.0)]


@pytest.fixture
def powerless(monkeypatch: pytest.MonkeyPatch) -> None:
    """A user who may write nothing: root may always."""
    monkeypatch.setattr(doctor.os, "access", lambda path, mode: False)


def remedy(finding: Finding) -> str:
    """Behind the last colon of what is wrong."""
    assert finding.state == "wrong"
    return finding.words.rpartition(": ")[2]


def test_a_folder_that_is_there_or_can_be_made_is_fine(tmp_path: Path) -> None:
    (tmp_path / "inbox").mkdir()
    (tmp_path / "inbox").chmod(0o775)
    there = doctor.folder_finding("inbox", tmp_path / "inbox", group=True)
    assert there.state == "ok"
    assert "and by the group" in there.words
    assert doctor.folder_finding("log", tmp_path / "a" / "b").words.endswith("will be made")


def test_a_folder_of_somebody_else_is_not(tmp_path: Path, powerless: None) -> None:
    finding = doctor.folder_finding("inbox", tmp_path)
    assert "with sudo" in remedy(finding)
    assert tmp_path.owner() in finding.words


def test_a_file_in_place_of_a_folder_is_found(tmp_path: Path) -> None:
    (tmp_path / "inbox").touch()
    assert doctor.folder_finding("inbox", tmp_path / "inbox").state == "wrong"


def test_a_full_disk_is_found(tmp_path: Path) -> None:
    assert doctor.disk_finding(tmp_path / "not" / "yet", free_mb=0).state == "ok"
    assert "free some" in remedy(doctor.disk_finding(tmp_path, free_mb=1e9))


def test_little_memory_is_found() -> None:
    def told(available: int, swap: int) -> Finding:
        return doctor.memory_finding(f"MemTotal: 9000000 kB\nMemAvailable:  {available} kB\nSwapFree: {swap} kB\n")

    assert told(400_000, 0).state == "ok"
    assert told(200_000, 200_000).state == "ok"
    assert "add swap" in remedy(told(200_000, 10_000))


def test_a_clock_that_was_never_set_is_found() -> None:
    now_s = 1_795_000_000.0
    assert doctor.clock_finding(now_s).state == "ok"
    assert "timedatectl" in remedy(doctor.clock_finding(100.0))
    assert doctor.clock_finding(now_s, newest_s=now_s + 3600).state == "ok"
    assert doctor.clock_finding(now_s, newest_s=now_s + 90000).state == "wrong"


def test_the_shipped_network_is_known_by_its_sum(tmp_path: Path) -> None:
    assert doctor.network_finding(MODELS).state == "ok"
    for name in ("linedrawd.json", "linedrawd.onnx"):
        shutil.copy(MODELS / name, tmp_path)
    with (tmp_path / "linedrawd.onnx").open("ab") as file:
        file.write(b"x")
    assert "install linedrawd again" in remedy(doctor.network_finding(tmp_path))
    assert doctor.network_finding(tmp_path / "nothing").state == "wrong"


def test_a_port_that_is_missing_or_not_ours_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert "linedrawd usb" in doctor.port_finding("left", str(tmp_path / "ttyUSB0")).words
    assert doctor.port_finding("left", "/dev/null").state == "ok"
    monkeypatch.setattr(doctor.os, "access", lambda path, mode: False)
    assert "sudo adduser USER" in doctor.port_finding("left", "/dev/null").words


def test_what_is_wrong_on_the_usb_is_a_finding_each() -> None:
    told = [["USB 1-1  an adapter"], ["USB 1-2  another", "  it has no serial port: load one", "  and more: mend"]]
    found = list(doctor.usb_findings(told))
    assert [each.state for each in found] == ["wrong", "wrong"]
    assert found[0].words == "USB 1-2 another: it has no serial port: load one"


def test_a_machine_that_answers_is_told_and_what_it_wants_is_advice() -> None:
    lines = ["port: /dev/x", "pen at: X0 Y0", "firmware: Grbl 1.1h", "wanted otherwise: $1=25: keep them on", "$1=25"]
    answers, wanted = doctor.answer_findings("left", lines)
    assert (answers.state, answers.words) == ("ok", "Grbl 1.1h, pen at X0 Y0")
    assert (wanted.state, wanted.words) == ("better", "$1=25: keep them on")


@pytest.mark.parametrize(
    ("travel", "states"),
    [((200, 200), []), ((100, 200), ["wrong"]), ((200, 79), ["wrong"]), ((150, 200), ["better"])],
)
def test_the_machines_own_limits_are_held_against_the_sheet(travel: tuple[int, int], states: list[str]) -> None:
    lines = ["$13=0", f"$130={travel[0]}.000", f"$131={travel[1]}"]
    found = list(doctor.limit_findings("left", lines, reach_mm=(200.0, 200.0), needed_mm=BOX))
    assert [each.state for each in found] == states
    assert list(doctor.limit_findings("left", [], reach_mm=(200.0, 200.0), needed_mm=BOX)) == []


def test_findings_are_told_as_json() -> None:
    assert json.loads(doctor.as_json([Finding("disk", "ok", "9 MB")])) == [
        {"name": "disk", "state": "ok", "words": "9 MB"}
    ]
