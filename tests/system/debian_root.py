"""A small Debian of its own, with systemd as its first process where a container can boot, else in a chroot."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Protocol

PROJECT = Path(__file__).parents[2]
CACHE = PROJECT / ".debian"
PYTHONS = {"bookworm": "3.11", "trixie": "3.13"}
UNIT = "linedrawd.service"
_BOOT_WITHIN_S, _OFF_WITHIN_S = 60.0, 30.0
COMMAND_WITHIN_S = 600.0
_PATH = "/usr/sbin:/usr/bin:/sbin:/bin"
ENVIRONMENT = {"PATH": _PATH, "LC_ALL": "C.UTF-8"}
_NEEDED = {"mmdebstrap": "mmdebstrap", "systemd-nspawn": "systemd-container", "dpkg-deb": "dpkg"}


class Machine(Protocol):
    """What the steps want of a Debian. root: its files, seen from outside. way: how it runs, in words."""

    root: Path
    way: str
    boots: bool

    def run(self, *command: str, check: bool = True) -> str: ...
    def start(self) -> subprocess.Popen[bytes]: ...
    def ready_s(self) -> float: ...
    def main_pid(self) -> int: ...
    def stop(self) -> None: ...


def host_suite() -> str:
    """The Debian of this computer where the package is made for it, else Debian 12."""
    said = dict(re.findall(r'^(\w+)="?([^"\n]*)', Path("/etc/os-release").read_text(), re.MULTILINE))
    return said["VERSION_CODENAME"] if said.get("VERSION_CODENAME") in PYTHONS else "bookworm"


def sources(suite: str) -> list[str]:
    """Where apt of this computer finds the suite; empty where it uses another, which leaves mmdebstrap its own."""
    said = subprocess.run(
        ["apt-get", "indextargets", "--format", "deb $(REPO_URI) $(CODENAME) $(COMPONENT)", "Identifier: Packages",
         "Origin: Debian", f"Codename: {suite}"], capture_output=True, text=True, check=False,
    )  # fmt: skip
    return sorted({line for line in said.stdout.splitlines() if line.split()[2] == suite})


def archive(suite: str, arch: str, more: tuple[str, ...] = ()) -> Path:
    """The empty Debian with what the package depends on, made once, in the folder .debian."""
    for program, package in _NEEDED.items():
        assert shutil.which(program), f"{program} is not installed: apt-get install {package}"
    control = (PROJECT / "systemd/debian/control").read_text(encoding="utf-8")
    depends = re.findall(r"^Depends: (.*)$", control, re.MULTILINE)[0].split(", ")
    wanted = sorted({*(name.split()[0] for name in depends), *more})
    mark = hashlib.sha256(" ".join(wanted).encode()).hexdigest()[:8]
    made = CACHE / f"{suite}-{arch}-{mark}.tar"
    if not made.exists():
        CACHE.mkdir(exist_ok=True)
        part = made.with_name("part-" + made.name)
        subprocess.run(
            ["mmdebstrap", "--quiet", "--variant=apt", f"--architectures={arch}", f"--include={','.join(wanted)}",
             suite, part, *sources(suite)], check=True, timeout=1800, stdin=subprocess.DEVNULL,
        )  # fmt: skip
        part.rename(made)
    return made


def arch_of(deb: Path) -> str:
    """What a package is made for."""
    said = subprocess.run(["dpkg-deb", "-f", deb, "Architecture"], capture_output=True, text=True, check=True)
    return said.stdout.strip()


@contextmanager
def machine(tar: Path, folder: Path, *, boot: bool = True) -> Iterator[Machine]:
    """A Debian out of its archive, running; nothing is left of it."""
    root = folder / "root"
    root.mkdir()
    subprocess.run(["tar", "-xf", tar, "-C", root], check=True)
    with ExitStack() as stack:
        booted = stack.enter_context(_booted(root, folder)) if boot else None
        yield booted or stack.enter_context(_chrooted(root))
    shutil.rmtree(root)


@contextmanager
def _booted(root: Path, folder: Path) -> Iterator[Machine | None]:
    """None where it does not boot: what a container may do depends on the computer around it."""
    command = [
        "systemd-nspawn", f"--directory={root}", f"--machine=linedrawd-{os.getpid()}", "--boot", "--register=no",
        "--keep-unit", "--private-network", "--console=pipe",
    ]  # fmt: skip
    with (folder / "console.log").open("wb") as console:
        outer = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=console, stderr=console)
    booted = Booted(root, outer.pid)
    try:
        runs = booted.is_running(outer)
        if not runs:
            booted.end(outer)
        yield booted if runs else None
    finally:
        booted.end(outer)


class Booted:
    way, boots = "systemd-nspawn --boot, systemd is its first process", True

    def __init__(self, root: Path, outer: int) -> None:
        self.root, self._outer = root, outer

    def is_running(self, outer: subprocess.Popen[bytes]) -> bool:
        until_s = time.monotonic() + _BOOT_WITHIN_S
        while outer.poll() is None and time.monotonic() < until_s:
            if self._leader() and self.run("systemctl", "is-system-running", check=False).strip() in (
                "running",
                "degraded",
            ):
                return True
            time.sleep(0.2)
        return False

    def end(self, outer: subprocess.Popen[bytes]) -> None:
        """Switch it off, and end it where it does not go."""
        if outer.poll() is None and self._leader():
            self.run("systemctl", "poweroff", check=False)
        try:
            outer.wait(_OFF_WITHIN_S if self._leader() else 0)
        except subprocess.TimeoutExpired:
            outer.kill()
            outer.wait()

    def run(self, *command: str, check: bool = True) -> str:
        return said([*self._inside(), *command], check=check)

    def start(self) -> subprocess.Popen[bytes]:
        return subprocess.Popen([*self._inside(), "systemctl", "start", UNIT], stdin=subprocess.DEVNULL)

    def ready_s(self) -> float:
        """From systemd's beginning of the start to READY, by its own clock."""
        keys = ("InactiveExitTimestampMonotonic", "ActiveEnterTimestampMonotonic")
        began_us, ready_us = (int(self._shown(key)) for key in keys)
        return (ready_us - began_us) / 1e6

    def main_pid(self) -> int:
        return int(self._shown("MainPID"))

    def stop(self) -> None:
        self.run("systemctl", "stop", UNIT)
        assert (self._shown("ActiveState"), self._shown("Result")) == ("inactive", "success")

    def _shown(self, key: str) -> str:
        return self.run("systemctl", "show", "--value", f"--property={key}", UNIT).strip()

    def _leader(self) -> str:
        children = Path(f"/proc/{self._outer}/task/{self._outer}/children")
        return (children.read_text().split() or [""])[0] if children.exists() else ""

    def _inside(self) -> list[str]:
        enter = ["nsenter", "--target", self._leader(), "-m", "-u", "-i", "-n", "-p", "-C"]
        return [*enter, "env", "-i", f"PATH={_PATH}", "LC_ALL=C.UTF-8", "DEBIAN_FRONTEND=noninteractive"]


@contextmanager
def _chrooted(root: Path) -> Iterator[Machine]:
    subprocess.run(["mount", "-t", "proc", "proc", root / "proc"], check=True)
    chrooted = Chrooted(root)
    try:
        yield chrooted
    finally:
        chrooted.stop()
        subprocess.run(["umount", root / "proc"], check=True)


class Chrooted:
    """The unit's program with the unit's user and folders; what else the unit says is not tried."""

    way, boots = "chroot, the unit's ExecStart alone: no container boots here", False

    def __init__(self, root: Path) -> None:
        self.root = root
        self._process: subprocess.Popen[bytes] | None = None
        self._began_s = self._ready_s = 0.0

    def run(self, *command: str, check: bool = True) -> str:
        return said(["chroot", str(self.root), *command], check=check, env=ENVIRONMENT)

    def start(self) -> subprocess.Popen[bytes]:
        places = {"STATE": "/var/lib/linedrawd", "LOGS": "/var/log/linedrawd", "RUNTIME": "/run/linedrawd"}
        for place in places.values():
            self.run("install", "-d", "-m", "750", "-o", "linedrawd", "-g", "linedrawd", place)
        unit = (self.root / "usr/lib/systemd/system" / UNIT).read_text()
        program = re.findall(r"^ExecStart=(.*)$", unit, re.MULTILINE)[0].split()
        environment = {f"{name}_DIRECTORY": place for name, place in places.items()} | {"PATH": _PATH}
        self._began_s = time.monotonic()
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as way:
            way.bind(str(self.root / "run/notify"))
            (self.root / "run/notify").chmod(0o666)
            way.settimeout(_BOOT_WITHIN_S)
            self._process = subprocess.Popen(
                ["chroot", self.root, "setpriv", "--reuid=linedrawd", "--regid=linedrawd", "--init-groups", *program],
                env=environment | {"NOTIFY_SOCKET": "/run/notify"}, stdin=subprocess.DEVNULL,
            )  # fmt: skip
            while "READY=1" not in way.recv(4096).decode():
                pass
            self._ready_s = time.monotonic() - self._began_s
        return subprocess.Popen(["true"])

    def ready_s(self) -> float:
        return self._ready_s

    def main_pid(self) -> int:
        return self._process.pid if self._process else 0

    def stop(self) -> None:
        if self._process:
            self._process.terminate()
            assert self._process.wait(30) == 0
            self._process = None


def said(
    command: list[str], *, check: bool = True, env: Mapping[str, str] | None = None, within_s: float = COMMAND_WITHIN_S
) -> str:
    """What the command prints. Raises AssertionError where it fails and that is to be checked."""
    done = subprocess.run(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
        timeout=within_s, env=env,
    )  # fmt: skip
    assert not check or done.returncode == 0, f"{' '.join(command)} ended with {done.returncode}: {done.stdout}"
    return done.stdout
