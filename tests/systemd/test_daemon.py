"""The daemon itself, started as systemd starts it, tells the truth to the socket that it was given."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from daemon.control import Order, give_order
from tests.systemd.manager import Manager, manager

SETTINGS = "[sheet]\nrotate = {rotate}\n[planning]\nahead = {ahead}\n"


@contextmanager
def started(root: Path, systemd: Manager, *, watchdog_s: float = 600.0) -> Iterator[subprocess.Popen[bytes]]:
    """On a machine that is not there: that is no failure."""
    file = root / "linedrawd.toml"
    file.write_text(SETTINGS.format(rotate=0, ahead=2))
    said = ["--config", str(file), "--device", "grbl", "--port", "/dev/no-such-port", "--state-dir", str(root / "s")]
    environment = {"NOTIFY_SOCKET": systemd.address, "WATCHDOG_USEC": str(int(watchdog_s * 1e6))}
    with subprocess.Popen(
        [sys.executable, "-m", "daemon.cli", *said], env=os.environ | environment, stdin=subprocess.DEVNULL
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def test_it_is_ready_without_a_machine_rereads_its_settings_and_stops_in_order(tmp_path: Path) -> None:
    with manager(str(tmp_path / "notify")) as systemd, started(tmp_path, systemd) as process:
        before = systemd.until("READY=1")
        assert any(words.startswith("STATUS=") for words in before) or systemd.next().startswith("STATUS=")
        assert give_order(tmp_path / "s/run/control.sock", Order(order="ping")) == "linedrawd runs"
        (tmp_path / "linedrawd.toml").write_text(SETTINGS.format(rotate=90, ahead=3))
        process.send_signal(signal.SIGHUP)
        assert any(words.startswith("RELOADING=1\nMONOTONIC_USEC=") for words in systemd.until("READY=1"))
        process.send_signal(signal.SIGTERM)
        systemd.until("STOPPING=1")
        assert process.wait(30) == 0
    log = (tmp_path / "s/log/linedrawd.log").read_text()
    assert "sheet.rotate = 90 holds from the next picture that is planned on" in log
    assert "planning.ahead = 3 needs a restart: restart linedrawd" in log
    assert "order=ping" not in log


def test_the_watchdog_is_fed_while_nothing_is_drawn(tmp_path: Path) -> None:
    with manager(str(tmp_path / "notify")) as systemd, started(tmp_path, systemd, watchdog_s=0.3):
        systemd.until("READY=1")
        for _ in range(3):
            systemd.until("WATCHDOG=1")
