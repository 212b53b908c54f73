"""Debian 12 with the package becomes Debian 13: the environment is made again for its Python, and draws.

`python -m tests.system.next_debian FILE.deb` needs root, mmdebstrap and Debian's archive; takes a quarter of an hour.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.system.debian_root import archive, machine, sources
from tests.system.package import BOOT_PACKAGES, PICTURE

_OLD, _NEW = "bookworm", "trixie"
_KEEP = ("-o", "Dpkg::Options::=--force-confold", "-o", "APT::Sandbox::User=root")


def upgrade(deb: Path, folder: Path) -> None:
    """Print each step. Raises AssertionError where it does not draw afterwards as it drew before."""
    with machine(archive(_OLD, _arch(deb), BOOT_PACKAGES), folder, boot=False) as debian:
        root = debian.root
        shutil.copy(deb, root / "root")
        shutil.copy(PICTURE, root / "root/house.png")
        shutil.copy("/etc/resolv.conf", root / "etc/resolv.conf")
        debian.run("dpkg", "-i", f"/root/{deb.name}")
        before = _drawn(root, "before")
        print(f"{_OLD}: {_made(root)}", flush=True)
        lines = sources(_NEW) or [f"deb http://deb.debian.org/debian {_NEW} main"]
        (root / "etc/apt/sources.list").write_text("".join(f"{line}\n" for line in lines))
        for words in (("update",), ("--yes", "dist-upgrade"), ("--yes", "autoremove")):
            said = _apt(root, *words)
            print("".join(f"    {line}\n" for line in said.splitlines() if "linedrawd" in line), end="", flush=True)
        print(f"{_NEW}: {_made(root)}", flush=True)
        assert _made(root).endswith("python3.13")
        assert not (root / "usr/bin/python3.11").exists()
        assert _drawn(root, "after") == before
    print("after the upgrade and without the old Python it plans the same program, and draws it", flush=True)


def _drawn(root: Path, name: str) -> str:
    """The program of the picture, which is drawn on the simulated plotter as well."""
    _inside(root, "linedrawd", "plan", "/root/house.png", "-o", f"/tmp/{name}")
    _inside(root, "linedrawd", "draw", "/root/house.png", "--device", "sim", "--state-dir", f"/tmp/state-{name}")
    return (root / f"tmp/{name}/house/program.gcode").read_text()


def _made(root: Path) -> str:
    return (root / "opt/linedrawd/made").read_text().strip()


def _apt(root: Path, *words: str) -> str:
    return _inside(root, "apt-get", "-qq", *_KEEP, *words)


def _inside(root: Path, *command: str) -> str:
    environment = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "LC_ALL": "C.UTF-8", "DEBIAN_FRONTEND": "noninteractive"}
    proxies = {name: value for name, value in os.environ.items() if name.lower().endswith("_proxy")}
    done = subprocess.run(
        ["chroot", root, *command], env=environment | proxies, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT, text=True, check=False, timeout=3600,
    )  # fmt: skip
    assert done.returncode == 0, f"{' '.join(command)} ended with {done.returncode}: {done.stdout[-3000:]}"
    return done.stdout


def _arch(deb: Path) -> str:
    said = subprocess.run(["dpkg-deb", "-f", deb, "Architecture"], capture_output=True, text=True, check=True)
    return said.stdout.strip()


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as temporary:
        upgrade(Path(sys.argv[1]), Path(temporary))
