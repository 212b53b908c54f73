"""The scanner: each scan puts its pages into the inbox, as pictures that know their resolution."""

from __future__ import annotations

import os
import re
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from daemon.errors import DiskTrouble
from daemon.intake.sane import ScannerTrouble, is_busy, trouble_of
from daemon.intake.scanimage import Exit, Scanimage
from daemon.intake.spool import spool_in

LIST_WITHIN_S = 60.0
"""Network scanners are looked for; drivers for USB ask each device."""
BUSY_TRIES = 5
BUSY_RETRY_S = 3.0
_FEEDER = re.compile(r"adf|feed|duplex", re.IGNORECASE)
_CAMERA = "v4l:"
"""SANE lists these as scanners, too."""
_PAGE = re.compile(r"scan-\d{8}-\d{6}-\d+\.tiff")


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is scanned and how. device: SANE's name; "" takes the only one there is. source: "" is the scanner's first.

    size_mm: width and height from the corner; None is all the glass. options: further ones of the driver, by
    name; "" is one without a value.
    page_within_s: a scanner that gives no page for so long is stopped.
    """

    device: str = ""
    resolution_dpi: int = 300
    mode: str = "Gray"
    source: str = ""
    size_mm: tuple[float, float] | None = None
    options: dict[str, str] = field(default_factory=dict)
    page_within_s: float = 120.0


def is_scan(name: str) -> bool:
    """Whether a picture of this name is a page that a `Scanner` put into the inbox."""
    return _PAGE.fullmatch(name) is not None


class Scanner:
    """One scanner of SANE's. Calls come from any thread; only one scan runs at a time.

    stamp: the date and time that the pages of a scan are named by. wait: sleeps; returns at once after `end`.
    """

    def __init__(
        self,
        wanted: Wanted,
        inbox: Path,
        *,
        scanimage: Scanimage | None = None,
        stamp: Callable[[], str] = lambda: time.strftime("%Y%m%d-%H%M%S"),
        wait: Callable[[float], object] | None = None,
    ) -> None:
        self._wanted, self._inbox, self._stamp = wanted, inbox, stamp
        self._scanimage = scanimage or Scanimage()
        self._ended = threading.Event()
        self._wait = wait or self._ended.wait
        self._busy = threading.Lock()
        self._found = ""

    def scan(self) -> str:
        """Scan the page, or all that lie in the feeder; says how many there were.

        Each page is in the inbox as soon as it is whole. Raises ScannerTrouble, which also says how many pages came
        before it, and DiskTrouble.
        """
        with self._alone():
            stamp, pages = self._stamp(), list[Path]()

            def deliver(name: str) -> None:
                pages.append(self._deliver(spool / Path(name).name, stamp, len(pages) + 1))

            with spool_in(self._inbox) as spool:
                ended = self._patiently(spool, deliver)
            if ended.code or ended.overdue or ended.stopped or not pages:
                raise ScannerTrouble(_with_pages(self._why(ended), len(pages)))
        return f"{_pages(len(pages))} scanned into the inbox"

    def pressed(self, button: str) -> bool:
        """Whether the scanner says that this button of its is pressed. False while it scans.

        Raises ScannerTrouble when it cannot be asked or offers no such button.
        """
        if not self._busy.acquire(blocking=False):
            return False
        try:
            lines = self._lines(["-d", self._device(), *_options(self._wanted.options), "-A"])
        finally:
            self._busy.release()
        return _pressed(button, lines)

    def name(self) -> str:
        """SANE's name of the scanner that is used. Raises ScannerTrouble where there is none, or more than one."""
        return self._device()

    def end(self) -> None:
        """Stop what is scanned; no scan begins any more."""
        self._ended.set()
        self._scanimage.stop()

    def close(self) -> None:
        """Nothing may be asked any more."""
        self.end()
        with self._busy:
            self._scanimage.close()

    @contextmanager
    def _alone(self) -> Iterator[None]:
        if not self._busy.acquire(blocking=False):
            raise ScannerTrouble("the scanner is scanning: wait until it has finished")
        try:
            self._scanimage.forget_stops()
            if self._ended.is_set():
                raise ScannerTrouble("linedrawd is ending: start it again")
            yield
        finally:
            self._busy.release()

    def _patiently(self, spool: Path, page: Callable[[str], None]) -> Exit:
        """As long as the scanner is busy, and has given no page, it is tried again."""
        arguments, came = self._arguments(spool), list[str]()

        def note(name: str) -> None:
            came.append(name)
            page(name)

        for tried in range(1, BUSY_TRIES + 1):
            ended = self._scanimage.run(arguments, line=note, line_within_s=self._wanted.page_within_s)
            if came or tried == BUSY_TRIES or self._ended.is_set() or not is_busy(ended.code, ended.words):
                break
            self._wait(BUSY_RETRY_S)
        if ended.code:
            # It may have been unplugged and have come back under another name.
            self._found = ""
        return ended

    def _arguments(self, spool: Path) -> list[str]:
        """Always a batch: only then a page gets its name when it is whole. TIFF: it keeps the resolution."""
        wanted = self._wanted
        said = {"source": wanted.source, "mode": wanted.mode, "resolution": str(wanted.resolution_dpi)}
        arguments = ["-d", self._device(), "--format=tiff", "--batch-print", f"--batch={spool}/%d.tiff"]
        arguments += [] if _FEEDER.search(wanted.source) else ["--batch-count=1"]
        arguments += [*(f"--{name}={value}" for name, value in said.items() if value), *_options(wanted.options)]
        if wanted.size_mm:
            arguments += ["-x", f"{wanted.size_mm[0]:g}", "-y", f"{wanted.size_mm[1]:g}"]
        return arguments

    def _device(self) -> str:
        self._found = self._found or self._wanted.device or self._only_one()
        return self._found

    def _only_one(self) -> str:
        names = [name for name in self._lines(["--formatted-device-list=%d%n"]) if name and _CAMERA not in name[:5]]
        if len(names) > 1:
            raise ScannerTrouble(f"there are {len(names)} scanners, {', '.join(names)}: say which one with --scanner")
        if not names:
            raise ScannerTrouble(trouble_of(1, "no SANE devices found"))
        return names[0]

    def _lines(self, arguments: list[str]) -> list[str]:
        """What scanimage prints when it only tells."""
        lines: list[str] = []
        ended = self._scanimage.run(arguments, line=lines.append, line_within_s=LIST_WITHIN_S)
        if ended.code or ended.overdue or ended.stopped:
            raise ScannerTrouble(self._why(ended))
        return lines

    def _why(self, ended: Exit) -> str:
        if ended.stopped:
            return "the scan was broken off, because linedrawd ends: start it again"
        if ended.overdue:
            seconds = f"{self._wanted.page_within_s:g}"
            return (
                f"the scanner gave nothing for {seconds} s: look whether it waits for something, switch it off and on"
            )
        return trouble_of(ended.code or 5, ended.words)

    def _deliver(self, page: Path, stamp: str, number: int) -> Path:
        """Into the inbox by one rename, when it is on the disk."""
        try:
            with page.open("rb") as file:
                os.fsync(file.fileno())
            while (name := self._inbox / f"scan-{stamp}-{number}.tiff").exists():
                number += 1
            return page.rename(name)
        except OSError as error:
            raise DiskTrouble(
                f"the page cannot be put into the inbox {self._inbox} ({error.strerror}): mend the folder"
            ) from None


def _options(options: dict[str, str]) -> list[str]:
    return [f"--{name}={value}" if value else f"--{name}" for name, value in options.items()]


def _pressed(button: str, lines: list[str]) -> bool:
    """From the list of options: `--scan[=(yes|no)] [no] [hardware]`, `--button-1 <int> [0] [hardware]`."""
    sensors = {}
    for line in lines:
        found = re.match(r"\s*--([a-z0-9-]+).*?\s\[([^][]*)\] \[(?:hardware|read-only)\]", line)
        if found:
            sensors[found[1]] = found[2]
    if button not in sensors:
        offered = ", ".join(sensors) or "no other"
        raise ScannerTrouble(
            f"the scanner tells nothing of a button '{button}', but of {offered}: correct button in [scanner]"
        )
    return sensors[button] not in ("no", "0", "inactive", "")


def _pages(number: int) -> str:
    return "1 page" if number == 1 else f"{number} pages"


def _with_pages(why: str, number: int) -> str:
    return f"{_pages(number)} scanned into the inbox, then {why}" if number else why
