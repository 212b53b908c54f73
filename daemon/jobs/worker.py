"""The worker process: plans pictures one after the other, asked and answered in JSON lines.

A request is `{"ask": "plan" | "measure", "source": PATH, "name": TEXT, "folder": PATH, "machine": NAME,
"settings": {...}}`.
Answers are `{"progress": STAGE}`, `{"planned": true}` once the program can be drawn, then `{"done": true}` or
`{"failed": ERROR, "words": SENTENCE}`.
Whatever is no LinedrawError, full disk or lack of memory ends the process with a traceback: the daemon starts another.
"""

from __future__ import annotations

import argparse
import contextlib
import ctypes
import errno
import importlib
import json
import os
import resource
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any, TextIO

from daemon.config import Settings
from daemon.errors import NO_ROOM, DiskFull, DiskTrouble, LinedrawError

_NICER = 10
_PR_SET_PDEATHSIG = 1
_DISK = NO_ROOM | {errno.EROFS, errno.EIO, errno.EACCES}


def main(arguments: list[str] | None = None) -> int:
    """Answer until stdin ends. Returns 1 after a lack of memory: what is left of this process is not worth keeping."""
    parser = argparse.ArgumentParser(
        prog="python -m daemon.jobs.worker", description="Plans pictures; asked by the daemon."
    )
    parser.add_argument("--planner", default="daemon.jobs.planner")
    parser.add_argument("--memory-mb", type=int, required=True)
    parser.add_argument("--daemon", type=int, required=True, help="the process that asks")
    options = parser.parse_args(arguments)
    os.environ["ORT_DISABLE_TELEMETRY"] = "1"
    if not _live_with_the_daemon(options.daemon):
        return 0
    answers = _own_stdout()
    resource.setrlimit(resource.RLIMIT_DATA, (options.memory_mb << 20,) * 2)
    planner = importlib.import_module(options.planner)
    for line in sys.stdin:
        if not _answer(planner, json.loads(line), lambda said: print(json.dumps(said), file=answers, flush=True)):
            return 1
    return 0


def _live_with_the_daemon(daemon: int) -> bool:
    """Give way to the machine's thread; end when the daemon is killed; leave Ctrl-C to it; leave no core file.

    False when it has been killed before this process could ask to end with it.
    """
    # systemd's filter of system calls may forbid it.
    with contextlib.suppress(PermissionError):
        os.nice(_NICER)
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    return os.getppid() == daemon


def _own_stdout() -> TextIO:
    """The pipe to the daemon; what libraries print goes to stderr."""
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    return answers


def _answer(planner: ModuleType, request: dict[str, Any], say: Callable[[dict[str, Any]], None]) -> bool:
    """False when the process should not be kept."""
    try:
        _work(planner, request, say)
    except LinedrawError as error:
        say({"failed": type(error).__name__, "words": str(error)})
    except MemoryError:
        say({"failed": "PlanningFailed", "words": "out of memory"})
        return False
    except OSError as error:
        if error.errno not in _DISK:
            raise
        place = error.filename or request["folder"]
        trouble = DiskFull if error.errno in NO_ROOM else DiskTrouble
        say({"failed": trouble.__name__, "words": f"{place}: {error.strerror}: free the disk or correct its rights"})
    else:
        say({"done": True})
    return True


def _work(planner: ModuleType, request: dict[str, Any], say: Callable[[dict[str, Any]], None]) -> None:
    settings = Settings.model_validate(request["settings"])
    folder = Path(request["folder"])
    if request["ask"] == "plan":
        planner.plan_picture(
            Path(request["source"]),
            folder,
            settings,
            request["machine"],
            name=request["name"],
            progress=lambda stage: say({"progress": stage}),
            planned=lambda: say({"planned": True}),
        )
    else:
        planner.measure_ink(folder, settings, request["machine"])


if __name__ == "__main__":
    sys.exit(main())
