"""The arm's queue as the host knows it: what was acknowledged, what of it is executed, and what there is room for."""

from __future__ import annotations

from firmware_protocol.dobot.commands import NONE_YET

USUAL_DEPTH = 32
SPARE = 2
"""Places that are never filled: nobody has documented what an arm does when its queue is full."""


class Queue:
    """From one clearing to the next. An index is never computed: it comes from acknowledgements, compared with `>=`.

    depth: places, as the arm has stated. before: what 246 said when the queue was empty; an arm that begins its
    indices anew may go on to say it until something new is executed.
    """

    def __init__(self, depth: int, *, before: int) -> None:
        self.depth = depth or USUAL_DEPTH
        self._said = before
        self._stale = True
        self._entries: list[int | None] = []
        """The index of each command in its order; None where the acknowledgement was lost."""
        self._top = -1
        """The highest index that is known."""
        self._gone = self._known_gone = 0
        """How many of the entries are executed as far as is known, and how many of these have an index."""
        self.unknown = 0
        """Commands whose acknowledgement was lost, so that their index is not known."""

    @property
    def accepted(self) -> int:
        """Commands that are or were in the queue."""
        return len(self._entries)

    @property
    def executed(self) -> int:
        """How many commands are certainly executed.

        As many as there are known indices up to the last executed one, whichever commands they belong to, and one
        more where that one is higher than all of them.
        """
        beyond = self.unknown > 0 and not self._stale and self._said > self._top
        return self._known_gone + beyond

    @property
    def ahead(self) -> int:
        """Commands that wait or run, as far as is known."""
        return self.accepted - self._gone

    @property
    def room(self) -> bool:
        """Whether one more may be sent."""
        return self.ahead < max(1, self.depth - SPARE)

    def accept(self, index: int | None) -> None:
        """One more is in the queue; None: its acknowledgement was lost."""
        self._entries.append(index)
        self._top = max(self._top, -1 if index is None else index)
        self.unknown += index is None

    def late(self, index: int) -> None:
        """An acknowledgement came that nobody waits for any more: one index more is known."""
        if not self.unknown:
            return
        self.unknown -= 1
        self._entries.remove(None)
        later = (at for at, entry in enumerate(self._entries) if entry is not None and entry > index)
        self._entries.insert(next(later, len(self._entries)), index)
        self._top = max(self._top, index)
        self._gone = self._known_gone = 0
        self._count()

    def read(self, said: int) -> bool:
        """Take what 246 says. Returns False when it has gone back: then the arm has restarted."""
        if self._stale and (said == self._said or _none(said)):
            return True
        went_back = not self._stale and (_none(said) or said < self._said)
        self._said, self._stale = said, False
        self._count()
        return not went_back

    def left_over(self, left: int) -> int:
        """How many more commands are in the queue than is known, when 247 says `left`."""
        return self.depth - left - self.ahead

    def _count(self) -> None:
        """All up to the last command whose index has been reached, and a lost one that only a higher index can be."""
        if self._stale:
            return
        last = self._gone
        for at in range(self._gone, len(self._entries)):
            entry = self._entries[at]
            if entry is not None and entry > self._said:
                return
            if entry is not None:
                last = self._gone = at + 1
                self._known_gone += 1
        if self._said > self._top:
            self._gone = max(self._gone, min(len(self._entries), last + 1))


def _none(said: int) -> bool:
    return said in (0, NONE_YET)
