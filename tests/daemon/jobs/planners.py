"""A second planner for the worker: what it does stands in the picture, and every way of going wrong is real."""

from __future__ import annotations

import ctypes
import errno
import json
import os
import signal
import time
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np

from daemon.config import Settings
from daemon.errors import BadPicture

WARNINGS = ["the ink is very faint"]
PROGRAM = """(linedrawd: 2 strokes)
(no stroke)
G21 G90
G0 Z5
(stroke 0)
G0 X1 Y1
G1 Z0 F600
G1 X9 Y1 F1200
G0 Z5
(stroke 1)
G0 X1 Y5
G1 Z0 F600
G1 X9 Y5 F1200
G0 Z5
(no stroke)
G0 X0 Y0
"""


def plan_picture(
    source: Path,
    folder: Path,
    settings: Settings,
    machine: str,
    *,
    name: str,
    progress: Callable[[str], None],
    planned: Callable[[], None],
) -> None:
    progress("decode")
    text = source.read_text()
    if text == "bad":
        raise BadPicture(f"{name or source.name} is no picture: drop another")
    if text in WAYS:
        WAYS[text]()
    progress("write")
    print("libraries print to stdout")
    strokes = [[[1, 1], [9, 1]], [[1, 5], [9, 5]]]
    (folder / "strokes.json").write_text(json.dumps({"strokes": strokes, "machine": machine, "nice": os.nice(0)}))
    (folder / "program.gcode").write_text(PROGRAM)
    (folder / "report.json").write_text(json.dumps({"strokes": 2, "real_s": None, "warnings": WARNINGS}))
    (folder / "environment.json").write_text(json.dumps(dict(os.environ)))
    planned()
    if text in AT_REST:
        WAYS[AT_REST[text]]()
    if text == "waits at rest":
        while not (folder / "go on").exists():
            time.sleep(0.001)
        (folder / "report.json").write_text(json.dumps({"strokes": 2, "real_s": None, "warnings": WARNINGS}))
        (folder / "whole").touch()


def measure_ink(folder: Path, settings: Settings, machine: str) -> None:
    ink = json.loads((folder / "ink.json").read_text())
    report = json.loads((folder / "report.json").read_text()) | {"ink_strokes": len(ink["strokes"])}
    (folder / "report.json").write_text(json.dumps(report))


AT_REST = {f"{way} at rest": way for way in ("crash", "eat", "fill")}
"""What goes wrong behind the program."""


def _crash() -> None:
    os.kill(os.getpid(), signal.SIGSEGV)


def _hang() -> None:
    while True:
        signal.pause()


def _eat() -> None:
    eaten = []
    while True:
        eaten.append(bytearray(16 << 20))


def _eat_in_cpp() -> None:
    ctypes.CDLL("libstdc++.so.6")["_ZSt17__throw_bad_allocv"]()


def _eat_in_opencv() -> None:
    cv2.resize(np.zeros((9, 9), np.uint8), (32_000, 32_000))


def _fill() -> None:
    with open("/dev/full", "w", buffering=1) as full:
        full.write("no room\n")


def _refuse() -> None:
    raise PermissionError(errno.EACCES, "Permission denied", "strokes.json")


def _mistake() -> None:
    raise KeyError("a mistake in the planner")


WAYS: dict[str, Callable[[], None]] = {
    "crash": _crash,
    "hang": _hang,
    "eat": _eat,
    "eat in C++": _eat_in_cpp,
    "eat in OpenCV": _eat_in_opencv,
    "fill": _fill,
    "refuse": _refuse,
    "mistake": _mistake,
}
