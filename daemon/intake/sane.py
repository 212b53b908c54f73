"""What SANE says when a scan goes wrong, as sentences with a remedy (SANE standard 1.06, section 4.2.7)."""

from __future__ import annotations

import re
import signal

from daemon.errors import LinedrawError

BUSY = 3
"""The one status that passes by itself."""

_STATUSES = {
    1: "the scanner does not do what it was asked: see what it offers with `scanimage -A`, and correct [scanner]",
    2: "the scan was cancelled at the scanner: scan again",
    BUSY: "the scanner is in use by another program or computer: close that, then scan again",
    4: "the scanner does not take a setting: see what it offers with `scanimage -A`, and correct [scanner]",
    5: "the scanner had no more to give: scan again",
    6: "paper is jammed in the scanner's feeder: take it out, put the rest of the pages in, scan again",
    7: "the scanner's feeder is empty: put pages in, or set another source in [scanner]",
    8: "the scanner's lid is open: close it, then scan again",
    9: "the connection to the scanner broke off: check its cable or network, switch it off and on, scan again",
    10: "the scanner or this computer has no memory left for the page: lower resolution_dpi in [scanner]",
    11: "this user may not use the scanner: add the user to the group scanner (a multi-function device: lp)",
    12: "the scanner is warming up: wait a minute, then scan again",
    13: "the scanner's transport lock is closed: unlock it, then scan again",
}
"""By SANE_Status, which is also scanimage's exit code; 12 and 13 are of SANE's later headers."""

_WORDS = {
    r"no SANE devices found": "no scanner is found: switch it on and plug it in, then look with `scanimage -L`",
    r"open of device .* failed: Invalid argument": "there is no such scanner: `scanimage -L` lists those there are; "
    "correct device in [scanner]",
    r"open of device .* failed: Device busy": _STATUSES[BUSY],
    r"open of device .* failed: (Access|Permission)": _STATUSES[11],
    r"open of device .* failed: Error during device I/O": _STATUSES[9],
    r"setting of option|inactive option|unrecognized option|option .* not supported|ambiguous|bad value": _STATUSES[4],
    r"cannot open .*\.part|[Nn]o space left": "the page cannot be written: make room on the disk of the inbox",
}
"""What scanimage says on stderr where its exit code alone says less."""


class ScannerTrouble(LinedrawError):
    """No page, or not all pages, came from the scanner."""


def trouble_of(code: int, words: str) -> str:
    """A sentence for an exit code of scanimage that is not 0. words: what it said on stderr."""
    said = _telling(words)
    if code < 0:
        name = signal.Signals(-code).name if -code in list(signal.Signals) else f"signal {-code}"
        return (
            f"the scanner's driver has crashed ({name}): scan again; if it crashes again, switch the scanner off and on"
        )
    for pattern, sentence in _WORDS.items():
        if re.search(pattern, words):
            return _with(sentence, said)
    return _with(_STATUSES.get(code, f"the scan failed with status {code}: try it with `scanimage` by hand"), said)


def is_busy(code: int, words: str) -> bool:
    """Whether trying again may help."""
    return code == BUSY or "Device busy" in words


def _with(sentence: str, said: str) -> str:
    """The sentence with scanimage's own words before its remedy."""
    what, colon, remedy = sentence.partition(": ")
    return f"{what} ({said}){colon}{remedy}" if said else sentence


def _telling(words: str) -> str:
    """The line that says what was wrong; the others count pages."""
    lines = [line.removeprefix("scanimage: ").strip() for line in words.splitlines() if "scanimage: " in line]
    told = [line for line in lines if not line.startswith("rounded value")]
    return re.sub(r"/\S*/", "", told[-1]) if told else ""
