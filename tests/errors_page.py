"""docs/errors.md from the tables of codes and sentences in the code.

python -m tests.errors_page
"""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

from daemon import errors
from daemon.errors import LinedrawError
from firmware_protocol.dobot import alarms
from firmware_protocol.dobot import sentences as dobot
from firmware_protocol.emco import sentences as emco
from firmware_protocol.grbl import codes
from firmware_protocol.grbl import sentences as grbl
from firmware_protocol.grbl.findings import Needs, findings
from firmware_protocol.grbl.states import State

PAGE = Path(__file__).parents[1] / "docs" / "errors.md"
_HEAD = """# What can go wrong, and what to do

Made from the tables in the code by `python -m tests.errors_page`; change them there. Every sentence that linedrawd says
has the same form: what is wrong, where, and after the last colon what to do. Where `...` stands, the sentence names
the line, the figure or the place.
"""
_FIGURE = 98765
"""No code of any table, and no figure of any sentence."""
_PLACEHOLDERS: dict[str, Any] = {
    "int": _FIGURE,
    "float": _FIGURE,
    "str": "...",
    "bool": False,
    "Triple": (_FIGURE,) * 3,
    "tuple[float, float]": (_FIGURE,) * 2,
}
_UNSUITABLE = {
    1: 25, 10: 1, 13: 1, 20: 0, 22: 1, 23: 0, 30: 100, 31: 50, 32: 1, 130: 200, 131: 200, 132: 200,
}  # fmt: skip
"""Settings of a controller that hardly anything may be drawn with."""


def page() -> str:
    """The whole page."""
    parts = [
        _HEAD,
        _section("Exit codes", ("code", "error", "it means"), _exit_codes()),
        _section("GRBL: `error:N`", ("N", "it means", "what to do"), _codes(codes.ERRORS)),
        _section("GRBL: `ALARM:N`", ("N", "it means", "what to do"), _codes(codes.ALARMS)),
        _findings(),
        _sentences("GRBL: how a job ends", grbl, *_late()),
        _section("Dobot Magician: alarms", ("code", "group", "it means", "what to do"), _alarms()),
        _sentences("Dobot Magician: how a job ends", dobot),
        _sentences("EMCO: how a job ends", emco),
    ]
    return "\n".join(parts)


def main() -> None:
    PAGE.write_text(page(), encoding="utf-8")
    print(f"{PAGE.relative_to(PAGE.parents[1])} is made")


def _section(title: str, heads: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    lines = [heads, ("---",) * len(heads), *rows]
    return "\n".join([f"## {title}", "", *(f"| {' | '.join(map(_cell, line))} |" for line in lines), ""])


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def _exit_codes() -> Iterator[tuple[str, str, str]]:
    kinds = [kind for kind in vars(errors).values() if isinstance(kind, type) and issubclass(kind, LinedrawError)]
    yield "0", "", "It is done."
    for kind in sorted(kinds, key=lambda kind: kind.exit_code):
        if kind is not LinedrawError:
            yield str(kind.exit_code), f"`{kind.__name__}`", inspect.getdoc(kind) or ""


def _codes(table: dict[int, codes.Code]) -> Iterator[tuple[str, str, str]]:
    for number, code in sorted(table.items()):
        yield str(number), code.meaning, code.remedy


def _alarms() -> Iterator[tuple[str, str, str, str]]:
    for code, alarm in sorted(alarms.ALARMS.items()):
        yield f"0x{code:02X}", alarm.group.name, alarm.name, alarm.group.remedy


def _findings() -> str:
    needs = Needs(((0.0, 0.0, 0.0), (9.0, 9.0, 5.0)), frozenset({10.0, 700.0}), firmware="grblHAL 1.1f")
    rows = ((each.about, each.why, "yes" if each.blocks else "") for each in findings(_UNSUITABLE, needs))
    return _section("GRBL: settings that a drawing wants otherwise", ("about", "an example", "nothing is drawn"), rows)


def _late() -> Iterator[str]:
    """What is said of a controller that does not get ready, by what has been heard of it."""
    for state in (State.WAITING, State.GREETED, State.HOMING):
        for found, heard in ((False, ""), (False, "..."), (True, "...")):
            yield (
                grbl.late(state, _FIGURE, found=found, heard=heard).replace("'...'", "...").replace(str(_FIGURE), "...")
            )


def _sentences(title: str, module: ModuleType, *more: str) -> str:
    """Every constant and every function that needs nothing but figures and texts, in the order of the file."""
    said = [sentence for name, what in vars(module).items() for sentence in _said(module, name, what)]
    return "\n".join([f"## {title}", "", *(f"- {sentence}" for sentence in dict.fromkeys([*said, *more])), ""])


def _said(module: ModuleType, name: str, what: Any) -> Iterator[str]:
    if name.startswith("_"):
        return
    if isinstance(what, str) and name.isupper():
        yield what
    elif isinstance(what, dict) and name.isupper():
        yield from what.values()
    elif inspect.isfunction(what) and what.__module__ == module.__name__:
        parameters = inspect.signature(what).parameters.values()
        if all(str(parameter.annotation) in _PLACEHOLDERS for parameter in parameters):
            yield _with_gaps(what, [(parameter.name, str(parameter.annotation)) for parameter in parameters])


def _with_gaps(sentence: Any, parameters: list[tuple[str, str]]) -> str:
    """The sentence with `...` for every figure and text that it is given."""
    text = str(sentence(**{name: _PLACEHOLDERS[kind] for name, kind in parameters}))
    return text.replace("'...'", "...").replace(f"{_FIGURE:g}", "...").replace(str(_FIGURE), "...")


if __name__ == "__main__":
    main()
