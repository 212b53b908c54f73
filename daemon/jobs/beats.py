"""The heart of the drawing loop beats while one turn of it lasts as long as a drawing."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from daemon.jobs.pool import Pool
from daemon.pulse import Heart
from firmware_protocol.session import Event, Sent

LINK_WITHIN_S = 60.0
"""Of the drawing loop while it has a port open: a turn of the link takes a few seconds, and a file is written."""


class Beats:
    """turned: for each turn of the link. hearing: for what is heard. whole, measuring: for the worker."""

    def __init__(self, heart: Heart) -> None:
        self._heart = heart

    def turned(self) -> None:
        self._heart.within(LINK_WITHIN_S)

    def hearing(self, hear: Callable[[Event], None]) -> Callable[[Event], None]:
        def heard(event: Event) -> None:
            if isinstance(event, Sent):
                # Nobody is heard of until the machine must have drawn it.
                self._heart.within(LINK_WITHIN_S + event.drawn_in_s)
            hear(event)

        return heard

    def whole(self, pool: Pool, folder: Path) -> None:
        """A short drawing may be over before the pictures of its plan are made."""
        self._heart.within(LINK_WITHIN_S + pool.settings.planning.time_limit_s)
        pool.await_pictures(folder)
        self.turned()

    def measuring(self, pool: Pool, folder: Path, machine: str) -> None:
        # The worker may be planning another picture first, and measuring what every other machine has drawn.
        first = 1 + len(pool.settings.machines)
        self._heart.within(LINK_WITHIN_S + first * pool.settings.planning.time_limit_s)
        pool.measure(folder, machine)
        self.turned()
