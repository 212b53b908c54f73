"""What `linedrawd setup` and `linedrawd calibrate` have in common: the machine is theirs, the card is drawn."""

from __future__ import annotations

import argparse
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import closing, contextmanager, suppress
from pathlib import Path

from daemon.cli.options import read_file
from daemon.config import Machine, Options, Settings, load_settings
from daemon.control import NoDaemon, Order, give_order
from daemon.errors import NoMachine, SettingsError
from daemon.jobs.card import card_programs, card_seconds, draw_card, gauge_words
from daemon.jobs.devices import check, opened
from daemon.jobs.open_machine import OpenMachine
from daemon.setup.edit import Values, lines_of, put_back, replace_file, with_keys

HEAR_EVERY_S = 0.2


def only_machine(settings: Settings) -> tuple[str, Machine]:
    """The one that is meant, by its name."""
    return next(iter(settings.machines.items()))


@contextmanager
def our_machine(settings: Settings) -> Iterator[OpenMachine]:
    """The machine with its port open, nothing said yet. Raises NoMachine while the daemon has it, or where none is."""
    machine = only_machine(settings)[1]
    check(machine)
    with suppress(NoDaemon):
        give_order(settings.paths.control, Order(order="ping"))
        raise NoMachine("linedrawd runs and has the machine: stop it first, as with `sudo systemctl stop linedrawd`")
    with closing(opened(machine, lambda event: None, False)) as found:
        yield found


def draw(settings: Settings, *, corrected: bool) -> None:
    """The card, now; Ctrl-C lifts the pen. Raises LinedrawError."""
    name, machine = only_machine(settings)
    programs = card_programs(settings.sheet_of(name), machine, corrected=corrected)
    minutes = max(1, round(card_seconds(programs, machine) / 60))
    with our_machine(settings) as found:
        print(f"the test card is being drawn on {found.name}, about {minutes} min; Ctrl-C lifts the pen", flush=True)
        attended(found, lambda: draw_card(programs, found))
    print("the test card is drawn")
    gauge_words(machine, print)


def attended(machine: OpenMachine, work: Callable[[], object]) -> None:
    """Have it done in a thread of its own, while this one hears Ctrl-C, which holds the machine and lifts the pen."""
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        with ThreadPoolExecutor(1) as threads:
            done = threads.submit(work)
            while not done.done():
                try:
                    wait([done], HEAR_EVERY_S)
                except KeyboardInterrupt:
                    machine.stop()
            done.result()
    finally:
        signal.signal(signal.SIGTERM, before)


def settings_file(args: argparse.Namespace, environment: dict[str, str]) -> Path:
    """The file that settings are written into: the one that is read, else the one that would be."""
    found = read_file(args, environment)
    if found:
        return found
    home = Path(environment.get("XDG_CONFIG_HOME") or Path(environment.get("HOME", "/nonexistent")) / ".config")
    return home / "linedrawd" / "linedrawd.toml"


def write(file: Path, values: Values, *, text: str | None = None, tell: bool = True) -> None:
    """Change these keys of the file and say so. Raises SettingsError; the file is then as it was.

    text: what the file is taken to hold, if not what it does. tell: which keys they are.
    """
    before = file.read_text(encoding="utf-8") if file.exists() else ""
    changed = with_keys(before if text is None else text, values)
    kept = replace_file(file, changed)
    try:
        load_settings(Options(config=file))
    except SettingsError:
        put_back(file, kept)
        raise
    if tell:
        print(f"\n{lines_of(values)}\n")
    print(f"written into {file}" + (f"; as it was before: {kept}" if kept else ""))
