"""systemd/linedrawd.toml from the model of the settings: every key, what it is for, and what holds where it is not set.

python -m tests.settings_page
"""

from __future__ import annotations

import ast
import inspect
import json
import textwrap
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from daemon.config import DEFAULT_MACHINE, DobotMachine, EmcoMachine, GrblMachine, ServoPenSettings, Settings
from daemon.config.paths import Paths
from daemon.config.reread import since

PAGE = Path(__file__).parents[1] / "systemd" / "linedrawd.toml"
SYSTEMD = {
    "STATE_DIRECTORY": "/var/lib/linedrawd",
    "LOGS_DIRECTORY": "/var/log/linedrawd",
    "RUNTIME_DIRECTORY": "/run/linedrawd",
}
"""What systemd gives the daemon in its environment."""
EXAMPLES: Mapping[str, Any] = {
    "pen_life_m": 1000.0,
    "motors_off_after_min": 10.0,
    "size_mm": (210.0, 297.0),
    "box_mm": (180.0, 260.0),
    "box_origin_mm": (15.0, 15.0),
    "corner": "lower left",
    "holds_bytes": 512,
    "holds_blocks": 10,
    "line": 17,
}
"""For keys that are not set unless somebody does."""
_PATHS = {
    "state_dir": "/var/lib/linedrawd",
    "inbox": "/var/lib/linedrawd/inbox",
    "log_dir": "/var/log/linedrawd",
    "runtime_dir": "/run/linedrawd",
}
_SAID = {("scanner", "kind"): "none", ("button", "kind"): "none"}
"""Said in the file, as is the device of a machine: a section without it would mean something else."""
_WIDTH = 118
_HEAD = """# The settings of linedrawd. Install as /etc/linedrawd/linedrawd.toml.
#
# Every key is here, with the value that holds while it is not set: take the # before a key away to set it. A key that
# is misspelled is refused. `systemctl restart linedrawd` makes all of them hold; where it says "reload",
# `systemctl reload linedrawd` does, in the middle of a drawing too.
#
# Made from the code by `python -m tests.settings_page`; only what you set is yours.
"""
_SECTIONS = {
    "paths": "Where everything lies; nothing is written anywhere else. systemd gives a service these folders.",
    "intake": "How pictures come in.",
    "keep": "How much is kept. Only jobs that are over are ever removed, the oldest first.",
    "planning": "Limits of the worker process that plans, and how it reads a page.",
    "sheet": "Where on the sheet a picture is drawn, in mm inwards from the corner where the origin lies.",
    "pens": "Pens of several colours, drawn one after the other.",
    "scanner": "The scanner: which one, how it scans, and which button of its is heard.",
    "button": "A button beside the machine: a key of a keyboard or foot switch, or a button at a pin of the board.",
}
_PLOTTER = "The machine: one section [machines.NAME]. Positions are in mm of the sheet, or of the machine once homed."


def page() -> str:
    """The whole file."""
    return "\n".join([_HEAD, *(text for _, text in blocks())])


def blocks() -> Iterator[tuple[str, str]]:
    """The parts of the file by name; those of another pen and of other machines are commented out as a whole."""
    models: dict[str, Any] = {name: field.annotation for name, field in Settings.model_fields.items()}
    for name, words in _SECTIONS.items():
        yield name, _section(name, words, models[name])
    yield "grbl", _machine(DEFAULT_MACHINE, _PLOTTER, GrblMachine)
    servo = _section(
        f"machines.{DEFAULT_MACHINE}.pen", "Or a pen on a servo, in place of that section:", ServoPenSettings
    )
    yield "servo", _commented(servo)
    yield "emco", _commented(_machine("mill", "Or an EMCO Concept Mill, in place of the plotter:", EmcoMachine))
    yield "dobot", _commented(_machine("arm", "Or a Dobot Magician, in place of the plotter:", DobotMachine))


def uncommented(text: str) -> str:
    """With every key set."""
    return "".join(
        line[not line.startswith(("# ", "#\n")) and line.startswith("#") :] for line in text.splitlines(True)
    )


def explained(model: type[BaseModel], key: str) -> str:
    """What the code says below this key, in the class or in one that it is made from. Raises KeyError."""
    for owner in model.__mro__:
        if key in inspect.get_annotations(owner) and key in (docs := _docs(owner)):
            return docs[key]
    raise KeyError(f"{model.__name__}.{key} has no sentence below it that explains it: write one")


def _machine(name: str, words: str, model: type[BaseModel]) -> str:
    place, pen = f"machines.{name}", model.model_fields["pen"].default
    its_pen = _section(f"{place}.pen", "How its pen is lowered and lifted.", type(pen), dict(pen))
    return _section(place, words, model) + "\n" + its_pen


def _section(place: str, words: str, model: type[BaseModel], values: Mapping[str, Any] | None = None) -> str:
    """values: by key, where they are not those of the model."""
    held = values or {key: _default(model, key) for key in model.model_fields}
    keys = [_key(place, model, key, held[key]) for key in model.model_fields if key != "pen"]
    return "\n".join([_comment(words), f"[{place}]", *keys, ""])


def _default(model: type[BaseModel], key: str) -> Any:
    field = model.model_fields[key]
    if model is Paths:
        return _PATHS[key]
    return get_args(field.annotation)[0] if field.is_required() else field.get_default(call_default_factory=True)


def _key(place: str, model: type[BaseModel], key: str, value: Any) -> str:
    field = model.model_fields[key]
    said = (place, key) in _SAID or (key == "device" and place.startswith("machines."))
    notes = ", ".join(note for note in (_range(field), "reload" if since(f"{place}.{key}") else "") if note)
    unset = " Not set here." if value is None else ""
    words = explained(model, key) + (f" ({notes})" if notes else "") + unset
    shown = _SAID.get((place, key), EXAMPLES[key] if value is None else value)
    return f"{_comment(words)}\n{'' if said else '#'}{key} = {_toml(shown)}"


def _docs(owner: type) -> dict[str, str]:
    (tree,) = ast.parse(textwrap.dedent(inspect.getsource(owner))).body
    assert isinstance(tree, ast.ClassDef)
    return {
        above.target.id: " ".join(str(below.value.value).split())
        for above, below in zip(tree.body, tree.body[1:], strict=False)
        if isinstance(above, ast.AnnAssign) and isinstance(above.target, ast.Name)
        if isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant)
    }


def _range(field: FieldInfo) -> str:
    """What values there are, as far as the type says it."""
    if get_origin(field.annotation) is Literal:
        choices = get_args(field.annotation)
        return "one of " + ", ".join(map(_toml, choices)) if len(choices) > 1 else ""
    words = {"gt": "above", "ge": "at least", "lt": "below", "le": "at most"}
    limits = [(words[name], getattr(bound, name)) for bound in field.metadata for name in words if hasattr(bound, name)]
    return ", ".join(f"{word} {limit:g}" for word, limit in limits)


def _toml(value: Any) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(map(_toml, value))}]"
    return json.dumps(value)


def _comment(words: str) -> str:
    return textwrap.fill(words, _WIDTH, initial_indent="# ", subsequent_indent="# ", break_on_hyphens=False)


def _commented(text: str) -> str:
    return "".join(line if line.startswith(("#", "\n")) else f"#{line}" for line in text.splitlines(True))


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
