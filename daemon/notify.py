"""What systemd is told: ready, what is done now, alive, reading the settings anew, stopping."""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Callable, Mapping
from contextlib import suppress


class Notifier:
    """Sends systemd's datagrams (sd_notify(3)). Without an address every call does nothing, and none ever raises.

    Any thread may call. What is said twice in a row as a status is sent once.
    """

    def __init__(
        self,
        address: str = "",
        *,
        watchdog_s: float | None = None,
        monotonic_ns: Callable[[], int] = lambda: time.clock_gettime_ns(time.CLOCK_MONOTONIC),
    ) -> None:
        """address: a path, or "@" and an abstract name. watchdog_s: how long systemd waits for `alive`; None: it does
        not."""
        self._address = "\0" + address[1:] if address.startswith("@") else address
        self.watchdog_s = watchdog_s if address else None
        self._monotonic_ns, self._status = monotonic_ns, ""

    @property
    def listened_to(self) -> bool:
        """Somebody wants to be told."""
        return bool(self._address)

    def ready(self) -> None:
        self._send("READY=1")

    def status(self, words: str) -> None:
        """One line for `systemctl status`."""
        line = " ".join(words.split())
        if line != self._status:
            self._status = line
            self._send(f"STATUS={line}")

    def alive(self) -> None:
        self._send("WATCHDOG=1")

    def reloading(self) -> None:
        """The settings are read; `ready` ends it."""
        # The time tells systemd 253 and later which of its requests this answers; earlier ones pass it over.
        self._send(f"RELOADING=1\nMONOTONIC_USEC={self._monotonic_ns() // 1000}")

    def stopping(self) -> None:
        self._send("STOPPING=1")

    def _send(self, message: str) -> None:
        if not self._address:
            return
        # A manager that is busy, gone or another one stops no drawing.
        with suppress(OSError), socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_CLOEXEC) as way:
            way.settimeout(1.0)
            way.connect(self._address)
            way.send(message.encode("utf-8", "replace"))


def notifier_of(environment: Mapping[str, str], *, pid: int | None = None) -> Notifier:
    """By NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID. pid: our own, for which the watchdog must be meant."""
    meant = environment.get("WATCHDOG_PID") or str(pid or os.getpid())
    period = environment.get("WATCHDOG_USEC", "")
    watches = period.isdecimal() and int(period) > 0 and meant == str(pid or os.getpid())
    return Notifier(environment.get("NOTIFY_SOCKET", ""), watchdog_s=int(period) / 1e6 if watches else None)
