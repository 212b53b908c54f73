"""How many metres of line a pen has drawn, and whether it is worn."""

from __future__ import annotations

import json
import logging
import math
import threading
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

from daemon.errors import DiskTrouble
from daemon.jobs.folder import write_durably
from daemon.program.svg import LineMm, read_svg


class PenLife:
    """The metres of the pen that is in the machine, kept in a file. Calls come from any thread.

    life_m: after so many it is said that the pen is worn; None: never.
    """

    def __init__(
        self,
        path: Path,
        life_m: float | None,
        *,
        say: Callable[..., None],
        show: Callable[..., None],
        sign: str = "PEN",
    ) -> None:
        """sign: the file that says that a new pen is in."""
        self._path, self._life_m, self._say, self._show, self._sign = path, life_m, say, show, sign
        self._lock = threading.Lock()
        self.ink_m = _metres_in(path)
        self._show_it()

    def drew(self, folder: Path, strokes: int) -> None:
        """The first strokes of the job in this folder are on paper."""
        self._set(self.ink_m + drawn_m(folder, strokes))

    def new(self) -> None:
        """A person has put a new pen in."""
        self._say("a new pen is in", drawn_with_the_old_m=round(self.ink_m, 1))
        self._set(0.0)

    @property
    def worn(self) -> bool:
        return self._life_m is not None and self.ink_m >= self._life_m

    def _set(self, ink_m: float) -> None:
        with self._lock:
            was_worn, self.ink_m = self.worn, ink_m
            try:
                write_durably(self._path, json.dumps({"ink_m": round(ink_m, 3)}).encode())
            except DiskTrouble as error:
                self._say(str(error), level=logging.ERROR)
            if self.worn and not was_worn:
                self._say(self._words(), level=logging.WARNING)
        self._show_it()

    def _show_it(self) -> None:
        self._show(ink_m=round(self.ink_m, 2), pen=self._words() if self.worn else "")

    def _words(self) -> str:
        return (
            f"the pen has drawn {self.ink_m:.0f} m and lasts {self._life_m:g} m: "
            f"change it, then put a file {self._sign} into the inbox"
        )


def drawn_m(folder: Path, strokes: int) -> float:
    """Metres of line in a job's first strokes; 0 where its folder has no drawing."""
    return sum(_length_mm(line) for line in lines_of(folder)[:strokes]) / 1000


def lines_of(folder: Path) -> list[LineMm]:
    """The strokes of a planned job in the order in which they are drawn; none where its folder has no drawing."""
    try:
        return read_svg((folder / "drawing.svg").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return []


def _length_mm(line: LineMm) -> float:
    return sum(math.dist(before, after) for before, after in pairwise(line))


def _metres_in(path: Path) -> float:
    try:
        return float(json.loads(path.read_text(encoding="utf-8"))["ink_m"])
    except (OSError, ValueError, KeyError, TypeError):
        return 0.0
