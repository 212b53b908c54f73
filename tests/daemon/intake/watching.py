"""A watch that runs in a thread of its own while a test looks."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Thread
from typing import Protocol


class Watch(Protocol):
    """`run` goes on until `stop`."""

    def run(self) -> None: ...

    def stop(self) -> None: ...


@contextmanager
def watching(watch: Watch) -> Iterator[None]:
    thread = Thread(target=watch.run)
    thread.start()
    try:
        yield
    finally:
        watch.stop()
        thread.join(10)
    assert not thread.is_alive()
