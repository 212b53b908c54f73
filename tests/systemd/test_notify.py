"""What is sent is what sd_notify(3) asks for, and a manager that does not hear stops nothing."""

from __future__ import annotations

import os
import socket
from pathlib import Path

import pytest

from daemon.notify import Notifier, notifier_of
from tests.systemd.manager import manager


@pytest.mark.parametrize("abstract", [False, True])
def test_each_message_is_a_datagram_of_its_own(tmp_path: Path, abstract: bool) -> None:
    address = f"@linedrawd-test-{os.getpid()}" if abstract else str(tmp_path / "notify")
    with manager(address) as systemd:
        notifier = Notifier(address, monotonic_ns=lambda: 1_234_567_890)
        notifier.ready()
        notifier.alive()
        notifier.reloading()
        notifier.stopping()
        heard = [systemd.next() for _ in range(4)]
    assert heard == ["READY=1", "WATCHDOG=1", "RELOADING=1\nMONOTONIC_USEC=1234567", "STOPPING=1"]


def test_a_status_is_one_line_and_is_sent_when_it_has_changed(tmp_path: Path) -> None:
    with manager(str(tmp_path / "notify")) as systemd:
        notifier = Notifier(systemd.address)
        for words in ("drawing Käfer\nREADY=1", "drawing Käfer\nREADY=1", "idle"):
            notifier.status(words)
        assert [systemd.next(), systemd.next()] == ["STATUS=drawing Käfer READY=1", "STATUS=idle"]
        assert systemd.nothing()


def test_without_a_manager_nothing_happens(tmp_path: Path) -> None:
    for notifier in (Notifier(), Notifier(str(tmp_path / "gone")), Notifier("/" + "x" * 200), notifier_of({})):
        notifier.ready()
        notifier.status("idle")
    assert not notifier_of({}).listened_to
    assert notifier_of({"WATCHDOG_USEC": "30000000"}).watchdog_s is None


def test_a_manager_that_hears_nothing_any_more_keeps_nobody_waiting(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    limits: list[float | None] = []

    class Full(socket.socket):
        def settimeout(self, seconds: float | None, /) -> None:
            limits.append(seconds)
            super().settimeout(0.0)

    with manager(str(tmp_path / "notify")) as systemd:
        monkeypatch.setattr(socket, "socket", Full)
        for _ in range(2000):
            Notifier(systemd.address).alive()
    assert set(limits) == {1.0}


@pytest.mark.parametrize(
    ("environment", "watchdog_s"),
    [
        ({"WATCHDOG_USEC": "30000000"}, 30.0),
        ({"WATCHDOG_USEC": "30000000", "WATCHDOG_PID": "7"}, 30.0),
        ({"WATCHDOG_USEC": "30000000", "WATCHDOG_PID": "8"}, None),
        ({"WATCHDOG_USEC": "0"}, None),
        ({"WATCHDOG_USEC": "soon"}, None),
        ({}, None),
    ],
)
def test_the_watchdog_is_fed_where_it_watches_this_process(
    environment: dict[str, str], watchdog_s: float | None
) -> None:
    assert notifier_of({"NOTIFY_SOCKET": "/run/x"} | environment, pid=7).watchdog_s == watchdog_s
