"""A button beside the machine: waited for in a thread of its own, and looked for again when it has gone."""

from __future__ import annotations

import os
import select
import threading
from collections.abc import Callable
from typing import Protocol

from daemon.errors import LinedrawError

RETRY_S = 2.0
"""So long after a trouble the button is looked for again."""


class ButtonTrouble(LinedrawError):
    """The button cannot be heard: it is not plugged in, not allowed, or the settings name another."""


class Button(Protocol):
    """Something to press. Each method raises ButtonTrouble; after one the button is closed and opened anew."""

    def open(self) -> int:
        """Begin to hear it. Returns a file descriptor that is readable when something has come."""
        ...

    def pressed(self) -> bool:
        """Take what has come, without waiting; True when it has been pressed among that."""
        ...

    def close(self) -> None:
        """Hear it no longer. May be called again, and where it was never opened."""
        ...


class ButtonWatch:
    """`run` hears the button until `stop`, which may be called from any thread.

    press: what is done when it is pressed; raises LinedrawError. What is pressed while it is done is forgotten.
    say: told that the button is there again. trouble: told, once each, what went wrong.
    """

    def __init__(
        self,
        button: Button,
        press: Callable[[], object],
        *,
        say: Callable[[str], None],
        trouble: Callable[[str], None],
        retry_s: float = RETRY_S,
    ) -> None:
        self._button, self._press, self._say, self._trouble, self._retry_s = button, press, say, trouble, retry_s
        self._told, self._stopped, self._lock = "", threading.Event(), threading.Lock()
        self._wake = -1

    def run(self) -> None:
        with self._lock:
            self._wake = os.eventfd(0)
        try:
            while not self._stopped.is_set():
                self._hear()
        finally:
            with self._lock:
                os.close(self._wake)
                self._wake = -1

    def stop(self) -> None:
        with self._lock:
            self._stopped.set()
            if self._wake >= 0:
                os.eventfd_write(self._wake, 1)

    def _hear(self) -> None:
        """Until it is stopped, or the button has gone and a while has passed."""
        try:
            opened = self._button.open()
            self._is_there()
            while self._comes(opened):
                if self._button.pressed():
                    self._do()
        except ButtonTrouble as error:
            self._tell(str(error))
        finally:
            self._button.close()
        self._comes(None, within_s=self._retry_s)

    def _comes(self, opened: int | None, *, within_s: float | None = None) -> bool:
        """Wait for what comes from the button. False when it was stopped meanwhile, or the time is over."""
        waited = select.poll()
        for file in (self._wake, opened):
            if file is not None:
                waited.register(file, select.POLLIN)
        waited.poll(None if within_s is None else within_s * 1000)
        return not self._stopped.is_set()

    def _do(self) -> None:
        try:
            self._press()
        except LinedrawError as error:
            self._trouble(str(error))
        self._button.pressed()

    def _is_there(self) -> None:
        if self._told:
            self._say("the button is there")
        self._told = ""

    def _tell(self, words: str) -> None:
        if words != self._told and not self._stopped.is_set():
            self._told = words
            self._trouble(words)
