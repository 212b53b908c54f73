"""Scanning: the scanner of the settings, its button, and whoever asks for a scan."""

from __future__ import annotations

from collections.abc import Callable
from threading import Event

from daemon.config import Settings
from daemon.errors import LinedrawError, SettingsError
from daemon.intake.scan_button import ScanButton
from daemon.intake.scanner import Scanner, Wanted
from daemon.intake.spool import remove_leftovers


def scanner_of(settings: Settings) -> Scanner:
    """The scanner that is set; it scans into the inbox. Raises SettingsError when none is."""
    said = settings.scanner
    if said.kind == "none":
        raise SettingsError("no scanner is set: give --scanner sane, or a section [scanner] in the settings")
    wanted = Wanted(
        device=said.device,
        resolution_dpi=said.resolution_dpi,
        mode=said.mode,
        source=said.source,
        size_mm=said.size_mm,
        options=said.driver_options,
        page_within_s=said.page_within_s,
    )
    return Scanner(wanted, settings.paths.inbox)


class Scanning:
    """`run` watches the button until `end`; `scan` is for orders. Both may be called from any thread.

    say: told what was scanned. trouble: told what went wrong.
    """

    def __init__(self, settings: Settings, *, say: Callable[[str], None], trouble: Callable[[str], None]) -> None:
        self._inbox, self._say, self._ended = settings.paths.inbox, say, Event()
        self._scanner = scanner_of(settings) if settings.scanner.kind != "none" else None
        self._button = None
        if self._scanner and settings.scanner.button:
            every_s = settings.scanner.button_every_s
            self._button = ScanButton(
                self._scanner, settings.scanner.button, every_s=every_s, said=say, trouble=trouble
            )

    def run(self) -> None:
        remove_leftovers(self._inbox)
        if self._button:
            self._button.run()
        self._ended.wait()
        if self._scanner:
            self._scanner.close()

    def scan(self) -> str:
        """Scan now; says how many pages came. Raises LinedrawError."""
        if self._scanner is None:
            raise LinedrawError("no scanner is set: start linedrawd with --scanner sane, or add a section [scanner]")
        words = self._scanner.scan()
        self._say(words)
        return words

    def end(self) -> None:
        """What is scanned is broken off."""
        if self._button:
            self._button.stop()
        if self._scanner:
            self._scanner.end()
        self._ended.set()
