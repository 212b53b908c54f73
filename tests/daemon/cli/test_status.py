"""What `status` and `jobs` say of a state: why it is so, and what a person does about it."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from daemon.cli.__main__ import main
from daemon.cli.view import Size, view
from daemon.jobs.states import Reason, State, meaning_of
from daemon.status import Diary, StatusBoard


def paused(root: Path) -> None:
    (root / "jobs" / "000001-a").mkdir(parents=True)
    diary = Diary(root / "log", root / "jobs", to_stderr=False)
    diary.say("the picture is queued", job="000001-a", state="queued", name="a.png")
    diary.say("somebody pressed feed hold", job="000001-a", state="paused", reason="at the machine")
    diary.close()


def test_jobs_says_the_reason_and_what_to_do(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    paused(tmp_path)
    assert main(["jobs", "--state-dir", str(tmp_path)]) == 0
    assert "paused, at the machine" in capsys.readouterr().out
    assert main(["jobs", "--json", "--state-dir", str(tmp_path)]) == 0
    (job,) = json.loads(capsys.readouterr().out)
    remedy = meaning_of(State.PAUSED, Reason.AT_THE_MACHINE).remedy
    assert (job["state"], job["reason"], job["remedy"]) == ("paused", "at the machine", remedy)
    assert (job["words"], job["name"]) == ("somebody pressed feed hold", "a.png")


def test_status_says_the_reason_and_what_to_do(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "run").mkdir()
    board = StatusBoard(tmp_path / "run" / "status.json")
    board.change(pid=os.getpid(), state="paused", reason="door", words="the door is open")
    board.tick(0.0)
    assert main(["status", "--state-dir", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert f"what to do     {meaning_of(State.PAUSED, Reason.DOOR).remedy}" in said
    assert "reason         door" in said
    told = {"machine": "plotter", "state": "paused", "reason": "door"}
    rows = view(told, [], [], Size(80, 24, colour=False), wall_s=0.0, runs=True)
    assert rows[0] == "plotter: paused, door"


def test_a_new_state_has_no_reason_of_the_one_before(tmp_path: Path) -> None:
    board = StatusBoard(tmp_path / "status.json")
    board.change(state="paused", reason="door")
    board.change(percent=3.0)
    assert board.now.reason == "door"
    board.change(state="drawing")
    assert board.now.reason == ""
    board.change_machine("plotter", state="paused", reason="door")
    board.change_machine("plotter", percent=3.0)
    assert board.now.machines["plotter"].reason == "door"
    board.change_machine("plotter", state="held")
    assert board.now.machines["plotter"].reason == ""


def test_where_there_are_several_machines_what_to_do_names_the_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "run").mkdir()
    board = StatusBoard(tmp_path / "run" / "status.json")
    board.change(pid=os.getpid())
    for name, reason in (("left", "door"), ("right", "person")):
        board.change_machine(name, state="paused", reason=reason)
    board.tick(0.0)
    assert main(["status", "--state-dir", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert "say `linedrawd resume --machine left`; `stop` ends it" in said
    assert "`linedrawd resume --machine right` goes on" in said


def test_a_remedy_names_the_machine_only_where_it_is_told_which() -> None:
    remedy = meaning_of(State.INTERRUPTED, Reason.POSITION_UNKNOWN).remedy_at("left")
    assert "`linedrawd machine origin --machine left`" in remedy
    assert "`linedrawd go --machine left`" in remedy
    assert "`linedrawd again JOB`" in remedy
