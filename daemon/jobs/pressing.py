"""Pressing: the button of the settings, heard by a thread of its own."""

from __future__ import annotations

from collections.abc import Callable
from threading import Event

from daemon.config import Button as ButtonSettings
from daemon.intake.button import Button, ButtonWatch
from daemon.intake.keyboard import KeyButton
from daemon.intake.keys import code_of
from daemon.intake.pin import PinButton, Wiring


def button_of(said: ButtonSettings) -> Button | None:
    """The button that is set; None where none is. Nothing is opened yet."""
    if said.kind == "key":
        return KeyButton(said.path, code_of(said.key), grab=said.grab)
    if said.kind == "gpio" and said.line is not None:
        return PinButton(Wiring(said.chip, said.line, said.pull, said.debounce_s))
    return None


class Pressing:
    """`run` hears the button until `end`, which may be called from any thread.

    press: what it does; raises LinedrawError. say: told what happened. trouble: told what went wrong.
    """

    def __init__(
        self,
        said: ButtonSettings,
        press: Callable[[], object],
        *,
        say: Callable[[str], None],
        trouble: Callable[[str], None],
    ) -> None:
        self._ended, button = Event(), button_of(said)
        self._watch = ButtonWatch(button, press, say=say, trouble=trouble) if button else None

    def run(self) -> None:
        if self._watch:
            self._watch.run()
        self._ended.wait()

    def end(self) -> None:
        if self._watch:
            self._watch.stop()
        self._ended.set()
