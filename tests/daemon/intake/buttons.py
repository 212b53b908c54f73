"""Buttons without a hand: what a kernel says of keys, and a library of pins."""

from __future__ import annotations

import os
import struct
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from queue import Queue
from threading import Event, Semaphore
from types import SimpleNamespace
from typing import Any

from daemon.intake.button import Button, ButtonTrouble, ButtonWatch
from tests.daemon.intake.watching import watching

UP, DOWN, HELD = 0, 1, 2
ENTER, SPACE = 28, 57
SECOND = 12345


def event(kind: int, code: int, value: int) -> bytes:
    """As a 64-bit kernel writes it: struct input_event."""
    return struct.pack("qqHHi", SECOND, 678, kind, code, value)


def key(code: int, value: int) -> bytes:
    """With what comes around it: MSC_SCAN before, SYN_REPORT behind."""
    return event(4, 4, 0x70058) + event(1, code, value) + event(0, 0, 0)


class FakeButton:
    """A `Button`. Each opening meets the next of `finds`: "" is a button, else the words of the trouble."""

    def __init__(self, *finds: str) -> None:
        self._finds, self._lost, self.opened, self._pipe = list(finds), "", 0, (-1, -1)
        self.there, self._looks = Event(), Semaphore(0)

    def open(self) -> int:
        self.opened += 1
        words = self._finds.pop(0) if self._finds else ""
        if words:
            raise ButtonTrouble(words)
        self._pipe, self._lost = os.pipe2(os.O_NONBLOCK), ""
        self.there.set()
        return self._pipe[0]

    def press_and_wait(self) -> None:
        """Until it has been obeyed, and what came meanwhile forgotten."""
        assert self.there.wait(10)
        self.press()
        for _ in range(2):
            assert self._looks.acquire(timeout=10)

    def press(self, times: int = 1) -> None:
        os.write(self._pipe[1], b"!" * times)

    def lose(self, words: str) -> None:
        self._lost = words
        self.press()

    def pressed(self) -> bool:
        if self._lost:
            raise ButtonTrouble(self._lost)
        try:
            return bool(os.read(self._pipe[0], 100))
        except BlockingIOError:
            return False
        finally:
            self._looks.release()

    def close(self) -> None:
        pipe, self._pipe = self._pipe, (-1, -1)
        for file in pipe:
            if file >= 0:
                os.close(file)


class Ears:
    """What a watch does and says, in its order. `next` waits for it."""

    def __init__(self) -> None:
        self.heard: Queue[str] = Queue()
        self.press: Callable[[], object] = lambda: self.heard.put("pressed")

    def next(self) -> str:
        return self.heard.get(timeout=10)

    @contextmanager
    def of(self, button: Button, *, retry_s: float = 0.01) -> Iterator[None]:
        watch = ButtonWatch(
            button,
            self.press,
            say=lambda words: self.heard.put(f"said: {words}"),
            trouble=lambda words: self.heard.put(f"trouble: {words}"),
            retry_s=retry_s,
        )
        with watching(watch):
            yield


class FakeGpiod:
    """Of the library gpiod 2 what a button at a pin takes. error: what a request meets."""

    def __init__(self, real: Any, *, error: Exception | None = None) -> None:
        self.line, self.LineSettings = real.line, real.LineSettings
        self.requests: list[tuple[str, dict[int | str, Any]]] = []
        self.released, self.edges, self.error = 0, 0, error

    def request_lines(self, chip: str, *, consumer: str, config: dict[int | str, Any]) -> Any:
        if self.error:
            raise self.error
        self.requests.append((chip, config))
        return SimpleNamespace(fd=77, wait_edge_events=self._waits, read_edge_events=self._reads, release=self._release)

    def _waits(self, timeout: float) -> bool:
        assert timeout == 0
        if self.error:
            raise self.error
        return self.edges > 0

    def _reads(self) -> list[str]:
        self.edges -= 1
        return ["edge"]

    def _release(self) -> None:
        self.released += 1
