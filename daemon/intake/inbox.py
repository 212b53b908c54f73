"""The inbox: a folder where pictures are dropped; each is claimed once it has stopped growing."""

from __future__ import annotations

import errno
import fnmatch
import heapq
import os
import re
import stat
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from daemon.errors import DiskTrouble, SettingsError
from daemon.intake import side
from daemon.intake.rank import Order, Rank, rank

IGNORED = (".*", "*.part", "*.tmp", "*.crdownload", "*.filepart", "*~")
_IGNORED = re.compile("|".join(fnmatch.translate(pattern) for pattern in IGNORED))
UNCLOSED_FACTOR = 3.0
"""A file of which nobody has said that it was closed settles this many times longer."""
AT_ONCE = 50
"""So many are claimed in one step: whoever wants to stop waits no longer than for these."""
ALONE_S = 60.0
"""A side file may come so long before its picture until that is said."""

Looks: TypeAlias = tuple[int, int, int, int]
"""Mode, size in bytes, time of the content and of the entry in ns."""
_NOTHING: Looks = (0, 0, 0, 0)


@dataclass(frozen=True, slots=True)
class Seen:
    """A picture and its side file as they were last looked at, and since when they have looked like that."""

    picture: Looks
    side: Looks
    since_s: float


class Inbox:
    """What lies in the folder and has not been claimed. `step` looks once; no thread, no clock of its own.

    claim: takes a picture away, and its side file (None: it has none). Raises SettingsError when the side file is
    wrong; both are then left until one of them changes. Raises DiskTrouble when it cannot; it is then tried again.
    refuse: told once, with a sentence, about each file that is not claimed.
    signs: by the name of a file that says something; called when such a file was found (and removed).
    """

    def __init__(
        self,
        folder: Path,
        *,
        settle_s: float,
        claim: Callable[[Path, Path | None], None],
        refuse: Callable[[str], None],
        signs: Mapping[str, Callable[[], object]],
        order: Order = "arrival",
        whole_before_ns: int = 0,
    ) -> None:
        """whole_before_ns: what was last changed before that (ns of the epoch) is whole: nobody writes it any more."""
        self._folder, self._settle_s, self._order = folder, settle_s, order
        self._claim, self._refuse, self._signs = claim, refuse, signs
        self._whole_before_ns = whole_before_ns
        self._seen: dict[str, Seen] = {}
        self._refused: dict[str, tuple[Looks, Looks]] = {}
        self._of_stem: dict[str, set[str]] = {}
        self._settling: list[tuple[float, str]] = []
        self._settled: list[tuple[Rank, int, int, str]] = []
        self._lock = threading.Lock()
        self._noticed: set[str] = set()
        self._closed: set[str] = set()

    def notice(self, name: str, *, closed: bool = False) -> None:
        """Something has happened to this file; closed: it is whole. May be called from any thread."""
        with self._lock:
            self._noticed.add(name)
            if closed:
                self._closed.add(name)

    def step(self, now: float, *, everything: bool = True) -> float | None:
        """Look at what was noticed, or at everything, and claim what has settled, at most AT_ONCE.

        Returns when to look again; None: only when something happens.
        Raises DiskTrouble when the folder cannot be read or a claim failed: then look at everything, a little later.
        """
        noticed = self._taken_notice()
        for name in self._present() if everything else noticed:
            if name in self._signs:
                self._obey(name)
            elif not _IGNORED.match(name):
                self._look_at(name, now, told=name in noticed)
        while self._settling and self._settling[0][0] <= now:
            self._settle(heapq.heappop(self._settling)[1], now)
        for _ in range(min(AT_ONCE, len(self._settled))):
            self._take(heapq.heappop(self._settled)[-1], now)
        if self._settled:
            return now
        return self._settling[0][0] if self._settling else None

    def _taken_notice(self) -> set[str]:
        with self._lock:
            noticed, self._noticed = self._noticed, set()
        return noticed

    def _present(self) -> list[str]:
        try:
            present = os.listdir(self._folder)
        except OSError as error:
            raise DiskTrouble(f"the inbox {self._folder} cannot be read ({error.strerror}): make it again") from None
        for name in (self._seen.keys() | self._refused.keys()) - set(present):
            self._forget(name)
        return present

    def _forget(self, name: str) -> None:
        self._seen.pop(name, None)
        self._refused.pop(name, None)
        of_stem = self._of_stem.get(side.stem(name), set())
        of_stem.discard(name)
        if not of_stem:
            self._of_stem.pop(side.stem(name), None)
        with self._lock:
            self._closed.discard(name)

    def _obey(self, name: str) -> None:
        try:
            (self._folder / name).unlink()
        except FileNotFoundError:
            return
        except OSError as error:
            self._refuse_once(name, f"cannot be removed ({error.strerror}): remove it")
            return
        self._signs[name]()

    def _look_at(self, name: str, now: float, *, told: bool) -> None:
        """And at the pictures that it belongs to, where it is a side file."""
        found = self._looked_at(name, now)
        if found.picture == _NOTHING:
            self._forget(name)
        else:
            self._of_stem.setdefault(side.stem(name), set()).add(name)
            self._note(name, found, told=told)
        if told and side.is_side(name):
            for picture in self._of_stem.get(side.stem(name), set()) - {name}:
                self._look_at(picture, now, told=True)

    def _note(self, name: str, found: Seen, *, told: bool) -> None:
        before = self._seen.get(name)
        if self._refused.get(name) == (found.picture, found.side):
            return
        if not stat.S_ISREG(found.picture[0]):
            self._refuse_once(name, f"is {_kind(found.picture[0])}, no file: put the picture itself there")
        elif before is None or (before.picture, before.side) != (found.picture, found.side):
            self._watch(name, found)
        elif told:
            self._watch(name, before)

    def _looked_at(self, name: str, now: float) -> Seen:
        beside = _NOTHING if side.is_side(name) else self._looks(side.side_name(name))
        return Seen(self._looks(name), beside, now)

    def _looks(self, name: str) -> Looks:
        try:
            found = (self._folder / name).lstat()
        except OSError:
            return _NOTHING
        return found.st_mode, found.st_size, found.st_mtime_ns, found.st_ctime_ns

    def _watch(self, name: str, seen: Seen) -> None:
        self._seen[name] = seen
        heapq.heappush(self._settling, (self._due_s(name), name))

    def _due_s(self, name: str) -> float:
        seen = self._seen[name]
        if side.is_side(name):
            return seen.since_s + ALONE_S
        if max(seen.picture[-1], seen.side[-1]) < self._whole_before_ns:
            return seen.since_s
        whole = name in self._closed and (seen.side == _NOTHING or side.side_name(name) in self._closed)
        return seen.since_s + self._settle_s * (1 if whole else UNCLOSED_FACTOR)

    def _settle(self, name: str, now: float) -> None:
        """Its time had come; meanwhile it may have gone, or grown."""
        if name not in self._seen or self._due_s(name) > now:
            return
        if not side.is_side(name):
            *_, changed_ns, arrived_ns = self._seen[name].picture
            heapq.heappush(self._settled, (rank(name, self._order), arrived_ns, changed_ns, name))
        elif self._of_stem[side.stem(name)] == {name}:
            self._refuse_once(name, "has no picture beside it: put its picture there, or remove it")

    def _take(self, name: str, now: float) -> None:
        found, seen = self._looked_at(name, now), self._seen.get(name)
        if seen is None or (found.picture, found.side) != (seen.picture, seen.side):
            self._look_at(name, now, told=False)
            return
        path = self._folder / name
        beside = None if found.side == _NOTHING else self._folder / side.side_name(name)
        del self._seen[name]
        try:
            # A link put in the file's place since it was looked at is not followed, a pipe does not block.
            os.close(os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK))
            self._claim(path, beside)
        except FileNotFoundError:
            pass
        except SettingsError as error:
            return self._remember_refused(name, str(error))
        except DiskTrouble:
            self._begin_anew()
            raise
        except OSError as error:
            reason = "is a symbolic link" if error.errno == errno.ELOOP else f"cannot be read ({error.strerror})"
            return self._refuse_once(name, f"{reason}: correct its rights or drop it again")
        for gone in (path, beside):
            if gone is not None:
                self._forget(gone.name)
        return None

    def _begin_anew(self) -> None:
        for known in (self._seen, self._of_stem, self._settling, self._settled):
            known.clear()

    def _refuse_once(self, name: str, words: str) -> None:
        self._remember_refused(name, f"{readable(name)} in the inbox {words}")

    def _remember_refused(self, name: str, words: str) -> None:
        self._seen.pop(name, None)
        found = self._looked_at(name, 0.0)
        if found.picture != _NOTHING and self._refused.get(name) != (found.picture, found.side):
            self._refused[name] = found.picture, found.side
            self._refuse(words)


def readable(name: str) -> str:
    """A file name as one line of text, whatever bytes it is made of."""
    text = os.fsencode(name).decode("utf-8", "backslashreplace")
    return "".join(letter if letter.isprintable() else repr(letter)[1:-1] for letter in text)


def _kind(mode: int) -> str:
    kinds = {stat.S_IFLNK: "a symbolic link", stat.S_IFIFO: "a pipe", stat.S_IFDIR: "a folder"}
    return kinds.get(stat.S_IFMT(mode), "a special file")
