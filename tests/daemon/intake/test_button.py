"""A button is heard once a press, comes back by itself, and never ends more than itself."""

from __future__ import annotations

import errno
import os
import sys
import tty
from pathlib import Path
from types import ModuleType

import gpiod as real_gpiod
import pytest

from daemon.errors import LinedrawError
from daemon.intake.button import ButtonTrouble
from daemon.intake.keyboard import KeyButton
from daemon.intake.keys import code_of
from daemon.intake.pin import PinButton, Wiring, gpiod
from tests.daemon.intake.buttons import DOWN, ENTER, HELD, SPACE, UP, Ears, FakeButton, FakeGpiod, event, key

ALL = frozenset({ENTER, SPACE})


def test_each_press_is_heard() -> None:
    ears, button = Ears(), FakeButton()
    with ears.of(button):
        for _ in range(2):
            button.press_and_wait()
            assert ears.next() == "pressed"
    assert ears.heard.empty()


def test_a_trouble_is_told_once_and_the_button_comes_back_by_itself() -> None:
    ears, button = Ears(), FakeButton("not there", "not there", "not allowed", "not there", "")
    with ears.of(button):
        told = [ears.next() for _ in range(4)]
        button.press_and_wait()
        assert told == ["trouble: not there", "trouble: not allowed", "trouble: not there", "said: the button is there"]
        assert ears.next() == "pressed"
        button.lose("it is gone")
        assert [ears.next(), ears.next()] == ["trouble: it is gone", "said: the button is there"]
    assert button.opened == 6


def test_what_is_pressed_while_it_is_obeyed_is_forgotten() -> None:
    ears, button = Ears(), FakeButton("")

    def scan() -> None:
        button.press(3)
        ears.heard.put("scanned")

    ears.press = scan
    with ears.of(button):
        button.press_and_wait()
        assert ears.next() == "scanned"
    assert ears.heard.empty()


def test_what_cannot_be_done_is_told_and_the_button_is_heard_on() -> None:
    ears, button = Ears(), FakeButton("no", "")

    def refuse() -> None:
        raise LinedrawError("the lid is open: close it")

    ears.press = refuse
    with ears.of(button):
        assert [ears.next(), ears.next()] == ["trouble: no", "said: the button is there"]
        for _ in range(2):
            button.press_and_wait()
            assert ears.next() == "trouble: the lid is open: close it"


def test_a_watch_that_is_stopped_first_ends_at_once_and_one_that_waits_for_a_button_does_not_wait_on() -> None:
    with Ears().of(FakeButton(*["there is none"] * 9), retry_s=3600):
        pass


@pytest.fixture
def fifo(tmp_path: Path) -> Path:
    os.mkfifo(tmp_path / "keypad")
    return tmp_path / "keypad"


@pytest.mark.parametrize(
    ("code", "came", "pressed"),
    [
        (ENTER, key(ENTER, DOWN), True),
        (ENTER, key(ENTER, UP), False),
        (ENTER, key(ENTER, HELD) * 5, False),
        (ENTER, key(SPACE, DOWN), False),
        (ENTER, key(SPACE, DOWN) + key(ENTER, DOWN) + key(ENTER, HELD) + key(ENTER, UP), True),
        (None, key(SPACE, DOWN), True),
        (None, key(SPACE, UP) + key(SPACE, HELD), False),
        (None, event(2, 0, 1) + event(17, 0, 1) + event(0, 0, 0), False),
        (ENTER, event(2, ENTER, 1), False),
        (None, b"", False),
    ],
)
def test_a_key_is_pressed_when_it_goes_down_and_not_while_it_is_held(
    fifo: Path, code: int | None, came: bytes, pressed: bool
) -> None:
    writer = os.open(fifo, os.O_RDWR)
    button = KeyButton(str(fifo), code, keys_at=lambda opened: ALL)
    button.open()
    os.write(writer, came)
    assert button.pressed() is pressed
    assert button.pressed() is False
    button.close()
    os.close(writer)


def test_an_event_that_comes_in_pieces_is_one(fifo: Path) -> None:
    writer = os.open(fifo, os.O_RDWR)
    button = KeyButton(str(fifo), ENTER, keys_at=lambda opened: ALL)
    button.open()
    heard = []
    for byte in key(ENTER, DOWN):
        os.write(writer, bytes([byte]))
        heard.append(button.pressed())
    assert (heard.count(True), heard.index(True)) == (1, 47)
    button.close()
    os.close(writer)


def test_a_keypad_that_is_unplugged_and_plugged_in_again_is_heard_again(tmp_path: Path) -> None:
    """On a terminal, whose other side can hang up as a keypad does."""
    ears, path = Ears(), tmp_path / "keypad"
    with ears.of(KeyButton(str(path), ENTER, keys_at=lambda opened: ALL)):
        missing = f"trouble: there is no keyboard at {path}: plug it in"
        assert ears.next().startswith(missing)
        for _ in range(2):
            ours, theirs = os.openpty()
            tty.setraw(theirs)
            path.symlink_to(os.ttyname(theirs))
            assert ears.next() == "said: the button is there"
            os.write(ours, key(SPACE, DOWN) + key(ENTER, DOWN) + key(ENTER, UP))
            assert ears.next() == "pressed"
            path.unlink()
            os.close(ours)
            os.close(theirs)
            assert ears.next().startswith(missing)


def test_what_is_no_keyboard_is_told_with_its_cure(tmp_path: Path, fifo: Path) -> None:
    for path in (tmp_path, fifo, Path("/dev/null")):
        with pytest.raises(ButtonTrouble, match="is no keyboard: set path in"):
            KeyButton(str(path), ENTER).open()
    with pytest.raises(ButtonTrouble, match="has no key of the number 30: correct key or path"):
        KeyButton(str(fifo), 30, keys_at=lambda opened: ALL).open()
    with pytest.raises(ButtonTrouble, match="has no keys: correct key or path"):
        KeyButton(str(fifo), None, keys_at=lambda opened: frozenset()).open()
    with pytest.raises(ButtonTrouble, match=r"another program has the keyboard .* to itself: end that"):
        KeyButton(str(fifo), None, grab=True, keys_at=lambda opened: ALL).open()


def test_a_keyboard_that_may_not_be_read_is_told_with_the_group(fifo: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object) -> int:
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(os, "open", refused)
    with pytest.raises(ButtonTrouble, match=r"may not be read: `sudo adduser USER input` .* drop-in keyboard\.conf"):
        KeyButton(str(fifo), ENTER).open()


def test_keys_have_names_and_numbers() -> None:
    names = ("enter", "KEY_KPENTER", "Space", "f12", "f13", "btn_left", 30, "any")
    assert [code_of(name) for name in names] == [28, 96, 57, 88, 183, 272, 30, None]
    with pytest.raises(ValueError, match="the key entre is unknown: did you mean enter"):
        code_of("entre")
    with pytest.raises(ValueError, match="0 is no number of a key"):
        code_of(0)


def test_a_pin_is_asked_for_with_its_pull_its_edge_and_its_debounce() -> None:
    library = FakeGpiod(real_gpiod)
    for wiring in (Wiring("/dev/gpiochip0", 17), Wiring("/dev/gpiochip4", "GPIO5", "down", 0.1)):
        button = PinButton(wiring, library=lambda: library)
        assert button.open() == 77
        button.close()
        button.close()
    assert library.released == 2
    told = [
        (chip, line, str(said.bias), said.active_low, str(said.edge_detection), said.debounce_period.total_seconds())
        for chip, config in library.requests
        for line, said in config.items()
    ]
    assert told == [
        ("/dev/gpiochip0", 17, "Bias.PULL_UP", True, "Edge.RISING", 0.03),
        ("/dev/gpiochip4", "GPIO5", "Bias.PULL_DOWN", False, "Edge.RISING", 0.1),
    ]


def test_edges_of_a_pin_are_taken_all_at_once_and_without_waiting() -> None:
    library = FakeGpiod(real_gpiod)
    button = PinButton(Wiring("/dev/gpiochip0", 17), library=lambda: library)
    button.open()
    assert button.pressed() is False
    library.edges = 3
    assert (button.pressed(), button.pressed(), library.edges) == (True, False, 0)
    library.error = OSError(errno.ENODEV, "No such device")
    with pytest.raises(ButtonTrouble, match="there are no pins at /dev/gpiochip0"):
        button.pressed()
    button.close()


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (PermissionError(errno.EACCES, "Permission denied"), r"may not be used: `sudo adduser USER gpio`.*gpio\.conf"),
        (OSError(errno.EBUSY, "busy"), "line 17 at /dev/null is in use by another program: end that"),
        (OSError(errno.ENOENT, "no such line"), "/dev/null has no line 17: `gpioinfo` lists"),
        (ValueError("line offset of out range"), "/dev/null has no line 17: `gpioinfo` lists"),
        (OSError(errno.EOPNOTSUPP, "no bias"), r"line 17 at /dev/null cannot be used \(.*no bias\): set another line"),
    ],
)
def test_a_pin_that_cannot_be_had_is_told_with_its_cure(error: Exception, words: str) -> None:
    button = PinButton(Wiring("/dev/null", 17), library=lambda: FakeGpiod(real_gpiod, error=error))
    with pytest.raises(ButtonTrouble, match=words):
        button.open()


@pytest.mark.parametrize("chip", ["/dev/no-such-chip", "/dev/null", "/"])
@pytest.mark.parametrize("line", [17, "GPIO17"])
def test_the_real_library_says_that_there_are_no_pins(chip: str, line: int | str) -> None:
    with pytest.raises(ButtonTrouble, match=f"there are no pins at {chip}: "):
        PinButton(Wiring(chip, line)).open()


def test_without_the_library_or_with_an_old_one_it_is_said_which_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    cure = r"`pip install 'linedrawd\[gpio\]'`"
    old = ModuleType("gpiod")
    old.line = ModuleType("gpiod.line")  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "gpiod", old)
    monkeypatch.setitem(sys.modules, "gpiod.line", old.line)
    with pytest.raises(ButtonTrouble, match=f"too old: {cure}"):
        gpiod()
    monkeypatch.setitem(sys.modules, "gpiod", None)
    with pytest.raises(ButtonTrouble, match=f"version 2: {cure}"):
        gpiod()
