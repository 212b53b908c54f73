"""A simulated controller on a clock of its own, for tests that talk to it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from firmware_protocol.grbl.simulator.simulator import GrblSimulator

BRISK = {1: 255, 110: 3000, 111: 3000, 112: 3000, 120: 200, 121: 200, 122: 200}


class Talk:
    """What has been sent and heard; `heard` are whole lines with the time at which each was whole."""

    def __init__(self, **options: Any) -> None:
        self.sim = GrblSimulator(**({"settings": BRISK} | options))
        self.now = 0.0
        self.heard: list[tuple[float, str]] = []
        self._rest = b""
        self.sim.open(0.0)

    def send(self, data: str | bytes) -> None:
        self.sim.receive(data.encode("latin-1") if isinstance(data, str) else data, self.now)

    def wait(self, seconds: float) -> list[str]:
        """Let the time pass; returns the lines heard meanwhile."""
        return self.until(self.now + seconds)

    def until(self, now: float) -> list[str]:
        first = len(self.heard)
        while (event := self.sim.next_time()) is not None and event <= now:
            self._hear(event)
        self._hear(now)
        return [line for _, line in self.heard[first:]]

    def ask(self, data: str | bytes, *, within_s: float = 0.2) -> list[str]:
        """Send, wait, and return what was heard."""
        self.send(data)
        return self.wait(within_s)

    def settle(self) -> list[str]:
        """Let the time pass until nothing more will happen."""
        first = len(self.heard)
        while (event := self.sim.next_time()) is not None:
            self._hear(event)
        return [line for _, line in self.heard[first:]]

    def time_of(self, line: str, nth: int = 0) -> float:
        return [when for when, text in self.heard if text.startswith(line)][nth]

    def stream(self, lines: Sequence[str], window: int = 128) -> list[str]:
        """Send lines by character counting and return the answers."""
        unanswered: list[int] = []
        first, at = len(self.heard), 0
        while at < len(lines) or unanswered:
            while at < len(lines) and sum(unanswered) + len(lines[at]) + 1 <= window:
                self.send(lines[at] + "\n")
                unanswered.append(len(lines[at]) + 1)
                at += 1
            event = self.sim.next_time()
            assert event is not None, f"{len(unanswered)} lines are never answered"
            before = len(self.heard)
            self._hear(event)
            answers = [line for _, line in self.heard[before:] if line == "ok" or line.startswith("error:")]
            del unanswered[: len(answers)]
        return [line for _, line in self.heard[first:]]

    def _hear(self, now: float) -> None:
        self.now = max(self.now, now)
        *lines, self._rest = (self._rest + self.sim.advance(self.now)).split(b"\n")
        self.heard += [(self.now, line.decode("latin-1").rstrip("\r")) for line in lines]


def talk(**options: Any) -> Talk:
    """A controller whose banner has been read."""
    conversation = Talk(**options)
    conversation.wait(2.0)
    conversation.heard.clear()
    return conversation
