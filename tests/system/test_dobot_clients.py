"""Clients that other people wrote move the simulated arm, and our driver draws on an arm that other people wrote."""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from threading import Event

import numpy as np
import pytest

from daemon.machine.link import Link
from daemon.machine.serial_port import open_serial
from daemon.program.dobot import write_dobot
from daemon.shapes import Program, Stroke, Toolpath
from firmware_protocol.dobot.kinematics import SHEET_ORIGIN_MM
from firmware_protocol.dobot.session import DobotSession
from firmware_protocol.session import Ended, Verdict
from tests.system.dobot_clients import CLIENTS, THEIR_ARM
from tests.system.test_other_senders import installed

pytestmark = pytest.mark.system

UP_MM, DOWN_MM = 10.0, -10.0
WITHIN_MM = 0.7
"""How far apart the ticks of pydobotlab's arm are, and so how closely its trace can be known."""


class Arm:
    """An arm in a process of its own, and its port."""

    def __init__(self, command: list[str | Path], link: Path, folder: Path) -> None:
        self.port = link
        environment = os.environ | {"XDG_CONFIG_HOME": str(folder)}
        self._process = subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL)
        while self._process.poll() is None and not link.exists():
            Event().wait(0.05)

    def end(self) -> None:
        """Switch it off and wait for what it writes then."""
        self._process.send_signal(signal.SIGTERM)
        assert self._process.wait(10) == 0

    def kill(self) -> None:
        self._process.kill()
        self._process.wait()


@pytest.fixture
def ours(tmp_path: Path) -> Iterator[Arm]:
    link = tmp_path / "arm"
    command = [sys.executable, "-m", "daemon.cli", "simulate", "dobot", "--url", "sim://dobot?home_s=1"]
    arm = Arm([*command, "--pty", link], link, tmp_path)
    yield arm
    arm.kill()


@pytest.mark.parametrize("package", list(CLIENTS))
def test_a_client_finds_an_arm_that_does_what_it_must(package: str, ours: Arm, tmp_path: Path) -> None:
    python = installed(package, tmp_path / "venv")
    environment = os.environ | {"XDG_CONFIG_HOME": str(tmp_path)}
    subprocess.run([python, "-c", CLIENTS[package], ours.port], check=True, timeout=120, env=environment)


def page(straight: str) -> tuple[Toolpath, Program]:
    square = Stroke(np.array([[10.0, 10], [40, 10], [40, 40], [10, 40], [10, 10]]))
    bow = Stroke(np.array([[25 + 12 * math.cos(k / 4), 60 + 12 * math.sin(k / 4)] for k in range(12)]))
    toolpath = Toolpath((square, bow, Stroke(np.array([[50.0, 60.0]]))), np.zeros((2, 3)), park_mm=(25.0, 57.0))
    return toolpath, write_dobot(toolpath, up_mm=UP_MM, down_mm=DOWN_MM, draw_mm_s=60.0, straight=straight)


def drawn_by_us(port: Path, program: Program) -> Ended:
    transport = open_serial(f"serial://{port}")
    link = Link(transport, DobotSession(now=transport.now(), home=True, up_mm=UP_MM), heard=lambda event: None)
    try:
        link.connect()
        return link.draw(program.lines)
    finally:
        link.close()


@pytest.mark.parametrize("straight", ["PTP", "CP"])
def test_we_draw_a_page_on_pydobotlabs_own_arm(straight: str, tmp_path: Path) -> None:
    python = installed("pydobotlab==0.2.1.1", tmp_path / "venv")
    trace = tmp_path / "trace.json"
    arm = Arm([python, "-c", THEIR_ARM, tmp_path / "arm", trace], tmp_path / "arm", tmp_path)
    try:
        toolpath, program = page(straight)
        end = drawn_by_us(arm.port, program)
        arm.end()
    finally:
        arm.kill()
    assert (end.verdict, end.strokes_certain) == (Verdict.FINISHED, 3)
    if straight == "PTP":
        check_ink(ink_of(json.loads(trace.read_text())), toolpath)


def ink_of(trace: list[list[float]]) -> list[list[tuple[float, float]]]:
    """Where its tool was down, in mm of the sheet."""
    ink: list[list[tuple[float, float]]] = []
    before = False
    for x, y, z in trace:
        down = z <= DOWN_MM + 1e-3
        if down and not before:
            ink.append([])
        if down:
            ink[-1].append((x - SHEET_ORIGIN_MM[0], y - SHEET_ORIGIN_MM[1]))
        before = down
    return ink


def check_ink(ink: list[list[tuple[float, float]]], toolpath: Toolpath) -> None:
    """Every stroke whole, and nothing else."""
    assert len(ink) == len(toolpath.strokes)
    for line, stroke in zip(ink, toolpath.strokes, strict=True):
        wanted = [(float(x), float(y)) for x, y in stroke.points]
        assert all(min(math.dist(point, near) for near in line) < WITHIN_MM for point in wanted)
        sides = list(pairwise(wanted)) or [(wanted[0], wanted[0])]
        assert all(min(off(point, *side) for side in sides) < WITHIN_MM for point in line)


def off(point: tuple[float, float], a: tuple[float, float], b: tuple[float, float]) -> float:
    """Distance of a point from a line."""
    along = (b[0] - a[0], b[1] - a[1])
    squared = along[0] ** 2 + along[1] ** 2
    share = 0.0 if squared == 0 else ((point[0] - a[0]) * along[0] + (point[1] - a[1]) * along[1]) / squared
    share = max(0.0, min(1.0, share))
    return math.dist(point, (a[0] + share * along[0], a[1] + share * along[1]))
