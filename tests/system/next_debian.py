"""Debian 12 with the package becomes Debian 13: the environment is made again for its Python, and draws.

`python -m tests.system.next_debian FILE.deb` needs root, mmdebstrap and Debian's archive; takes a quarter of an hour.
"""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from pathlib import Path

from tests.system.debian_root import ENVIRONMENT, arch_of, archive, machine, said
from tests.system.package import BOOT_PACKAGES, PICTURE

_OLD, _NEW = "bookworm", "trixie"
_UPGRADED_WITHIN_S = 3600.0
_KEEP = ("-o", "Dpkg::Options::=--force-confold", "-o", "APT::Sandbox::User=root")


def upgrade(deb: Path, folder: Path) -> None:
    """Print each step. Raises AssertionError where it does not draw afterwards as it drew before."""
    with machine(archive(_OLD, arch_of(deb), BOOT_PACKAGES), folder, boot=False) as debian:
        root = debian.root
        shutil.copy(deb, root / "root")
        shutil.copy(PICTURE, root / "root/house.png")
        shutil.copy("/etc/resolv.conf", root / "etc/resolv.conf")
        debian.run("dpkg", "-i", f"/root/{deb.name}")
        before = _drawn(root, "before")
        print(f"{_OLD}: {_made(root)}", flush=True)
        # The new one comes from where the old one came from.
        sources = root / "etc/apt/sources.list"
        sources.write_text(sources.read_text().replace(_OLD, _NEW))
        for words in (("update",), ("--yes", "dist-upgrade"), ("--yes", "autoremove")):
            printed = _apt(root, *words)
            print("".join(f"    {line}\n" for line in printed.splitlines() if "linedrawd" in line), end="", flush=True)
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
    proxies = {name: value for name, value in os.environ.items() if name.lower().endswith("_proxy")}
    environment = {**ENVIRONMENT, "DEBIAN_FRONTEND": "noninteractive", **proxies}
    return said(["chroot", str(root), *command], env=environment, within_s=_UPGRADED_WITHIN_S)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as temporary:
        upgrade(Path(sys.argv[1]), Path(temporary))
