"""The watchdog is fed while the loops go on, and only then; ready is said when it is true."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from threading import Thread
from typing import Any

import pytest

from daemon.errors import LinedrawError, SettingsError
from daemon.notify import Notifier
from daemon.pulse import Pulse
from daemon.status import MachineStatus, Status
from daemon.supervision import Supervision, in_words
from tests.systemd.manager import Manager, manager


class Bench:
    def __init__(self, systemd: Manager, *, watchdog_s: float | None = None) -> None:
        self.systemd, self.now_s, self.said = systemd, 0.0, list[str]()
        self.status, self.answers, self.changed = Status(state="idle"), True, ["sheet.rotate = 90 holds at once"]
        self.pulse = Pulse(lambda: self.now_s)
        self.supervision = Supervision(
            Notifier(systemd.address, watchdog_s=watchdog_s),
            self.pulse,
            say=self._say,
            status=lambda: self.status,
            answers=self._answer,
            reread=self._reread,
            now=lambda: self.now_s,
        )

    def _say(self, words: str, **_: Any) -> None:
        self.said.append(words)

    def _answer(self) -> None:
        if not self.answers:
            raise LinedrawError("nobody answers")

    def _reread(self) -> list[str]:
        if not self.changed:
            raise SettingsError("linedrawd.toml is not TOML: correct that place")
        return self.changed

    def run_to_its_end(self) -> None:
        thread = Thread(target=self.supervision.run)
        thread.start()
        self.supervision.end()
        thread.join(20)
        assert not thread.is_alive()


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    with manager(str(tmp_path / "notify")) as systemd:
        yield Bench(systemd)


def test_ready_is_said_once_when_the_inbox_is_watched_and_the_socket_answers(bench: Bench) -> None:
    bench.supervision.watching()
    bench.supervision.watching()
    bench.run_to_its_end()
    assert [bench.systemd.next(), bench.systemd.next()] == ["READY=1", "STOPPING=1"]
    assert bench.systemd.nothing()


def test_ready_is_not_said_before_the_inbox_is_watched(bench: Bench) -> None:
    bench.run_to_its_end()
    assert bench.systemd.next() == "STOPPING=1"


def test_ready_is_not_said_while_nobody_answers(bench: Bench) -> None:
    bench.answers = False
    bench.supervision.watching()
    bench.run_to_its_end()
    assert bench.systemd.next() == "STOPPING=1"
    assert bench.said == ["not ready: nobody answers"]


def test_a_reload_says_what_has_changed_and_ends_ready(bench: Bench) -> None:
    bench.supervision.reread()
    bench.run_to_its_end()
    assert bench.systemd.next().startswith("RELOADING=1\nMONOTONIC_USEC=")
    assert bench.systemd.next() == "READY=1"
    assert bench.said == bench.changed


def test_settings_that_are_wrong_leave_the_old_ones(bench: Bench) -> None:
    bench.changed = []
    bench.supervision.reread()
    bench.run_to_its_end()
    assert bench.systemd.next().startswith("RELOADING=1")
    assert bench.systemd.next() == "READY=1"
    assert bench.said == ["the settings stay as they were: linedrawd.toml is not TOML: correct that place"]


def fed(bench: Bench) -> bool:
    bench.now_s += 100.0
    bench.supervision._feed(10.0)
    return not bench.systemd.nothing()


@pytest.mark.parametrize("heart", ["drawing (left)", "planning", "inbox (all)"])
def test_the_watchdog_is_fed_until_a_loop_stands_still(bench: Bench, heart: str) -> None:
    pulse = bench.pulse
    hearts = {each.name: each for each in (pulse.drawing("left"), pulse.planning, pulse.inbox("all"))}
    assert fed(bench), "a loop that has not begun is not late"
    hearts[heart].within(100.0)
    assert fed(bench)
    assert not fed(bench)
    assert not fed(bench)
    assert bench.said == [f"the {heart} loop is 100 s late: the watchdog is not fed, systemd starts linedrawd anew"]
    hearts[heart].within(100.0)
    assert fed(bench)


def test_while_it_draws_only_the_loops_that_draw_count(bench: Bench) -> None:
    for heart in (bench.pulse.inbox("all"), bench.pulse.planning, bench.pulse.drawing("right")):
        heart.within(1.0)
    bench.status = Status(machines={"left": MachineStatus(state="drawing"), "right": MachineStatus(state="idle")})
    assert fed(bench)
    bench.pulse.drawing("left").within(1.0)
    assert not fed(bench)


def test_the_watchdog_is_fed_thrice_in_its_period(tmp_path: Path) -> None:
    with manager(str(tmp_path / "notify")) as systemd:
        bench = Bench(systemd, watchdog_s=9.0)
        heard = []
        for _ in range(18):
            bench.supervision._feed(3.0)
            heard.append(not systemd.nothing())
            bench.now_s += 0.5
    assert heard.count(True) == 6


def test_the_status_is_a_line() -> None:
    idle = Status(state="waiting", words="a new sheet, then `linedrawd next`", jobs_queued=1, jobs_waiting=2)
    assert in_words(idle) == "waiting, a new sheet, then `linedrawd next`, 3 waiting"
    drawing = Status(state="drawing", picture="house.png", strokes_done=3, strokes_total=12, percent=24.6)
    assert in_words(drawing) == "drawing house.png: 3 of 12 strokes, 25 %"
    assert in_words(replace(drawing, words="slow")) == "drawing house.png: 3 of 12 strokes, 25 %, slow"
