"""Which commands an arm has taken into its queue, judged by the indices that it acknowledges."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

_MOST = 8
"""More commands without a settled fate than this are not gone through."""


@dataclass(slots=True)
class Sent:
    """A command that went to the arm. settled: its fate is certain. index: where it is in the queue, None: nowhere."""

    id: int
    settled: bool = False
    index: int | None = None


class Count:
    """The arm counts what it takes; each acknowledgement names the command by its index, however late it comes.

    Commands without an acknowledgement may have been taken or not. Of all the ways in which that can have gone, those
    remain that explain every index that was heard; what all of them agree about is certain. That an arm counts by
    one is documented nowhere, so nothing is concluded from a gap before it has been seen to; where an index does
    not fit, only a command's own acknowledgement counts, and only when nothing else may have caused it.
    """

    def __init__(self) -> None:
        self.last: int | None = None
        """The index before all of `open`; None until one was heard."""
        self.open: list[Sent] = []
        """What was sent behind it, in order."""
        self._heard: set[tuple[int, int]] = set()
        self._seen_by_one = False
        self._irregular = False

    @property
    def top(self) -> int | None:
        """The highest index that is known."""
        known = {index for _, index in self._heard} | (set() if self.last is None else {self.last})
        return max(known, default=None)

    def sends(self, number: int) -> Sent:
        """A command with this id goes out."""
        self.open.append(Sent(number))
        return self.open[-1]

    def hears(self, number: int, index: int) -> bool:
        """The arm acknowledges a command with this id. Returns whether that is anything new.

        The first index of all must belong to one of several commands that are alike: `last` is then that index, and
        the others may stand behind it.
        """
        if not any(sent.id == number for sent in self.open) or (self.last is not None and index <= self.last):
            return False
        if self.last is None:
            self.last = index
            first = self.open.pop(0)
            first.settled, first.index = True, index
            return True
        known = {self.last, *(heard for _, heard in self._heard)}
        self._seen_by_one = self._seen_by_one or index - 1 in known or index + 1 in known
        self._heard.add((number, index))
        self._conclude()
        return True

    def _conclude(self) -> None:
        if len(self.open) > _MOST:
            return
        ways = self._explanations()
        self._irregular = self._irregular or not ways
        for sent, fates in zip(self.open, self._own() if self._irregular else zip(*ways, strict=True), strict=True):
            if len(set(fates)) == 1 and self._is_safe(sent, fates[0]):
                sent.settled, sent.index = True, fates[0]
        self._forget()

    def _own(self) -> list[tuple[int | None, ...]]:
        """The index of every open command that is the only one of its kind and has been acknowledged."""
        ids = [sent.id for sent in self.open]
        return [tuple(index for number, index in self._heard if number == one and ids.count(one) == 1) for one in ids]

    def _explanations(self) -> list[list[int | None]]:
        """For each way that explains what was heard: the index of every open command, None where it was not taken."""
        ways = []
        for taken in product((False, True), repeat=len(self.open)):
            index = self.last or 0
            way: list[int | None] = []
            for one in taken:
                index += one
                way.append(index if one else None)
            if self._heard <= {(sent.id, at) for sent, at in zip(self.open, way, strict=True)}:
                ways.append(way)
        return ways

    def _is_safe(self, sent: Sent, index: int | None) -> bool:
        return index is None or self._seen_by_one or (sent.id, index) in self._heard

    def _forget(self) -> None:
        """What lies before the last command whose index is certain tells nothing any more."""
        at = max((at for at, sent in enumerate(self.open) if sent.index is not None), default=-1)
        if at >= 0:
            self.last = self.open[at].index
            del self.open[: at + 1]
            self._heard = {heard for heard in self._heard if heard[1] > (self.last or 0)}
