"""What is done to the daemon and to the machine, and what each must leave behind."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from random import Random

from daemon.jobs.states import UNDER_THE_PEN, State
from tests.torture.check import Checks
from tests.torture.rig import GONE_WITHIN_S, Daemon, Machine, Stuck, await_
from tests.torture.told import told

OVER_WITHIN_S = 60.0
"""How long the end of a drawing may take, once something has happened to it."""


@dataclass(frozen=True, slots=True)
class Bench:
    """What a kill works on, and the dice that say how. machine: that one of `machines` which the kill is meant for."""

    daemon: Daemon
    machines: Sequence[Machine]
    machine: Machine
    checks: Checks
    random: Random


def kill_the_daemon(bench: Bench) -> None:
    bench.daemon.signal(signal.SIGKILL)
    _gone(bench)
    _start_again(bench)


def kill_the_worker(bench: Bench) -> None:
    bench.checks.planners_killed.update(_in(bench, State.PLANNING))
    for pid in bench.daemon.children():
        os.kill(pid, signal.SIGKILL)


def end_in_order(bench: Bench) -> None:
    before = _at_work(bench)
    bench.daemon.signal(signal.SIGTERM)
    code = bench.daemon.code()
    if code != 0:
        bench.checks.found.other[f"code {code}"] = f"SIGTERM ended the daemon with code {code}, not 0"
    _gone(bench)
    _pens_are_up(bench, before, "SIGTERM")
    _start_again(bench)


def stop_by_order(bench: Bench) -> None:
    before = _at_work(bench)
    if bench.daemon.order("stop") is None:
        bench.checks.found.other["stop"] = "the daemon did not obey a stop"
    _await_over(bench, _drawing(bench))
    _pens_are_up(bench, before, "a stop")


def cut_the_power(bench: Bench) -> None:
    _cut(bench, "brown-out")


def unplug(bench: Bench) -> None:
    _cut(bench, "unplug")
    time.sleep(bench.random.uniform(0, 1))
    bench.machine.happen("plug in")


def unplug_and_kill(bench: Bench) -> None:
    both: list[Callable[[], None]] = [
        lambda: bench.machine.happen("unplug"),
        lambda: bench.daemon.signal(signal.SIGKILL),
    ]
    bench.random.shuffle(both)
    for act in both:
        act()
    _gone(bench)
    bench.machine.happen("plug in")
    _start_again(bench)


def cut_the_power_and_kill(bench: Bench) -> None:
    bench.machine.happen("brown-out")
    kill_the_daemon(bench)


def fill_the_disk(bench: Bench) -> None:
    bench.daemon.fill_the_disk(full=True)
    time.sleep(bench.random.uniform(0, 2))
    if bench.random.random() < 0.5:
        return kill_the_daemon(bench)
    bench.daemon.fill_the_disk(full=False)
    return None


KINDS: dict[str, tuple[Callable[[Bench], None], int]] = {
    "kill -9 of the daemon": (kill_the_daemon, 8),
    "kill -9 of the worker": (kill_the_worker, 4),
    "SIGTERM": (end_in_order, 5),
    "stop": (stop_by_order, 3),
    "power cut of the machine": (cut_the_power, 4),
    "unplug": (unplug, 4),
    "unplug and kill -9": (unplug_and_kill, 4),
    "power cut and kill -9": (cut_the_power_and_kill, 3),
    "disk full": (fill_the_disk, 4),
}
"""Each with what is done, and how often among the others."""


def _cut(bench: Bench, sentence: str) -> None:
    """It ends what this machine draws, and nothing that another one draws."""
    drawn = _drawing(bench, bench.machine)
    others = _drawing(bench) - drawn
    bench.machine.happen(sentence)
    _await_over(bench, drawn)
    for job in others & _in(bench, State.INTERRUPTED, State.FAILED):
        words = f"job {job} on another machine than {bench.machine.name} was ended by its {sentence}"
        bench.checks.found.other[f"other {job}"] = words


def _start_again(bench: Bench) -> None:
    bench.daemon.start()
    bench.daemon.await_ready()


def _gone(bench: Bench) -> None:
    """A daemon that has ended leaves no process behind."""
    bench.daemon.code()
    try:
        await_("no process is left", lambda: not bench.daemon.family(), within_s=GONE_WITHIN_S)
    except Stuck:
        left = bench.daemon.family()
        bench.checks.found.other[f"orphans {left}"] = f"the daemon has ended, its processes {left} have not"
        for pid in left:
            os.kill(pid, signal.SIGKILL)


def _drawing(bench: Bench, machine: Machine | None = None) -> set[str]:
    """On this machine, or on any."""
    under = (job for job in told(bench.daemon.journal).values() if job.state in UNDER_THE_PEN)
    return {job.id for job in under if machine is None or job.begun_on[-1] == machine.name}


def _in(bench: Bench, *states: State) -> set[str]:
    return {job.id for job in told(bench.daemon.journal).values() if job.state in states}


def _at_work(bench: Bench) -> dict[str, tuple[bool, int]]:
    """By the name of each machine: whether it draws, and how many drawings it has begun since the first start."""
    jobs = told(bench.daemon.journal).values()
    return {
        machine.name: (bool(_drawing(bench, machine)), sum(job.begun_on.count(machine.name) for job in jobs))
        for machine in bench.machines
    }


def _await_over(bench: Bench, drawn: set[str]) -> None:
    """Until what was being drawn has ended, well or not."""
    await_(f"{', '.join(drawn)} is over", lambda: not drawn & _drawing(bench), within_s=OVER_WITHIN_S)


def _pens_are_up(bench: Bench, before: dict[str, tuple[bool, int]], after: str) -> None:
    """That of each machine that drew, or has begun meanwhile.

    Where one did not, nobody lifts a pen that an earlier cut has left down: it is lifted when the next drawing begins.
    """
    now = _at_work(bench)
    for machine in bench.machines:
        drew, begun = before[machine.name]
        if (drew or now[machine.name][1] != begun) and not machine.sheet().pen_up:
            words = f"after {after} the pen of {machine.name} was on the sheet"
            bench.checks.found.other[f"pen {machine.name} {after}"] = words
