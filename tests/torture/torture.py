"""The rounds: pictures come in, at a moment that the seed chooses something is killed, and everything is checked."""

from __future__ import annotations

import signal
import time
from collections import Counter
from collections.abc import Callable, Iterable
from pathlib import Path
from random import Random

from daemon.jobs.states import State
from tests.torture.check import Checks
from tests.torture.kinds import KINDS, Bench
from tests.torture.pictures import draw_picture
from tests.torture.rig import Daemon, Machine, Stuck, await_
from tests.torture.told import Told, told

UNDONE = {1: 3, 2: 5}
"""No more pictures are dropped while so many jobs wait, by the number of machines."""
MACHINES = {1: ("plotter",), 2: ("left", "right")}
MOMENTS = {"drawing": 6, "planning": 2, "any": 3}
"""What the kill waits for before its own delay, and how often among the others."""
DELAY_S = {"drawing": 2.0, "planning": 0.3, "any": 2.0}
COMES_WITHIN_S = 60.0
DRAWN_WITHIN_S = 180.0


class Torture:
    """A daemon, its machines, 1 or 2, and what has been found; `folder` keeps all that they leave."""

    def __init__(
        self, folder: Path, seed: int, *, say: Callable[[str], None], whole: bool = False, machines: int = 1
    ) -> None:
        self._folder, self._seed, self._say = folder, seed, say
        self.machines = [Machine(folder, name) for name in MACHINES[machines]]
        self.daemon = Daemon(folder, self.machines, whole=whole)
        self.checks = Checks(self.daemon, self.machines)
        self._done: Counter[str] = Counter()
        self._pictures = 0

    def __enter__(self) -> Torture:
        return self

    def __exit__(self, *_: object) -> None:
        for pid in self.daemon.family():
            if self.daemon.runs and pid == self.daemon.pid:
                self.daemon.signal(signal.SIGTERM)
        if self.daemon.runs:
            self.daemon.code()
        for machine in self.machines:
            machine.close()

    def run(self, kills: int, *, first: int = 0) -> None:
        """Do so many kills, those of the seed from number `first` on; then let everything be drawn."""
        self.daemon.start()
        self.daemon.await_ready()
        for number in range(first, first + kills):
            self._round(number, Random(f"{self._seed} {number}"))
            if self._stuck():
                return
        self._finish()

    def _round(self, number: int, random: Random) -> None:
        before = self.checks.found.count
        (kind,) = random.choices(list(KINDS), [weight for _, weight in KINDS.values()])
        (moment,) = random.choices(list(MOMENTS), list(MOMENTS.values()))
        delay_s = random.uniform(0, DELAY_S[moment])
        machine = Random(f"{self._seed} {number} machine").choice(self.machines)
        words = f"{kind}, {delay_s:.2f} s after {'the pictures' if moment == 'any' else 'the ' + moment}"
        words += f", {machine.name}" if len(self.machines) > 1 else ""
        try:
            self._drop(random)
            self._go_on()
            self._await(moment)
            time.sleep(delay_s)
            KINDS[kind][0](Bench(self.daemon, self.machines, machine, self.checks, random))
            self.checks.all()
        except Stuck as error:
            self.checks.found.other[f"stuck {number}"] = f"kill {number} ({words}): in vain waited until {error}"
        self._done[kind] += 1
        new = self.checks.found.count - before
        self._say(f"{number:5} {words}{f': {new} WRONG' if new else ''}")

    def _stuck(self) -> bool:
        return any(key.startswith("stuck") for key in self.checks.found.other)

    def _drop(self, random: Random) -> None:
        undone = sum(not job.over for job in told(self.daemon.journal).values())
        for _ in range(min(random.randint(1, 2), max(0, UNDONE[len(self.machines)] - undone))):
            self._pictures += 1
            part = self.daemon.inbox / f".p{self._pictures}.png"
            draw_picture(part, random)
            whole = self.daemon.inbox / part.name.removeprefix(".")
            self.checks.dropped(part, whole.name)
            part.rename(whole)

    def _go_on(self) -> None:
        """What a person does who has looked at the sheets."""
        for machine in self.machines:
            self.daemon.order("go", machine.name)

    def _await(self, moment: str) -> None:
        """Until a job is in that state, or nothing is left that could come into it."""
        state = {"drawing": State.DRAWING, "planning": State.PLANNING}.get(moment)
        if state is None:
            return
        await_(
            f"a job is {state.value}",
            lambda: any(job.state is state for job in told(self.daemon.journal).values()) or self._nothing_comes(state),
            within_s=COMES_WITHIN_S,
        )

    def _nothing_comes(self, state: State) -> bool:
        jobs = told(self.daemon.journal).values()
        empty = not any(path.suffix == ".png" for path in self.daemon.inbox.iterdir())
        later = {State.PLANNED, State.WAITING, State.DRAWING} if state is State.PLANNING else set()
        return empty and all(job.over or job.state in later for job in jobs)

    def _finish(self) -> None:
        """Everything that is left is drawn, and the daemon ends in order."""
        try:
            self._go_on()
            await_("every job is over", lambda: self._nothing_comes(State.DRAWING), within_s=DRAWN_WITHIN_S)
            self.checks.all()
            self.checks.at_the_end()
        except Stuck as error:
            self.checks.found.other["end"] = f"at the end waited in vain until {error}"
        self._say(", ".join(f"{kind} {times}" for kind, times in self._done.items()))
        self._say(f"{self._pictures} pictures, {_states(told(self.daemon.journal).values())}")


def _states(jobs: Iterable[Told]) -> str:
    counted = Counter(job.state.value for job in jobs)
    return ", ".join(f"{state} {count}" for state, count in counted.items())
