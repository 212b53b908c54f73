"""How often a job is called finished although ink is still to come: random jobs on random simulated plotters."""

from __future__ import annotations

from dataclasses import dataclass
from random import Random

from daemon.machine.link import Link
from daemon.machine.simulated import SimulatedTransport
from daemon.shapes import ProgramLine
from firmware_protocol.grbl.session import GrblSession
from firmware_protocol.grbl.simulator.faults import SlowUsb
from firmware_protocol.grbl.simulator.simulator import GrblSimulator
from firmware_protocol.ink import PenRule, Polyline
from firmware_protocol.session import Verdict

JOBS = 1000
_AFTERWARDS_S = 600.0
"""So long the machine is left alone: whatever it still has to draw it draws."""
_SAME_MM = 0.02


@dataclass(frozen=True, slots=True)
class RandomJob:
    """A page of strokes, a pen and a machine."""

    lines: list[ProgramLine]
    strokes: list[Polyline]
    lift: tuple[str, ...]
    pen: PenRule
    settings: dict[int, float]
    latency_s: float
    flow: str


def show() -> None:
    """Print how many of `JOBS` random jobs were called finished too early, or drawn otherwise than asked."""
    faults = [(seed, why) for seed in range(JOBS) if (why := fault_of(seed))]
    print(f"{JOBS} random jobs on a simulated GRBL: {len(faults)} called finished before all of their ink was drawn")
    for seed, why in faults[:10]:
        print(f"  job {seed}: {why}")


def fault_of(seed: int) -> str:
    """Draw the random job of that number. Returns what is wrong with its end; empty when nothing is."""
    job = random_job(Random(seed))
    slow = [SlowUsb(job.latency_s)] if job.latency_s else []
    simulator = GrblSimulator(settings=job.settings, pen=job.pen, faults=slow)
    transport = SimulatedTransport(simulator)
    flow = "line" if job.flow == "line" else "count"
    link = Link(transport, GrblSession(now=transport.now(), lift=job.lift, flow=flow), heard=lambda event: None)
    link.connect()
    ended = link.draw(job.lines)
    then = simulator.ink
    simulator.advance(transport.now() + _AFTERWARDS_S)
    link.close()
    if ended.verdict is not Verdict.FINISHED:
        return f"ended as {ended.verdict.value}: {ended.why}"
    if then != simulator.ink:
        return f"{len(then)} strokes when it was called finished, {len(simulator.ink)} in the end, or more of the last"
    return "" if same(then, job.strokes) else f"the ink is not what was asked for: {then} instead of {job.strokes}"


def random_job(random: Random) -> RandomJob:
    """Strokes with the pen on Z or on a servo, some with a dwell; the last one is often slow or long."""
    servo = random.random() < 0.5
    down, up = (["M3 S900", "G4 P0.15"], ["M5", "G4 P0.15"]) if servo else (["G1 Z0 F1200"], ["G0 Z4"])
    lines = [ProgramLine(text) for text in ("G21 G90", *up)]
    strokes = [_random_stroke(random) for _ in range(random.randint(1, 4))]
    for index, stroke in enumerate(strokes):
        feed = random.choice([300, 900, 3000])
        travel, *draw = [f"X{x:.2f} Y{y:.2f}" for x, y in stroke]
        texts = [f"G0 {travel}", *down, f"G1 F{feed} {draw[0]}", *draw[1:]]
        if index < len(strokes) - 1 or random.random() < 0.7:
            texts += up
        lines += [ProgramLine(text, index) for text in texts]
    settings: dict[int, float] = {1: random.choice([25, 255]), 11: random.choice([0.002, 0.01, 0.05])}
    speed, acceleration = random.choice([500, 3000, 8000]), random.choice([10, 100, 800])
    settings |= dict.fromkeys((110, 111, 112), speed) | dict.fromkeys((120, 121, 122), acceleration)
    return RandomJob(
        lines,
        strokes,
        ("M5", "G4 P0.15") if servo else ("G90 G21", "G0 Z4"),
        PenRule(down_s=900) if servo else PenRule(),
        settings,
        random.choice([0.0, 0.0, 0.001, 0.016]),
        random.choice(["count", "count", "line"]),
    )


def _random_stroke(random: Random) -> Polyline:
    x, y = random.uniform(2, 60), random.uniform(2, 60)
    points = [(round(x, 2), round(y, 2))]
    step_mm = random.choice([0.3, 1.0, 5.0])
    for _ in range(random.randint(1, 15)):
        x, y = x + random.uniform(0.2, 1) * step_mm, y + random.uniform(-1, 1) * step_mm
        points.append((round(x, 2), round(y, 2)))
    return points


def same(ink: list[Polyline], strokes: list[Polyline]) -> bool:
    """Whether the ink has the same strokes with the same points, to the width of a step or two."""
    return [len(line) for line in ink] == [len(stroke) for stroke in strokes] and all(
        abs(a - b) <= _SAME_MM
        for line, stroke in zip(ink, strokes, strict=True)
        for point, wanted in zip(line, stroke, strict=True)
        for a, b in zip(point, wanted, strict=True)
    )
