"""Commands a second into the simulated Dobot Magician on its wire, what they cost, and whether the pen ever waits."""

from __future__ import annotations

import time

from daemon.machine.link import Link
from daemon.machine.simulated import SimulatedTransport
from daemon.shapes import ProgramLine
from firmware_protocol.dobot.session import DobotSession
from firmware_protocol.dobot.simulator.arm import Build
from firmware_protocol.dobot.simulator.simulator import DobotSimulator
from firmware_protocol.ink import PenRule
from tests.firmware_protocol.dobot.bench import Bench, strokes

COMMANDS = 3000
BAR_S = 200
_LATE_S = (0.0, 0.002, 0.005, 0.01)
"""How much later than it could the host does each thing, as on a board that plans the next picture meanwhile."""


def show() -> None:
    """Print the figures."""
    print(f"{COMMANDS} commands into the simulated Dobot, 115200 baud, bar {BAR_S} commands/s on the wire")
    wire_s, cpu_s, verdict = sent()
    print(f"{COMMANDS / wire_s:9.0f} commands/s  {cpu_s / COMMANDS * 1e6:6.0f} CPU us/command  ended {verdict}")
    print("strokes of 1 mm segments at 60 mm/s: seconds for which the pen stood on the paper")
    for late_s in _LATE_S:
        print(f"{waited_s(late_s):9.3f} s  with a host that is {1000 * late_s:g} ms late each time")


def sent() -> tuple[float, float, str]:
    """Seconds on the simulated clock, seconds of this process, verdict; of segments that are no limit for the arm."""
    simulator = DobotSimulator(build=Build(), pen=PenRule(down_at_mm=0.0))
    transport = SimulatedTransport(simulator, name="sim://dobot")
    link = Link(transport, DobotSession(now=0.0, home=False, up_mm=10.0), heard=lambda event: None)
    link.connect()
    places = (210 + (k % 2) * 0.1 for k in range(COMMANDS))
    lines = [ProgramLine(f"CP 1 {x:.3f} 0.000 50.000 200.000", 0) for x in places]
    began_s, cpu_s = transport.now(), time.process_time()
    end = link.draw(lines)
    return transport.now() - began_s, time.process_time() - cpu_s, end.verdict.value


def waited_s(late_s: float) -> float:
    """How long the pen stood on the paper in mid stroke because the queue was empty."""
    bench = Bench(late_s=late_s)
    bench.draw(strokes(6, segments=80, step_mm=1.0, mm_s=60.0))
    return bench.sim.arm.waited_on_paper_s


if __name__ == "__main__":
    show()
