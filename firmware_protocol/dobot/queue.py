"""The arm's queue as the host knows it: what is in it, what of it is executed, and what there is room for."""

from __future__ import annotations

from bisect import bisect_right, insort

from firmware_protocol.dobot.commands import NONE_YET

USUAL_DEPTH = 32
SPARE = 2
"""Places that are never filled: nobody has documented what an arm does when its queue is full."""


class Queue:
    """From one clearing to the next. Indices come from acknowledgements and are compared with `>=`.

    depth: places, as the arm has stated. before: what 246 said when the queue was empty. stale: an arm that begins
    its indices anew may go on to say it until something new is executed.
    """

    def __init__(self, depth: int, *, before: int, stale: bool) -> None:
        self.depth = depth or USUAL_DEPTH
        self._said = _executed(before)
        self.stale = stale
        """What 246 has said so far may not be about this queue."""
        self._lines: list[int] = []
        """Indices of the commands that something waits for."""
        self._waits: list[int] = []
        """Indices of those that only tell how far the arm counts."""

    @property
    def accepted(self) -> int:
        """Commands that are or were in the queue, without those that only tell how far the arm counts."""
        return len(self._lines)

    @property
    def executed(self) -> int:
        """How many of them are certainly executed."""
        return self._up_to_now(self._lines)

    @property
    def ahead(self) -> int:
        """Commands of both kinds that wait or run."""
        return sum(len(indices) - self._up_to_now(indices) for indices in (self._lines, self._waits))

    def room(self, loose: int) -> bool:
        """Whether one more may be sent. loose: commands of which it is not known whether they are in the queue."""
        return self.ahead + loose < max(1, self.depth - SPARE)

    def accept(self, index: int) -> None:
        """A command is in the queue."""
        insort(self._lines, index)

    def accept_wait(self, index: int) -> None:
        """A command is in the queue that only tells how far the arm counts."""
        insort(self._waits, index)

    def begins_anew(self, index: int) -> bool:
        """Whether the arm counts from the beginning, now that the first command has this index."""
        self.stale = self.stale and index <= self._said
        return self.stale

    def is_told_apart(self, index: int) -> bool:
        """Whether 246 can say this index and not mean the one that it said before."""
        return index != self._said

    def read(self, said: int) -> bool:
        """Take what 246 says. Returns False when it has gone back: the arm has restarted, or that was said before."""
        executed = _executed(said)
        if self.stale and executed == self._said:
            return True
        if not self.stale and executed < self._said:
            return False
        self._said, self.stale = executed, False
        return True

    def _up_to_now(self, indices: list[int]) -> int:
        return 0 if self.stale else bisect_right(indices, self._said)


def _executed(said: int) -> int:
    """Below every index where nothing is executed yet."""
    return -1 if said in (0, NONE_YET) else said
