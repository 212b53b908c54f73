"""The button of the settings: what is refused, what a press leads to, and what the doctor says of it."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import pytest

from daemon.cli import doctor
from daemon.cli.__main__ import main
from daemon.config import Settings
from daemon.errors import SettingsError
from daemon.intake.keyboard import KeyButton
from daemon.jobs import pressing
from daemon.jobs.journal import Job
from daemon.jobs.states import State
from tests.daemon.intake.buttons import DOWN, ENTER, SPACE, key
from tests.daemon.intake.scans import fake_on_path
from tests.daemon.test_service import LITTLE_MEMORY, loaded, running

SIMULATED = "url = 'sim://grbl'\nsheet = 'ask'\n"
BOTH = f"[machines.left]\n{SIMULATED}[machines.right]\n{SIMULATED}"


def settings_of(root: Path, text: str, *, machine: str | None = None) -> Settings:
    return loaded(root, LITTLE_MEMORY + text, machine=machine)


@pytest.fixture
def keypad(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """With an enter key, but for the question which keys it has, which no pipe answers."""
    path = tmp_path / "keypad"
    os.mkfifo(path)
    writer = os.open(path, os.O_RDWR)
    monkeypatch.setattr(pressing, "KeyButton", partial(KeyButton, keys_at=lambda opened: frozenset({ENTER})))
    yield path
    os.close(writer)


def press(keypad: Path, *codes: int) -> None:
    with keypad.open("r+b", buffering=0) as file:
        file.write(b"".join(key(code, DOWN) for code in codes))


def done(count: int) -> Callable[[list[Job]], bool]:
    return lambda jobs: sum(job.state is State.DONE for job in jobs) == count


@pytest.mark.parametrize(
    ("button", "machines", "words"),
    [
        ("kind = 'key'", "", "is no keyboard: `ls /dev/input/by-id` lists those there are"),
        ("path = 'keypad'", "", "is no keyboard"),
        ("path = '/dev/k'\nkey = 'entre'", "", "the key entre is unknown: did you mean enter"),
        ("kind = 'gpio'", "", "no line is set: say at which line of the chip the button is"),
        ("kind = 'gpio'\nline = 4\ndebounce_s = 2", "", "debounce_s"),
        ("path = '/dev/k'\npull = 'sideways'", "", "pull"),
        ("path = '/dev/k'\ndoes = 'scan'", "", "no scanner is set: add a section"),
        ("path = '/dev/k'\nmachine = 'lft'", BOTH, "did you mean left"),
        ("path = '/dev/k'", BOTH, "of which machine. say machine = one of left, right"),
        ("path = '/dev/k'\nkeys = 'enter'", "", "did you mean key"),
    ],
)
def test_a_button_that_cannot_do_what_is_set_is_refused(tmp_path: Path, button: str, machines: str, words: str) -> None:
    with pytest.raises(SettingsError, match=words):
        settings_of(tmp_path, f"[button]\n{button}\n{machines}")


def test_a_button_that_is_switched_off_may_say_anything_else(tmp_path: Path) -> None:
    assert settings_of(tmp_path, "[button]\nkind = 'none'\nmachine = 'lft'").button.kind == "none"


def test_the_button_of_one_machine_does_not_keep_another_from_being_named(tmp_path: Path) -> None:
    button = "[button]\npath = '/dev/k'\nmachine = 'left'\n"
    assert settings_of(tmp_path, button + BOTH, machine="right").button.machine == ""


def test_a_key_says_that_a_new_sheet_is_in(tmp_path: Path, keypad: Path) -> None:
    text = f"[button]\npath = '{keypad}'\nkey = 'enter'\n[machines.plotter]\n{SIMULATED}"
    with running(settings_of(tmp_path, text)) as daemon:
        for number in range(3):
            daemon.drop(f"{number}.png")
        waits = daemon.wait_for(lambda jobs: done(1)(jobs) and any(job.state is State.WAITING for job in jobs))
        assert next(job.words for job in waits if job.state is State.WAITING).startswith("waiting for a new sheet")
        press(keypad, SPACE, ENTER)
        daemon.wait_for(done(2))
        press(keypad, ENTER)
        daemon.wait_for(done(3))
        assert daemon.log().count("a new sheet is in") == 2


def test_a_key_means_the_machine_that_the_settings_name(tmp_path: Path, keypad: Path) -> None:
    text = f"[button]\npath = '{keypad}'\nmachine = 'right'\n{BOTH}"
    with running(settings_of(tmp_path, text)) as daemon:
        for number in range(3):
            daemon.drop(f"{number}.png")
        daemon.wait_for(done(2))
        press(keypad, ENTER)
        jobs = daemon.wait_for(done(3))
    assert sorted(job.machine for job in jobs) == ["left", "right", "right"]


def test_a_key_scans(tmp_path: Path, keypad: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fake = fake_on_path(tmp_path, {}, monkeypatch=monkeypatch)
    text = f"[button]\npath = '{keypad}'\ndoes = 'scan'\n[scanner]\ndevice = 'fake:0'\n[machines.plotter]\n{SIMULATED}"
    with running(settings_of(tmp_path, text)) as daemon:
        press(keypad, ENTER)
        (job,) = daemon.wait_for(bool)
    assert job.name.startswith("scan-")
    fake.scanner.close()


@pytest.mark.parametrize(
    ("button", "state", "words"),
    [
        ("", "ok", "none is set"),
        ("path = '{keypad}'\nkey = 'enter'", "ok", "{keypad}, key enter"),
        ("path = '{keypad}'\nkey = 'space'", "wrong", "the keyboard {keypad} has no key of the number 57"),
        ("path = '{keypad}-2'", "wrong", "there is no keyboard at {keypad}-2: plug it in"),
        ("kind = 'gpio'\npath = '{keypad}'\nline = 4", "wrong", "{keypad}"),
    ],
)
def test_the_doctor_looks_whether_the_button_can_be_heard(
    tmp_path: Path,
    keypad: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    button: str,
    state: str,
    words: str,
) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setattr(doctor, "_SERVICE", tmp_path / "service.sock")
    file = tmp_path / "doctor.toml"
    file.write_text(f"[button]\n{button.format(keypad=keypad)}\n" if button else "")
    main(["doctor", "--json", "--device", "sim", "--config", str(file), "--state-dir", str(tmp_path / "state")])
    (found,) = [each for each in json.loads(capsys.readouterr().out) if each["name"] == "button"]
    assert (found["state"], words.format(keypad=keypad) in found["words"]) == (state, True), found
