"""What docs/security.md claims: the daemon opens no network, gives orders to its group only, and starts nothing."""

from __future__ import annotations

import ast
import os
import re
import socket
import stat
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "security.md").read_text(encoding="utf-8")
UNIT = (ROOT / "systemd" / "linedrawd.service").read_text(encoding="utf-8")
PICTURE = ROOT / "tests" / "drawings" / "star.png"
NOBODY = 65534
SOURCES = sorted(path for folder in ("daemon", "firmware_protocol") for path in (ROOT / folder).rglob("*.py"))


@contextmanager
def drawn(state_dir: Path) -> Iterator[int]:
    """The daemon after it has drawn a picture with its real network, its worker still there; its process id."""
    (state_dir / "inbox").mkdir(parents=True)
    (state_dir / "inbox" / PICTURE.name).write_bytes(PICTURE.read_bytes())
    command = [sys.executable, "-m", "daemon.cli", "--device", "sim", "-v", "--state-dir", str(state_dir)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, cwd=ROOT, umask=0o027) as process:
        assert process.stderr is not None
        try:
            assert "state=done" in next(line for line in process.stderr if "state=done" in line or " ERROR " in line)
            yield process.pid
        finally:
            process.terminate()
            process.stderr.read()


def family(pid: int) -> list[int]:
    """The process and all that it started."""
    found = [pid]
    for task in Path(f"/proc/{pid}/task").iterdir():
        found += [each for child in (task / "children").read_text().split() for each in family(int(child))]
    return found


def sockets(pid: int) -> set[str]:
    """By inode."""
    found: set[str] = set()
    for link in Path(f"/proc/{pid}/fd").iterdir():
        # The one that this very look was made through has gone again.
        with suppress(FileNotFoundError):
            found |= set(re.findall(r"^socket:\[(\d+)\]$", os.readlink(link)))
    return found


def of_the_network() -> set[str]:
    """The inodes of all sockets of this computer that lead to a network."""
    found: set[str] = set()
    for name in ("tcp", "tcp6", "udp", "udp6", "udplite", "udplite6", "raw", "raw6", "icmp", "icmp6", "packet"):
        table, column = Path(f"/proc/net/{name}"), 8 if name == "packet" else 9
        rows = [line.split() for line in table.read_text().splitlines()[1:]] if table.exists() else []
        found |= {row[column] for row in rows if len(row) > column}
    return found


def test_a_socket_of_the_network_is_known_by_its_inode() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as server:
        server.bind(("127.0.0.1", 0))
        server.listen()
        assert sockets(os.getpid()) & of_the_network()


def test_neither_the_daemon_nor_its_worker_has_a_socket_of_the_network(tmp_path: Path) -> None:
    with drawn(tmp_path / "state") as pid:
        processes = family(pid)
        assert len(processes) >= 2, "the worker is not there to be looked at"
        assert any(sockets(each) for each in processes), "no socket at all was seen, not even that of orders"
        assert not set().union(*map(sockets, processes)) & of_the_network()


@pytest.fixture
def open_folder() -> Iterator[Path]:
    """One that everybody may go through, which the folders of tests are not."""
    with tempfile.TemporaryDirectory() as name:
        Path(name).chmod(0o755)
        yield Path(name)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can ask as another user")
def test_the_socket_of_orders_is_open_to_owner_and_group_alone(open_folder: Path) -> None:
    with drawn(open_folder / "state"):
        path = open_folder / "state" / "run" / "control.sock"
        status = path.stat()
        assert (stat.S_IMODE(status.st_mode), status.st_gid) == (0o660, os.getegid())
        assert not may_ask(path, group=NOBODY), "the folders above it are closed, too"
        for folder in (path.parent, path.parent.parent):
            folder.chmod(0o755)
        assert may_ask(path, group=status.st_gid)
        assert not may_ask(path, group=NOBODY)


def may_ask(path: Path, *, group: int) -> bool:
    """Whether a user who is nobody, of this group alone, reaches the socket."""
    child = os.fork()
    if child == 0:
        code = 1
        try:
            os.setgroups([])
            os.setgid(group)
            os.setuid(NOBODY)
            with socket.socket(socket.AF_UNIX) as connection:
                connection.connect(str(path))
            code = 0
        finally:
            os._exit(code)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def imports(path: Path) -> set[str]:
    """The modules that a source asks for, by their full names."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {name.name for name in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module, *(f"{node.module}.{name.name}" for name in node.names)}
    return found


def users_of(*modules: str) -> set[str]:
    """The sources that ask for one of these modules."""
    return {
        str(path.relative_to(ROOT))
        for path in SOURCES
        if any(name == module or name.startswith(f"{module}.") for name in imports(path) for module in modules)
    }


def test_only_these_files_speak_through_sockets() -> None:
    assert users_of("socket", "socketserver", "asyncio", "ssl") == {
        "daemon/control.py",  # orders, AF_UNIX
        "daemon/machine/serial_port.py",  # a machine at tcp://, where the settings name one
        "daemon/machine/simulator_control.py",  # what happens to a simulated machine, AF_UNIX
        "daemon/notify.py",  # systemd, AF_UNIX
    }
    assert users_of("http", "urllib.request", "urllib3", "requests", "ftplib", "smtplib", "xmlrpc") == set()


def test_only_the_scanner_the_worker_and_the_counter_are_started() -> None:
    assert users_of("subprocess", "multiprocessing", "pty.spawn") == {
        "daemon/intake/pages.py",
        "daemon/intake/scanimage.py",
        "daemon/jobs/pool.py",
    }


def calls(path: Path) -> Iterator[ast.Call]:
    return (node for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if isinstance(node, ast.Call))


def test_nothing_that_comes_in_is_ever_run() -> None:
    """No eval, no pickle, no shell: a picture and its side file are only read."""
    assert users_of("pickle", "marshal", "shelve", "runpy", "ctypes.util", "yaml") == set()
    for path in SOURCES:
        for call in calls(path):
            name = ast.unparse(call.func)
            assert name not in {"eval", "exec", "compile", "os.system", "os.popen", "__import__"}, path
            assert all(word.arg != "shell" for word in call.keywords), path
    loads = {ast.unparse(call) for path in SOURCES for call in calls(path) if ast.unparse(call.func) == "np.load"}
    assert all("allow_pickle" not in call for call in loads)


def test_every_proof_that_the_page_names_is_there() -> None:
    named = re.findall(r"`(tests/[\w/]+\.py)(?:::(\w+))?`", PAGE)
    assert len(named) >= 10
    for file, test in named:
        text = (ROOT / file).read_text(encoding="utf-8")
        assert not test or f"def {test}(" in text, f"{file}::{test}"


def test_every_line_of_the_unit_that_the_page_names_is_in_it() -> None:
    lines = re.findall(r"`([A-Z]\w+=[^`]*)`", PAGE)
    assert len(lines) >= 10
    for line in lines:
        assert re.search(rf"^{re.escape(line)}$", UNIT, re.MULTILINE), line
