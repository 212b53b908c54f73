"""What works on one state folder, put together: the desk, the worker, and for each machine what draws on it."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from daemon.config import Settings
from daemon.errors import LinedrawError, SettingsError
from daemon.intake.rank import Rank, rank
from daemon.jobs.allotment import Allotment
from daemon.jobs.beats import Beats
from daemon.jobs.desk import Desk
from daemon.jobs.devices import check, moves_of, opened
from daemon.jobs.drawing import Drawing
from daemon.jobs.folder import JobFolders, make_folder
from daemon.jobs.frame import places_of
from daemon.jobs.kept_ink import Reports
from daemon.jobs.mending import Mending
from daemon.jobs.open_journal import open_journal
from daemon.jobs.pen_life import PenLife
from daemon.jobs.planning import Planning
from daemon.jobs.pool import Pool
from daemon.jobs.runner import Runner
from daemon.jobs.sheet import holds_box
from daemon.jobs.station import Station
from daemon.jobs.wishes import settings_for
from daemon.machine.recorder import Recorder
from daemon.program.file import load_program
from daemon.pulse import Pulse
from daemon.status import Diary, StatusBoard


@dataclass(frozen=True, slots=True)
class Parts:
    """What works on one state folder. Nothing of it runs yet. pens, drawings: by the name of the machine."""

    desk: Desk
    pool: Pool
    planning: Planning
    runner: Runner
    board: StatusBoard
    diary: Diary
    pulse: Pulse
    pens: dict[str, PenLife] = field(default_factory=dict)
    drawings: dict[str, Drawing] = field(default_factory=dict)


@contextmanager
def parts_of(
    settings: Settings, *, verbose: bool = False, planner: str | None = None, record: Path | None = None
) -> Iterator[Parts]:
    """Everything that works on the state folder, which belongs to us until the block is left.

    record: a file into which everything that is said to the one machine and by it is written.

    Raises SettingsError when another daemon works on it or its programs suit no machine here, and DiskTrouble.
    """
    paths, keep = settings.paths, settings.keep
    _check_machines(settings, record)
    for folder in (paths.state_dir, paths.inbox, paths.log_dir, paths.runtime_dir):
        make_folder(folder)
    for inbox in settings.inboxes.values():
        _make_inbox(inbox, like=paths.inbox)
    with ExitStack() as at_end:
        at_end.enter_context(_only_one(paths.state_dir))
        folders = JobFolders(paths.jobs)
        diary = Diary(paths.log_dir, paths.jobs, to_stderr=verbose, log_mb=keep.log_mb, log_files=keep.log_files)
        at_end.enter_context(closing(diary))
        board = StatusBoard(paths.status)
        journal = at_end.enter_context(closing(open_journal(paths.journal, say=diary.say)))
        folders.go_on_behind(job.id for job in journal.jobs())
        desk = Desk(journal, folders, say=diary.say, show=board.change, rank=_rank_in(settings))
        pool = at_end.enter_context(closing(Pool(settings, planner=planner)))
        suits = _suits(pool, desk)
        planning = Planning(
            desk,
            pool,
            Allotment(
                desk, ahead=settings.planning.ahead, suits=suits, shared=settings.sharing, asks=_asks(pool, desk)
            ),
        )
        drawings: dict[str, Drawing] = {}
        pulse = Pulse()
        runner = Runner(desk, pool, planning, drawings, pulse)
        parts = Parts(desk, pool, planning, runner, board, diary, pulse, drawings=drawings)
        recorder = at_end.enter_context(closing(Recorder(record))) if record else None
        board.change(recording=str(record.absolute()) if record else "")
        for name in settings.machines:
            _add_machine(parts, settings, name, recorder)
            at_end.callback(drawings[name].close)
        yield parts


def _make_inbox(inbox: Path, *, like: Path) -> None:
    """Whoever may drop pictures into the one may do so into the other."""
    if not inbox.exists():
        make_folder(inbox).chmod(like.stat().st_mode & 0o7777)


def _check_machines(settings: Settings, record: Path | None) -> None:
    if record and len(settings.machines) > 1:
        raise SettingsError("--record writes what one machine hears and says: name it with --machine, of `draw`")
    for name, machine in settings.machines.items():
        try:
            check(machine)
        except LinedrawError as error:
            raise SettingsError(f"[machines.{name}]: {error}" if len(settings.machines) > 1 else str(error)) from None


def _add_machine(parts: Parts, settings: Settings, name: str, recorder: Recorder | None) -> None:
    """A station, a pen and a way to draw. Its name stands in what people are told once another one is there."""
    machine, pool, heart = settings.machines[name], parts.pool, parts.pulse.drawing(name)
    station = Station(
        parts.desk,
        name,
        show=lambda **values: parts.board.change_machine(name, **values),
        asks_for_sheets=machine.asks_for_sheets,
        alike=lambda other: _alike(pool.settings, name, other),
    )
    parts.board.change_machine(name)
    parts.pens[name] = PenLife(
        _pen_file(settings, name),
        machine.pen_life_m,
        say=station.say,
        show=station.show,
        sign=sign_of("PEN", name, settings),
    )
    beats = Beats(heart)
    mending = Mending(
        machine,
        lambda hear, still: opened(machine, beats.hearing(hear), still, recorder, beats.turned),
        say=station.say,
    )
    parts.drawings[name] = Drawing(
        station,
        opened=mending.opened,
        moves=moves_of(machine),
        places=places_of(pool, station),
        load=load_program,
        reports=Reports(
            whole=lambda folder: beats.whole(pool, folder),
            measure=lambda folder: beats.measuring(pool, folder, name),
        ),
        inked=parts.pens[name].drew,
    )


def sign_of(sign: str, machine: str, settings: Settings) -> str:
    """The name of the file that a person puts into the inbox of all, for this machine."""
    return f"{sign}-{machine}" if len(settings.machines) > 1 else sign


def _pen_file(settings: Settings, machine: str) -> Path:
    """A daemon of one machine wrote no name: the first one has its pen."""
    folder = settings.paths.state_dir
    file, without_name = folder / f"pen-{machine}.json", folder / "pen.json"
    if machine == next(iter(settings.machines)) and without_name.exists() and not file.exists():
        without_name.rename(file)
    return file


def _alike(settings: Settings, machine: str, other: str) -> bool:
    machines = settings.machines
    return other in machines and machines[machine].draws_like(machines[other])


def _suits(pool: Pool, desk: Desk) -> Callable[[str, str], bool]:
    def suits(job: str, machine: str) -> bool:
        try:
            wished = settings_for(desk.folders.path(job), pool.settings, machine)
        except (LinedrawError, OSError):
            # Whoever plans it says what is wrong.
            return True
        return holds_box(wished.sheet, wished.machines[machine])

    return suits


def _asks(pool: Pool, desk: Desk) -> Callable[[str], bool]:
    """Whether a person has to approve this job, planned for its machine."""

    def asks(job: str) -> bool:
        machine = desk.find(job).machine
        try:
            return settings_for(desk.folders.path(job), pool.settings, machine).intake.approve
        except (LinedrawError, OSError):
            # Its side file was right when it was planned: whoever looks sees what has changed.
            return True

    return asks


def _rank_in(settings: Settings) -> Callable[[str], Rank]:
    return lambda name: rank(name, settings.intake.order)


@contextmanager
def _only_one(state_dir: Path) -> Iterator[None]:
    with (state_dir / "lock").open("a+", encoding="ascii") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            lock.seek(0)
            first = lock.read().strip() or "?"
            raise SettingsError(
                f"linedrawd, process {first}, already works on {state_dir}: stop it or give another --state-dir"
            ) from None
        lock.truncate(0)
        lock.write(str(os.getpid()))
        lock.flush()
        yield
