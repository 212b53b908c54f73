"""The scanner's button: looked at now and then, between two scans; pressing it scans."""

from __future__ import annotations

import threading
from collections.abc import Callable

from daemon.errors import LinedrawError
from daemon.intake.scanner import Scanner

UNREACHABLE_RETRY_S = 30.0
"""A scanner that is switched off is not asked every second."""


class ScanButton:
    """`step` looks once; `run` does until `stop`, which may be called from any thread.

    said: told what was scanned. trouble: told, once each, what went wrong.
    """

    def __init__(
        self,
        scanner: Scanner,
        button: str,
        *,
        every_s: float,
        said: Callable[[str], None],
        trouble: Callable[[str], None],
    ) -> None:
        self._scanner, self._button, self._every_s = scanner, button, every_s
        self._said, self._trouble = said, trouble
        self._was_pressed, self._told = False, ""
        self._stopped = threading.Event()

    def step(self) -> float:
        """Scan when the button has been pressed since the last look. Returns the seconds until the next one."""
        try:
            pressed = self._scanner.pressed(self._button)
            self._told = ""
            begins, self._was_pressed = pressed and not self._was_pressed, pressed
        except LinedrawError as error:
            self._tell(str(error))
            return UNREACHABLE_RETRY_S
        if begins:
            self._scan()
        return self._every_s

    def run(self) -> None:
        while not self._stopped.is_set():
            self._stopped.wait(self.step())

    def stop(self) -> None:
        self._stopped.set()

    def _scan(self) -> None:
        try:
            self._said(self._scanner.scan())
        except LinedrawError as error:
            self._trouble(str(error))

    def _tell(self, words: str) -> None:
        if words != self._told and not self._stopped.is_set():
            self._told = words
            self._trouble(words)
