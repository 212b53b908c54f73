"""The daemon's side of the worker process: started when first needed, kept warm, killed when it takes too long."""

from __future__ import annotations

import json
import os
import re
import selectors
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import daemon
from daemon import errors
from daemon.config import Settings
from daemon.errors import PlanningFailed

PLANNER = "daemon.jobs.planner"
_ROOT = Path(daemon.__file__).parent.parent
_LAST_WORDS_BYTES = 4096
_LARGE_BYTES = str(1 << 20)
_OUT_OF_MEMORY = re.compile(
    "MemoryError|bad_alloc|bad allocation|Insufficient memory|Cannot allocate memory|Failed to allocate memory|"
    "can't start new thread"
)
"""Last words of Python, C++, OpenCV, the kernel, the network's library, and threads that found no room for a stack."""


class Pool:
    """Has pictures planned and ink measured, one request at a time, each within the limits of `settings.planning`.

    Every call raises the LinedrawError that the planner raised, or PlanningFailed when the worker died, ran out of
    memory or out of time; the next call starts a new worker. `interrupt` and `close` may be called from any thread.
    """

    def __init__(self, settings: Settings, *, planner: str | None = None) -> None:
        self._planner = planner or PLANNER
        self.settings = settings
        """What is asked from now on; the limits of a worker are those of its start."""
        self._lock = threading.Lock()
        self._drawable: Path | None = None
        """The folder whose program can be drawn while the worker still makes its pictures."""
        self._whole = threading.Condition()
        self._worker: _Worker | None = None
        self._closed = False

    def plan(
        self,
        source: Path,
        folder: Path,
        machine: str,
        *,
        name: str = "",
        progress: Callable[[str], None],
        planned: Callable[[], None] = lambda: None,
    ) -> None:
        """Fill the job's folder with its plan. `progress` is told the name of each stage as it begins.

        name: what people call the picture, if not by the path of `source`. planned: called as soon as the program can
        be drawn; what is raised from then on is about the pictures of the plan.
        """
        request = {"ask": "plan", "source": str(source), "name": name, "folder": str(folder), "machine": machine}

        def drawable() -> None:
            self._let_draw(folder)
            planned()

        try:
            self._ask(request, progress, drawable)
        finally:
            self._let_draw(None)

    def await_pictures(self, folder: Path) -> None:
        """Wait until the worker writes nothing into this folder any more, well or badly. From any thread."""
        with self._whole:
            self._whole.wait_for(lambda: self._drawable != folder)

    def _let_draw(self, folder: Path | None) -> None:
        with self._whole:
            self._drawable = folder
            self._whole.notify_all()

    def measure(self, folder: Path, machine: str) -> None:
        """Compare the ink in `ink.json` with the picture."""
        self._ask({"ask": "measure", "folder": str(folder), "machine": machine}, lambda _: None)

    def interrupt(self) -> None:
        """Break off what the worker is doing; its caller gets PlanningFailed."""
        worker = self._worker
        if worker:
            worker.kill()

    def close(self) -> None:
        self._closed = True
        self.interrupt()
        with self._lock:
            self._drop()

    def _ask(
        self, request: dict[str, Any], progress: Callable[[str], None], planned: Callable[[], None] = lambda: None
    ) -> None:
        request["settings"] = self.settings.model_dump(mode="json")
        with self._lock:
            answer = self._answer(request, progress, planned)
            if answer.get("words") == "out of memory":
                self._drop()
                raise _out_of_memory(self.settings.planning.memory_mb)
        if "failed" in answer:
            raise getattr(errors, answer["failed"])(answer["words"])

    def _answer(
        self, request: dict[str, Any], progress: Callable[[str], None], planned: Callable[[], None]
    ) -> dict[str, Any]:
        answer: dict[str, Any] | None = None
        try:
            limit_s = self.settings.planning.time_limit_s
            for said in self._started().ask(request, limit_s):
                if "progress" in said:
                    progress(said["progress"])
                elif "planned" in said:
                    planned()
                else:
                    answer = said
        finally:
            # Whatever was thrown: what a worker says from here on would answer another question.
            if answer is None:
                self._drop()
        assert answer is not None
        return answer

    def _started(self) -> _Worker:
        if self._closed:
            raise PlanningFailed("the daemon is ending: start it again")
        if self._worker is None or not self._worker.alive:
            self._drop()
            self._worker = _Worker(self._planner, self.settings)
        return self._worker

    def _drop(self) -> None:
        worker, self._worker = self._worker, None
        if worker:
            worker.end()


def _out_of_memory(limit_mb: int) -> PlanningFailed:
    return PlanningFailed(f"planning needs more than {limit_mb} MB: scale the picture down or raise memory_mb")


class _Worker:
    """One process. Every way in which it can end is said as PlanningFailed, with its last words."""

    def __init__(self, planner: str, settings: Settings) -> None:
        limits = settings.planning
        command = [
            sys.executable,
            "-m",
            "daemon.jobs.worker",
            "--planner",
            planner,
            "--memory-mb",
            str(limits.memory_mb),
            "--daemon",
            str(os.getpid()),
        ]
        threads = str(limits.threads)
        environment = {"ORT_DISABLE_TELEMETRY": "1", "OMP_NUM_THREADS": threads, "OPENBLAS_NUM_THREADS": threads}
        # Left alone, the C library keeps what large arrays leave: after some pages half as much again.
        environment |= {"MALLOC_MMAP_THRESHOLD_": _LARGE_BYTES, "MALLOC_TRIM_THRESHOLD_": _LARGE_BYTES}
        self._process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            bufsize=0,
            cwd=_ROOT,
            env=os.environ | environment,
        )
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        assert self._process.stderr is not None
        self._in, self._out, self._err = self._process.stdin, self._process.stdout, self._process.stderr
        self._heard = b""
        self._last_words = b""
        self._memory_mb = limits.memory_mb

    @property
    def alive(self) -> bool:
        return self._process.poll() is None

    def ask(self, request: dict[str, Any], limit_s: float) -> Iterator[dict[str, Any]]:
        """What it says, to its last word."""
        until = time.monotonic() + limit_s
        try:
            self._in.write(json.dumps(request).encode() + b"\n")
        except BrokenPipeError:
            raise self._died() from None
        while True:
            answer: dict[str, Any] = json.loads(self._line(until, limit_s))
            yield answer
            if answer.keys() & {"done", "failed"}:
                return

    def _line(self, until: float, limit_s: float) -> bytes:
        with selectors.DefaultSelector() as ears:
            ears.register(self._out, selectors.EVENT_READ)
            ears.register(self._err, selectors.EVENT_READ)
            while b"\n" not in self._heard:
                ready = ears.select(max(0.0, until - time.monotonic()))
                if not ready:
                    raise PlanningFailed(
                        f"planning took more than {limit_s:g} s: simplify the picture or raise time_limit_s"
                    )
                for key, _ in ready:
                    self._hear(ears, key)
        line, _, self._heard = self._heard.partition(b"\n")
        return line

    def _hear(self, ears: selectors.BaseSelector, key: selectors.SelectorKey) -> None:
        data = os.read(key.fd, 65536)
        if key.fileobj is self._err:
            self._last_words = (self._last_words + data)[-_LAST_WORDS_BYTES:]
            if not data:
                ears.unregister(self._err)
        elif data:
            self._heard += data
        else:
            raise self._died()

    def _died(self) -> PlanningFailed:
        code = self._process.wait()
        self._last_words += self._err.read() or b""
        said = self._last_words.decode("utf-8", "backslashreplace").strip().rpartition("\n")[2]
        if _OUT_OF_MEMORY.search(said):
            return _out_of_memory(self._memory_mb)
        how = f"was killed by {signal.Signals(-code).name}" if code < 0 else f"ended with {code}"
        return PlanningFailed(
            f"the planning process {how}{' after saying ' + said if said else ''}: try another picture"
        )

    def kill(self) -> None:
        self._process.kill()

    def end(self) -> None:
        self._process.kill()
        self._process.wait()
        for pipe in (self._in, self._out, self._err):
            pipe.close()
