"""`make arm64-check`: the arm64 package in an emulated Debian draws what it draws on this computer.

Needs root, mmdebstrap, arch-test and qemu-user-static; takes half an hour. Times say nothing about a board.
"""

from __future__ import annotations

import difflib
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.daemon.intake.vector.pdfs import pdf
from tests.system.debian_root import PROJECT, archive

SUITE = "bookworm"
PICTURE = PROJECT / "tests/drawings/star.png"
OFF_AT_MOST_MM = 0.02
"""So far a point of the program may lie from where this computer puts it: the daemon's own smallest move."""
_QEMU = Path("/usr/bin/qemu-aarch64-static")
_BINFMT = Path("/proc/sys/fs/binfmt_misc")
_MAGIC = (
    r":qemu-aarch64:M::\x7fELF\x02\x01\x01\x00\x00\x00\x00\x00\x00\x00\x00\x00\x02\x00\xb7\x00:"
    r"\xff\xff\xff\xff\xff\xff\xff\x00\xff\xff\xff\xff\xff\xff\xff\xff\xfe\xff\xff\xff:" + f"{_QEMU}:OCF"
)
# qemu 7.2 passes this computer's /proc/cpuinfo through, on which onnxruntime crashes when it takes it for an Arm's.
_CPU = (
    "processor\t: {number}\nBogoMIPS\t: 108.00\nFeatures\t: fp asimd evtstrm crc32 cpuid\n"
    "CPU implementer\t: 0x41\nCPU architecture: 8\nCPU variant\t: 0x0\nCPU part\t: 0xd08\nCPU revision\t: 3\n\n"
)
_STEP_WITHIN_S = 1500


def check(deb: Path) -> None:
    """Print each step. Raises AssertionError where the board would draw anything else than this computer."""
    emulate()
    with tempfile.TemporaryDirectory() as folder, arm_root(archive(SUITE, "arm64"), Path(folder)) as root:
        shutil.copy(deb, root / "root")
        shutil.copy(PICTURE, root / "tmp/star.png")
        step(root, "dpkg", "-i", f"/root/{deb.name}")
        settings = root / "etc/linedrawd/linedrawd.toml"
        settings.write_text(settings.read_text().replace("#time_limit_s = 300.0", f"time_limit_s = {_STEP_WITHIN_S}"))
        size = sum(path.lstat().st_size for path in (root / "opt/linedrawd").rglob("*") if not path.is_dir())
        print(f"/opt/linedrawd: {size / 1e6:.0f} MB", flush=True)
        step(root, "linedrawd", "plan", "/tmp/star.png", "-o", "/tmp/plans")
        emulated = (root / "tmp/plans/star/program.gcode").read_text()
        compare(native(Path(folder)), emulated)
        (root / "tmp/page.pdf").write_bytes(pdf(["9 9 m 60 9 l 60 99 l S"]))
        step(root, "linedrawd", "plan", "/tmp/page.pdf", "-o", "/tmp/plans")
        assert "G1 " in (root / "tmp/plans/page/program.gcode").read_text()
        drawn = step(root, "linedrawd", "draw", "/tmp/star.png", "--device", "sim", "--state-dir", "/tmp/state", "-v")
        assert "state=done" in drawn
    print("the arm64 package installs, plans a picture and a PDF, and draws", flush=True)


def native(folder: Path) -> str:
    """The program that this computer plans."""
    command = [sys.executable, "-m", "daemon.cli", "plan", str(PICTURE), "-o", str(folder / "plans")]
    subprocess.run(command, check=True, cwd=PROJECT)
    return (folder / "plans/star/program.gcode").read_text()


def compare(here: str, emulated: str) -> None:
    """The same program, or one that differs in its last digits alone."""
    if here == emulated:
        print("the program is the same, byte for byte", flush=True)
        return
    print("".join(difflib.unified_diff(here.splitlines(True), emulated.splitlines(True), "here", "arm64", n=0)))
    number = re.compile(r"(?<=[XYZIJF])-?[\d.]+")
    assert number.sub("", here) == number.sub("", emulated), "the programs differ in more than their numbers"
    pairs = zip(number.findall(here), number.findall(emulated), strict=True)
    off_mm = max(abs(float(one) - float(other)) for one, other in pairs)
    assert off_mm <= OFF_AT_MOST_MM, f"a number differs by {off_mm:g}"
    print(f"the programs differ by {off_mm:g} mm at most (bar {OFF_AT_MOST_MM})", flush=True)


def emulate() -> None:
    """Have the kernel start programs for Arm by qemu."""
    assert _QEMU.exists(), "qemu is not installed: apt-get install qemu-user-static arch-test mmdebstrap"
    if not (_BINFMT / "register").exists():
        subprocess.run(["mount", "-t", "binfmt_misc", "binfmt_misc", _BINFMT], check=True)
    if not (_BINFMT / "qemu-aarch64").exists():
        (_BINFMT / "register").write_text(_MAGIC)


@contextmanager
def arm_root(tar: Path, folder: Path) -> Iterator[Path]:
    root, cpus = folder / "root", folder / "cpuinfo"
    root.mkdir()
    cpus.write_text("".join(_CPU.format(number=number) for number in range(2)))
    subprocess.run(["tar", "-xf", tar, "-C", root], check=True)
    subprocess.run(["mount", "-t", "proc", "proc", root / "proc"], check=True)
    try:
        subprocess.run(["mount", "--bind", cpus, root / "proc/cpuinfo"], check=True)
        yield root
    finally:
        subprocess.run(["umount", "--recursive", root / "proc"], check=True)


def step(root: Path, *command: str) -> str:
    """Run in the emulated root; a thread that crashes can leave the rest hanging, hence the harder end."""
    began_s = time.monotonic()
    environment = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "LC_ALL": "C.UTF-8", "HOME": "/root"}
    done = subprocess.run(
        ["timeout", "--kill-after=2", str(_STEP_WITHIN_S), "chroot", root, *command], env=environment,
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
    )  # fmt: skip
    print(f"{' '.join(command)}: {time.monotonic() - began_s:.0f} s, emulated", flush=True)
    assert done.returncode == 0, f"it ended with {done.returncode}: {done.stdout[-2000:]}"
    return done.stdout


if __name__ == "__main__":
    check(Path(sys.argv[1]))
