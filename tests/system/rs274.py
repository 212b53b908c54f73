"""LinuxCNC's own reader of G-code, unpacked from its Debian package without the desktop that the package asks for."""

from __future__ import annotations

import os
import re
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeAlias

PACKAGE = "linuxcnc-uspace"
_NEEDED = re.compile(r"Depends: (libboost-python[\d.]+|libpython3\.\d+|libedit2|libtirpc3\S*)$", re.MULTILINE)
_READER = ("./usr/bin/rs274", "./usr/lib/lib*.so*")
_MOVE = re.compile(r"STRAIGHT_(TRAVERSE|FEED)\((-?[\d.]+), (-?[\d.]+), (-?[\d.]+),")
_ARC = re.compile(r"ARC_FEED\((-?[\d.]+), (-?[\d.]+), (-?[\d.]+), (-?[\d.]+), (-?\d+), (-?[\d.]+),")
_VARIABLES = (*range(5161, 5170), *range(5181, 5190), *range(5211, 5220), 5220, *range(5221, 5231))

Kind: TypeAlias = Literal["TRAVERSE", "FEED"]


@dataclass(frozen=True, slots=True)
class Canonical:
    """One canonical move: where it ends, in mm, and for an arc about which centre it turns, turns > 0 to the left."""

    kind: Kind
    x: float
    y: float
    z: float
    centre: tuple[float, float] | None = None
    turns: int = 0


class Rs274:
    """`rs274 -g`: reads a program and prints what a machine would do, or a complaint."""

    def __init__(self, folder: Path) -> None:
        """Download and unpack the package into an empty folder; needs apt's lists. Raises RuntimeError without them."""
        self._root, self._work = folder / "root", folder / "work"
        self._work.mkdir()
        _unpack(folder, self._root)
        rows = {number: 1 if number == 5220 else 0 for number in _VARIABLES}
        (self._work / "vars.var").write_text("".join(f"{number}\t{value}\n" for number, value in sorted(rows.items())))
        (self._work / "tool.tbl").write_text("")

    def read(self, text: str) -> list[Canonical]:
        """The moves of a program. Raises AssertionError with LinuxCNC's words when it complains."""
        return list(_moves(self.said(text)))

    def said(self, text: str) -> str:
        """All canonical calls of a program, as they are printed. Raises AssertionError when it complains."""
        program = self._work / "program.ngc"
        program.write_text(text)
        command = [self._root / "usr/bin/rs274", "-g", "-t", "tool.tbl", "-v", "vars.var", program.name]
        libraries = ":".join(map(str, _libraries(self._root)))
        environment = {**os.environ, "LD_LIBRARY_PATH": libraries, "PYTHONHOME": str(self._root / "usr")}
        done = subprocess.run(
            command, cwd=self._work, env=environment, capture_output=True, text=True, check=False, timeout=60
        )
        assert done.returncode == 0, f"rs274 complains: {done.stdout[-500:]} {done.stderr[-500:]}"
        return done.stdout


def _moves(said: str) -> Iterator[Canonical]:
    for line in said.splitlines():
        if (straight := _MOVE.search(line)) is not None:
            kind, *end = straight.groups()
            yield Canonical("FEED" if kind == "FEED" else "TRAVERSE", *map(float, end))
        elif (arc := _ARC.search(line)) is not None:
            x, y, centre_x, centre_y, turns, z = map(float, arc.groups())
            yield Canonical("FEED", x, y, z, (centre_x, centre_y), int(turns))


def _unpack(folder: Path, root: Path) -> None:
    depends = subprocess.run(["apt-cache", "depends", PACKAGE], capture_output=True, text=True, check=False).stdout
    needed = _NEEDED.findall(depends)
    python = [f"{name}-{part}" for name in needed if name.startswith("libpython") for part in ("minimal", "stdlib")]
    if not needed:
        raise RuntimeError(f"apt knows no package {PACKAGE}: run apt-get update, on Debian 12 or newer or on Ubuntu")
    subprocess.run(["apt-get", "-qq", "download", PACKAGE, *needed, *python], cwd=folder, check=True, timeout=300)
    root.mkdir()
    for package in sorted(folder.glob("*.deb")):
        # Of LinuxCNC itself the reader and its libraries are enough; the rest is a desktop.
        only = _READER if package.name.startswith(PACKAGE) else ()
        unpacked = subprocess.run(["dpkg-deb", "--fsys-tarfile", package], stdout=subprocess.PIPE, check=True).stdout
        subprocess.run(["tar", "--extract", "--directory", root, "--wildcards", *only], input=unpacked, check=True)


def _libraries(root: Path) -> list[Path]:
    return [root / "usr/lib", *(root / "usr/lib").glob("*-linux-gnu*"), *(root / "lib").glob("*-linux-gnu*")]
