"""The Debian package from its installation to its purge in an empty Debian; each step is printed.

`python -m tests.system.package [--chroot] [FILE.deb]` needs root, mmdebstrap and systemd-container.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from tests.daemon.intake.vector.pdfs import pdf
from tests.system.debian_root import PROJECT, PYTHONS, Machine, arch_of, archive, host_suite, machine

READY_WITHIN_S, FIRST_LINE_WITHIN_S, EXPOSURE = 2.0, 6.0, 1.5
"""The bars of a cold start, which the figures are printed with, and of what systemd calls exposure."""
LIES_S = 21
"""So long a picture lies in the inbox before a cold start, as one does that came before the power was cut."""
PICTURE = PROJECT / "tests/drawings/house.png"
BOOT_PACKAGES = ("systemd-sysv", "dbus")
_CONFIG, _STATE, _LOG = "etc/linedrawd/linedrawd.toml", "var/lib/linedrawd", "var/log/linedrawd/linedrawd.log"
_DRAWN_WITHIN_S = 120.0
_PLOTTER = "/run/plotter/grbl"
Say = Callable[[str], None]


def build(out: Path, *, suite: str) -> Path:
    """The package for this computer and one Debian, made quickly."""
    arch = subprocess.run(["dpkg", "--print-architecture"], capture_output=True, text=True, check=True).stdout.strip()
    command = [sys.executable, PROJECT / "systemd/debian/build.py", "--quick", "--arch", arch]
    subprocess.run([*command, "--python", PYTHONS[suite], "--out", out], check=True, timeout=600)
    return next(out.glob("linedrawd_*.deb"))


def whole_life(deb: Path, suite: str, folder: Path, say: Say, *, boot: bool = True) -> None:
    """Every step, in order. Raises AssertionError where one does not do what it should."""
    began_s = time.monotonic()
    arch = arch_of(deb)
    tar = archive(suite, arch, BOOT_PACKAGES)
    say(f"an empty Debian ({suite}, {arch}) is there after {time.monotonic() - began_s:.0f} s")
    with machine(tar, folder, boot=boot) as debian:
        say(f"it runs: {debian.way}")
        life = Life(debian, deb, say)
        life.install()
        life.look_at_the_unit()
        life.start_with_a_waiting_picture()
        life.draw_another()
        life.draw_a_pdf()
        life.read_the_log()
        if debian.boots:
            life.draw_on_a_read_only_root()
            life.upgrade_between_drawings()
            life.upgrade_while_it_draws()
        life.stop()
        life.another_python()
        life.remove()
        life.purge()
    say(f"all of it took {time.monotonic() - began_s:.0f} s")


class Life:
    def __init__(self, debian: Machine, deb: Path, say: Say) -> None:
        self._debian, self._root, self._say = debian, debian.root, say
        self._deb = f"/root/{deb.name}"
        shutil.copy(deb, self._root / "root")
        shutil.copy(PICTURE, self._root / "usr/share/picture.png")
        (self._root / "usr/share/picture.png").chmod(0o644)

    def install(self) -> None:
        began_s = time.monotonic()
        self._debian.run("dpkg", "-i", self._deb)
        said = self._debian.run("linedrawd", "--version").strip()
        size = int(self._debian.run("du", "-sB1", "/opt/linedrawd").split()[0])
        self._say(f"installed in {time.monotonic() - began_s:.0f} s: {said}, {size / 1e6:.0f} MB in /opt/linedrawd")
        if self._debian.boots:
            assert self._debian.run("systemctl", "is-enabled", "linedrawd", check=False).strip() == "disabled"
            assert self._debian.main_pid() == 0
            self._say("nothing was started by that")

    def look_at_the_unit(self) -> None:
        unit = "/usr/lib/systemd/system/linedrawd.service"
        assert self._debian.run("systemd-analyze", "verify", "--man=no", unit) == ""
        security = ("systemd-analyze", "security", "--offline=true", f"--threshold={10 * EXPOSURE:.0f}", unit)
        found = re.findall(r"level for linedrawd.service: ([\d.]+)", self._debian.run(*security))
        self._say(f"the unit: systemd-analyze verify is silent, exposure {found[0]} (bar {EXPOSURE})")

    def start_with_a_waiting_picture(self) -> None:
        self._set("url", '"auto"', '"sim://grbl"')
        self._debian.run("sh", "-c", "printf 'u alice - - /tmp\\nm alice linedrawd\\n' | systemd-sysusers -")
        self._drop("waiting.png")
        self._say(f"a picture waits in the inbox for {LIES_S} s, dropped by alice of the group linedrawd")
        time.sleep(LIES_S)
        self._forget_the_disk()
        began_s = time.monotonic()
        starting = self._debian.start()
        self._wait(partial(self._job_is, "waiting.png", "queued"))
        taken_s = time.monotonic() - began_s
        self._wait(partial(self._job_is, "waiting.png", "drawing"))
        first_line_s = time.monotonic() - began_s
        assert starting.wait(60) == 0
        self._say(f"ready {self._debian.ready_s():.1f} s after a cold start (bar {READY_WITHIN_S})")
        self._say(
            f"its first line is drawn {first_line_s:.1f} s after it (bar {FIRST_LINE_WITHIN_S}): the picture had been "
            f"still for long enough after {taken_s:.1f} s, and was planned in {first_line_s - taken_s:.1f} s"
        )
        self._wait(partial(self._job_is, "waiting.png", "done"))

    def draw_another(self) -> None:
        self._drop("house.png")
        self._wait(partial(self._job_is, "house.png", "done"))
        (folder,) = (self._root / _STATE / "jobs").glob("*house*")
        report = json.loads((folder / "report.json").read_text())
        assert (folder / "preview.png").stat().st_size > 0
        assert report["fidelity"]["f1"] > 0.98
        self._say(f"alice's next picture is drawn: {report['strokes']} strokes, f1 {report['fidelity']['f1']:.3f}")

    def draw_a_pdf(self) -> None:
        """Of two pages, by PDFium inside the unit's sandbox."""
        (self._root / "usr/share/paths.pdf").write_bytes(pdf(["9 9 m 60 9 l 60 99 l S", "9 9 m 60 99 l S"]))
        self._drop("paths.pdf", "/usr/share/paths.pdf")
        for page in ('"paths.pdf page 1"', '"paths.pdf page 2"'):
            self._wait(partial(self._job_is, page, "done"))
        self._say("a PDF of two pages is drawn, each of them a job")

    def read_the_log(self) -> None:
        log = (self._root / _LOG).read_text()
        assert log.count("state=done") == 4
        assert "Traceback" not in log
        if self._debian.boots:
            self._wait(lambda: set(log.splitlines()) <= set(self._journal()))
            self._say("systemd's journal says the same, line by line")
        self._say("the log says:\n" + "".join(f"    {line}\n" for line in log.splitlines()[-4:]).rstrip())

    def draw_on_a_read_only_root(self) -> None:
        """As docs/install.md says it: state and log alone can be written, /var/tmp lies in memory."""
        self._debian.stop()
        places = (f"/{_STATE}", "/var/log")
        for place in places:
            self._debian.run("mount", "--bind", place, place)
        self._debian.run("mount", "-t", "tmpfs", "tmpfs", "/var/tmp")
        self._debian.run("systemctl", "restart", "systemd-journald")
        self._debian.run("mount", "-o", "remount,bind,ro", "/")
        assert "Read-only" in self._debian.run("touch", "/opt/linedrawd/more", check=False)
        self._debian.run("systemctl", "start", "linedrawd")
        self._drop("third.png")
        self._wait(partial(self._job_is, "third.png", "done"))
        self._debian.run("mount", "-o", "remount,bind,rw", "/")
        for place in ("/var/tmp", *places):
            self._debian.run("umount", "--lazy", place)
        self._say("with a root that is read-only it starts, and draws")

    def upgrade_between_drawings(self) -> None:
        before = self._debian.main_pid()
        self._stale()
        self._debian.run("dpkg", "-i", self._deb)
        assert self._debian.main_pid() not in (0, before)
        self._wait(self._none_is_held)
        assert 'url = "sim://grbl"' in (self._root / _CONFIG).read_text()
        self._say("an upgrade between two drawings starts it anew, and keeps the settings")

    def upgrade_while_it_draws(self) -> None:
        self._debian.run(
            "systemd-run", "--quiet", "--uid=linedrawd", "--unit=plotter", "--property=RuntimeDirectory=plotter",
            "linedrawd", "simulate", "grbl", "--pty", _PLOTTER,
        )  # fmt: skip
        self._wait(partial(self._is_there, _PLOTTER))
        self._set("url", '"sim://grbl"', f'"serial://{_PLOTTER}"')
        self._set("sheet", '"auto"', '"feed"')
        self._set("draw_mm_s", "20.0", "1.0")
        self._debian.run("systemctl", "restart", "linedrawd")
        before = self._debian.main_pid()
        self._drop("slow.png")
        self._wait(partial(self._job_is, "slow.png", "drawing"))
        self._stale()
        said = self._debian.run("dpkg", "-i", self._deb)
        assert "it goes on with the version that it runs" in said
        assert self._debian.main_pid() == before
        assert self._job_is("slow.png", "drawing")
        self._wait(self._none_is_held)
        self._say("an upgrade while it draws on a plotter in real time leaves it alone, and says so")

    def stop(self) -> None:
        began_s = time.monotonic()
        self._debian.stop()
        stopped = " in the middle of a drawing" if self._debian.boots else ""
        self._say(f"stopped{stopped} within {time.monotonic() - began_s:.1f} s")
        if self._debian.boots:
            assert self._job_is("slow.png", "interrupted")

    def another_python(self) -> None:
        """The environment is one of another Python: made again by dpkg's trigger."""
        self._stale()
        self._debian.run("dpkg-trigger", "--by-package=linedrawd", "/usr/bin/python3")
        self._debian.run("dpkg", "--triggers-only", "linedrawd")
        assert "of another" not in (self._root / "opt/linedrawd/made").read_text()
        assert not (self._root / "opt/linedrawd.new").exists()
        assert "linedrawd" in self._debian.run("linedrawd", "--version")
        self._say("another Python of the system: the environment is made again")
        self._stale()
        (self._root / "usr/lib/linedrawd/pythons").write_text("python3.0\n")
        said = self._debian.run("/usr/lib/linedrawd/environment", "start", check=False)
        assert "this version is for python3.0, and Debian's is python3." in said
        assert "linedrawd" in self._debian.run("linedrawd", "--version")
        self._say("a Python that it is not for: it says so, and leaves the environment alone")

    def remove(self) -> None:
        self._debian.run("dpkg", "--remove", "linedrawd")
        assert list((self._root / "opt").iterdir()) == []
        assert not (self._root / "usr/lib/linedrawd").exists()
        assert (self._root / _CONFIG).exists()
        assert list((self._root / _STATE / "jobs").glob("*house*"))
        self._say("removed: drawings, log and settings are still there")

    def purge(self) -> None:
        self._debian.run("dpkg", "--purge", "linedrawd")
        left = self._debian.run("find", "/", "-xdev", "-name", "*linedrawd*", "-not", "-path", "/proc/*").split()
        assert set(left) <= {self._deb, "/var/lib/systemd/catalog"}, left
        self._say("purged: nothing is left but the user")

    def _set(self, key: str, old: str, new: str) -> None:
        """Change the first place of a key in the settings."""
        file = self._root / _CONFIG
        text = re.sub(rf"^#?{key} = {re.escape(old)}$", f"{key} = {new}", file.read_text(), count=1, flags=re.MULTILINE)
        assert f"\n{key} = {new}\n" in text
        file.write_text(text)

    def _drop(self, name: str, picture: str = "/usr/share/picture.png") -> None:
        inbox = f"/{_STATE}/inbox"
        self._debian.run("setpriv", "--reuid=alice", "--regid=alice", "--init-groups", "cp", picture, f"{inbox}/{name}")

    def _job_is(self, picture: str, state: str) -> bool:
        logs = (self._root / _STATE / "jobs").glob("*/job.log")
        said = [text for text in (log.read_text() for log in logs) if f"name={picture}" in text]
        return any(f"state={state}" in text for text in said)

    def _none_is_held(self) -> bool:
        """As the status says, which is written at most once a second."""
        return "held" not in self._debian.run("linedrawd", "status")

    def _journal(self) -> list[str]:
        return self._debian.run("journalctl", "--unit=linedrawd", "--output=cat", "--no-pager").splitlines()

    def _is_there(self, path: str) -> bool:
        return bool(self._debian.run("sh", "-c", f"test -e {path} && echo yes", check=False))

    def _stale(self) -> None:
        (self._root / "opt/linedrawd/made").write_text("of another Python\n")

    def _wait(self, true: Callable[[], bool]) -> None:
        until_s = time.monotonic() + _DRAWN_WITHIN_S
        while not true():
            assert time.monotonic() < until_s, self._debian.run("linedrawd", "jobs", check=False)
            time.sleep(0.02)

    def _forget_the_disk(self) -> None:
        """Nothing of the program is in memory any more, as after the board was switched on."""
        os.sync()
        for path in [*(self._root / "opt").rglob("*"), *(self._root / "usr/lib").rglob("*")]:
            if path.is_file() and not path.is_symlink():
                with path.open("rb") as file:
                    os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("deb", nargs="?", type=Path, metavar="FILE.deb", help="made now where none is named")
    parser.add_argument("--chroot", action="store_true", help="as on a computer on which no container boots")
    parser.add_argument("--suite", choices=PYTHONS, default=host_suite(), help="which Debian")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        deb = args.deb or build(Path(folder), suite=args.suite)
        whole_life(deb, args.suite, Path(folder), partial(print, flush=True), boot=not args.chroot)


if __name__ == "__main__":
    main()
