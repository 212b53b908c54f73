"""The fault table of all machines: every fault in three moments, what was said of it and whether it is the truth.

    python -m tests.faults [MACHINE...]

The exit code is 1 when a row is wrong: a verdict too late, or the truth outside of what was stated.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Callable, Iterable, Sequence

from tests.faults import dobot, emco, grbl
from tests.faults.row import VERDICT_WITHIN_S, Row

MACHINES: dict[str, Callable[[], Iterable[Row]]] = {"grbl": grbl.rows, "emco": emco.rows, "dobot": dobot.rows}
_HEADS = ("machine", "fault", "moment", "first sign", "verdict", "s", "certainly", "true", "possibly", "")


def main(arguments: list[str] | None = None) -> int:
    """0 when no row is wrong."""
    parser = argparse.ArgumentParser(prog="python -m tests.faults", description=__doc__.splitlines()[0])
    parser.add_argument("machines", nargs="*", metavar="MACHINE", help=f"of {', '.join(MACHINES)} (default: all)")
    asked = parser.parse_args(arguments).machines or list(MACHINES)
    if strange := set(asked) - MACHINES.keys():
        parser.error(f"there is no machine {', '.join(strange)}: name some of {', '.join(MACHINES)}")
    rows = [row for name in asked for row in MACHINES[name]()]
    print(table(rows))
    print(*in_words(rows), sep="\n")
    return 1 if any(row.outcome == "wrong" for row in rows) else 0


def table(rows: Sequence[Row]) -> str:
    """The rows under each other, columns as wide as they need."""
    cells = [_HEADS, *(_cells(row) for row in rows)]
    widths = [max(len(each[column]) for each in cells) for column in range(len(_HEADS))]
    lines = ("  ".join(cell.ljust(width) for cell, width in zip(each, widths, strict=True)) for each in cells)
    return "\n".join(line.rstrip() for line in lines)


def in_words(rows: Sequence[Row]) -> list[str]:
    """How many rows are good, the slowest verdict, and what limits the harm of what has no sign."""
    lines = [""]
    for machine in dict.fromkeys(row.machine for row in rows):
        of_it = [row for row in rows if row.machine == machine]
        counts = Counter(row.outcome for row in of_it)
        slowest_s = max((row.seconds for row in of_it if row.seconds is not None), default=0.0)
        lines.append(
            f"{machine}: {counts['ok']} ok, {counts['wrong']} wrong, {counts['undetectable']} undetectable on this "
            f"link; slowest verdict {slowest_s:.2f} s after its sign (bar {VERDICT_WITHIN_S:g} s)"
        )
    limited = dict.fromkeys((row.machine, row.fault, row.limits) for row in rows if row.outcome == "undetectable")
    lines += ["", "Undetectable, and what limits the harm:"] if limited else []
    return lines + [f"  {machine}, {fault}: {limits}" for machine, fault, limits in limited]


def _cells(row: Row) -> tuple[str, ...]:
    seconds = "" if row.seconds is None else f"{row.seconds:.2f}"
    counts = (str(row.certainly), str(row.true), str(row.possibly))
    return row.machine, row.fault, row.moment, row.sign or "none", row.verdict, seconds, *counts, row.outcome


if __name__ == "__main__":
    raise SystemExit(main())
