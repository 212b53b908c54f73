"""What is built into onnxruntime to report home is silent: no socket to a network, no file in the user's folders.

Needs the package strace; without it these tests fail.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.system.debian_root import PROJECT

pytestmark = pytest.mark.system

PICTURE = PROJECT / "tests/drawings/star.png"
_SOCKET = re.compile(r"\bsocket\((AF_\w+)")
_MADE = re.compile(r'\b(?:open|openat|creat|mkdir|mkdirat|unlink|rename)\([^"\n]*"([^"]+)"[^\n]*')


def traced(folder: Path, *command: str | Path) -> tuple[set[str], set[str]]:
    """The families of sockets that a command and all its children ask for, and the files that they make.

    It runs without a network, with an empty folder as its home.
    """
    assert shutil.which("strace"), "strace is not installed: apt-get install strace"
    (folder / "home").mkdir()
    trace = folder / "trace"
    strace = [
        "strace",
        "-f",
        "-qq",
        "-s",
        "4096",
        "-o",
        trace,
        "-e",
        "trace=socket,connect,openat,open,creat,mkdir,mkdirat",
    ]
    environment = {"HOME": str(folder / "home"), "PATH": "/usr/bin:/bin", "PYTHONDONTWRITEBYTECODE": "1"}
    subprocess.run(
        ["unshare", "--net", *strace, *command], check=True, env=environment, cwd=PROJECT, timeout=300,
        stdout=subprocess.DEVNULL,
    )  # fmt: skip
    said = trace.read_text(encoding="utf-8", errors="replace")
    made = {line[1] for line in _MADE.finditer(said) if "O_CREAT" in line[0] or "mkdir" in line[0]}
    return set(_SOCKET.findall(said)), made


def test_planning_a_picture_opens_no_network_and_makes_no_file_but_its_own(tmp_path: Path) -> None:
    plan = ("-m", "daemon.cli", "plan", PICTURE, "-o", tmp_path / "plans")
    families, made = traced(tmp_path, sys.executable, *plan)
    assert families <= {"AF_UNIX", "AF_NETLINK"}
    assert any("preview.png" in path for path in made), "the worker was not traced"
    others = [path for path in made if not path.startswith((f"{tmp_path}/plans", "/dev/shm/", "/tmp/linedrawd"))]
    assert others == []
    assert list((tmp_path / "home").rglob("*")) == []


def test_the_worker_alone_is_silent_too(tmp_path: Path) -> None:
    families, made = traced(tmp_path, sys.executable, "-c", "import daemon.vision.segmenter")
    assert families <= {"AF_UNIX", "AF_NETLINK"}
    assert made == set()


def test_what_is_not_told_to_be_silent_is_noticed(tmp_path: Path) -> None:
    """Otherwise the tests above would say nothing."""
    _, made = traced(tmp_path, sys.executable, "-c", "import onnxruntime")
    assert any(str(tmp_path / "home") in path for path in made)
