"""What is wrong with a setting, said with its place and its cure."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeAlias

from pydantic import BaseModel, ValidationError

from daemon.config.machine import DobotMachine, EmcoMachine, GrblMachine
from daemon.config.pen import ServoPenSettings, ZPenSettings
from daemon.errors import unknown

Place: TypeAlias = tuple[int | str, ...]

_MACHINES: dict[int | str, type[BaseModel]] = {"grbl": GrblMachine, "emco": EmcoMachine, "dobot": DobotMachine}
_PENS: dict[int | str, type[BaseModel]] = {"z": ZPenSettings, "servo": ServoPenSettings}


def explain(error: ValidationError, place: str, sections: Mapping[str, Any]) -> str:
    """A sentence for each thing that is wrong. place: the file. sections: the settings' own fields, by name."""
    return "; ".join(_one(item["loc"], item["type"], item["msg"], place, sections) for item in error.errors())


def _one(loc: Place, kind: str, words: str, place: str, sections: Mapping[str, Any]) -> str:
    if not loc:
        # Several sections that do not go together: the words name them.
        return f"{place}: {words.removeprefix('Value error, ')}"
    *section, key = [str(part) for part in _as_written(loc)]
    where = f"{place}: [{'.'.join(section)}] {key}" if section else f"{place}: {key}"
    if kind == "extra_forbidden":
        known = _known_names(loc, sections)
        return unknown(where, key, known)
    return f"{where}: {words.removeprefix('Value error, ')}"


def _as_written(loc: Place) -> Place:
    """Without the names of the kinds, which stand in no file as keys."""
    match loc:
        case ("machines", name, device, "pen", kind, *rest) if device in _MACHINES and kind in _PENS:
            return ("machines", name, "pen", *rest)
        case ("machines", name, device, *rest) if device in _MACHINES:
            return ("machines", name, *rest)
    return loc


def _known_names(loc: Place, sections: Mapping[str, Any]) -> list[str]:
    match loc:
        case ("machines", _, _, "pen", kind, _):
            model: Any = _PENS[kind]
        case ("machines", _, _, "pen", _):
            model = ZPenSettings
        case ("machines", _, device, _):
            model = _MACHINES[device]
        case (str() as section, _):
            model = sections[section].annotation
        case _:
            return list(sections)
    return list(model.model_fields)
