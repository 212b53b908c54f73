"""What is done to the daemon and to the machine, and what each must leave behind."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
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
    """What a kill works on, and the dice that say how."""

    daemon: Daemon
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
    drawn, begun = _drawing(bench), _begun(bench)
    bench.daemon.signal(signal.SIGTERM)
    code = bench.daemon.code()
    if code != 0:
        bench.checks.found.other[f"code {code}"] = f"SIGTERM ended the daemon with code {code}, not 0"
    _gone(bench)
    # As for a stop: a machine that an earlier cut has locked with its pen down lifts it when it homes.
    if drawn or _begun(bench) != begun:
        _pen_is_up(bench, "SIGTERM")
    _start_again(bench)


def stop_by_order(bench: Bench) -> None:
    drawn, begun = _drawing(bench), _begun(bench)
    if bench.daemon.order("stop") is None:
        bench.checks.found.other["stop"] = "the daemon did not obey a stop"
    _await_over(bench, _drawing(bench))
    # Also after one that began while the order was on its way. Where there is none, nobody lifts a pen that an earlier
    # cut has left down: it is lifted when the next drawing begins.
    if drawn or _begun(bench) != begun:
        _pen_is_up(bench, "a stop")


def cut_the_power(bench: Bench) -> None:
    drawn = _drawing(bench)
    bench.machine.happen("brown-out")
    _await_over(bench, drawn)


def unplug(bench: Bench) -> None:
    drawn = _drawing(bench)
    bench.machine.happen("unplug")
    _await_over(bench, drawn)
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


def _drawing(bench: Bench) -> set[str]:
    return _in(bench, *UNDER_THE_PEN)


def _in(bench: Bench, *states: State) -> set[str]:
    return {job.id for job in told(bench.daemon.journal).values() if job.state in states}


def _begun(bench: Bench) -> int:
    """How many drawings have been begun since the first start."""
    return sum(job.states.count(State.DRAWING) for job in told(bench.daemon.journal).values())


def _await_over(bench: Bench, drawn: set[str]) -> None:
    """Until what was being drawn has ended, well or not."""
    await_(f"{', '.join(drawn)} is over", lambda: not drawn & _drawing(bench), within_s=OVER_WITHIN_S)


def _pen_is_up(bench: Bench, after: str) -> None:
    if not bench.machine.sheet().pen_up:
        bench.checks.found.other[f"pen {after}"] = f"after {after} the pen was on the sheet"
