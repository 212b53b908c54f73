"""The log has one line an event, and status.json is whole at every moment."""

from __future__ import annotations

import json
import logging
import os
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from daemon.errors import DiskTrouble
from daemon.status import Diary, StatusBoard


@pytest.fixture
def diary(tmp_path: Path) -> Iterator[Diary]:
    (tmp_path / "jobs" / "000001-a").mkdir(parents=True)
    diary = Diary(tmp_path / "log", tmp_path / "jobs")
    yield diary
    diary.close()


def test_an_event_is_one_line_of_time_level_job_words_and_values(diary: Diary, tmp_path: Path) -> None:
    diary.say("50 % drawn\nof it", job="000001-a", level=logging.WARNING, name="a b.png", seconds=1.25, empty="")
    line = (tmp_path / "log" / "linedrawd.log").read_text()
    stamp = r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ"
    assert re.fullmatch(rf'{stamp} WARNING 000001-a 50 % drawn of it name="a b\.png" seconds=1\.25 empty=""\n', line)
    assert (tmp_path / "jobs" / "000001-a" / "job.log").read_text() == line


@pytest.mark.parametrize(("shift", "level"), [(0, "<3>"), (1, "")])
def test_the_journal_is_told_the_same_line_and_its_level(
    shift: int, level: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    stderr = os.fstat(2)
    monkeypatch.setenv("JOURNAL_STREAM", f"{stderr.st_dev}:{stderr.st_ino + shift}")
    diary = Diary(tmp_path / "log", tmp_path / "jobs", to_stderr=True)
    diary.say("no ink", level=logging.ERROR)
    diary.close()
    assert capfd.readouterr().err == level + (tmp_path / "log" / "linedrawd.log").read_text()


def test_the_log_goes_on_in_a_new_file_when_the_old_one_was_moved_away(diary: Diary, tmp_path: Path) -> None:
    diary.say("first")
    (tmp_path / "log" / "linedrawd.log").rename(tmp_path / "log" / "linedrawd.log.1")
    diary.say("second")
    assert "second" in (tmp_path / "log" / "linedrawd.log").read_text()
    assert "second" not in (tmp_path / "log" / "linedrawd.log.1").read_text()


def test_a_job_whose_folder_has_gone_stops_no_log(diary: Diary, tmp_path: Path) -> None:
    diary.say("hello", job="000002-gone")
    assert "000002-gone hello" in (tmp_path / "log" / "linedrawd.log").read_text()


def test_a_log_folder_that_cannot_be_made_is_refused_with_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(DiskTrouble, match="--log-dir"):
        Diary(tmp_path / "file" / "log", tmp_path)


def state(path: Path) -> str:
    return str(json.loads(path.read_text())["state"])


def test_the_status_is_written_on_change_and_at_most_once_a_second(tmp_path: Path) -> None:
    path = tmp_path / "status.json"
    board = StatusBoard(path)
    board.change(state="idle")
    assert board.tick(100.0) == 1.0
    assert state(path) == "idle"
    board.change(state="drawing")
    assert board.tick(100.25) == 0.75
    assert state(path) == "idle"
    board.tick(101.0)
    assert state(path) == "drawing"
    path.unlink()
    board.tick(200.0)
    assert not path.exists()


def test_a_reader_never_sees_half_a_status(tmp_path: Path) -> None:
    path = tmp_path / "status.json"
    board = StatusBoard(path)
    board.change(words="x" * 1000)
    board.tick(1.0)
    with path.open() as reader:
        board.change(words="")
        board.tick(3.0)
        assert len(json.loads(reader.read())["words"]) == 1000
    assert [file.name for file in tmp_path.iterdir()] == ["status.json"]


def test_the_last_status_is_written_when_the_daemon_ends(tmp_path: Path) -> None:
    board = StatusBoard(tmp_path / "status.json")
    board.change(state="idle")
    board.tick(0.0)
    board.change(state="ended")
    board.stop()
    board.run()
    assert state(tmp_path / "status.json") == "ended"


def test_a_status_that_cannot_be_written_stops_nothing(tmp_path: Path) -> None:
    board = StatusBoard(tmp_path / "gone" / "status.json")
    board.change(state="idle")
    board.tick(0.0)
    (tmp_path / "gone").mkdir()
    board.change(state="drawing")
    board.tick(2.0)
    assert state(tmp_path / "gone" / "status.json") == "drawing"


def test_a_full_log_is_set_aside_and_only_so_many_are_kept(tmp_path: Path) -> None:
    (tmp_path / "jobs" / "000001-a").mkdir(parents=True)
    diary = Diary(tmp_path / "log", tmp_path / "jobs", log_mb=0.001, log_files=2)
    try:
        for number in range(100):
            diary.say(f"event {number}", job="000001-a")
    finally:
        diary.close()
    logs = {path.name: path for path in (tmp_path / "log").iterdir()}
    assert set(logs) == {"linedrawd.log", "linedrawd.log.1", "linedrawd.log.2"}
    assert all(path.stat().st_size < 1100 for path in logs.values())
    text = "".join(logs[name].read_text() for name in sorted(logs, reverse=True))
    told = [int(number) for number in re.findall(r"event (\d+)", text)]
    assert told == list(range(told[0], 100))
    assert (tmp_path / "jobs" / "000001-a" / "job.log").stat().st_size < 1100
