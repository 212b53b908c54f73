"""Which settings hold as soon as they are read again, and which need a restart."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fnmatch import fnmatchcase
from typing import Any

from daemon.config.load import Settings

AT_ONCE: Mapping[str, str] = {
    "sheet.*": "the next picture that is planned",
    "planning.time_limit_s": "the next picture that is planned",
    "planning.graph": "the next picture that is planned",
    "planning.network": "the next picture that is planned",
    "planning.fill": "the next picture that is planned",
    "planning.hatch_*": "the next picture that is planned",
    "planning.merge": "the next picture that is planned",
    "planning.explain": "the next picture that is planned",
    "machines.*.draw_mm_s": "the next picture that is planned",
    "machines.*.resolution_mm": "the next picture that is planned",
    "machines.*.box_mm": "the next picture that is planned",
    "machines.*.box_origin_mm": "the next picture that is planned",
    "machines.*.corner": "the next picture that is planned",
    "machines.*.scale_*": "the next picture that is planned",
    "machines.*.skew_deg": "the next picture that is planned",
    "machines.*.backlash_mm": "the next picture that is planned",
    "intake.max_megapixels": "the next picture that is planned",
    "intake.approve": "the next picture that is planned",
    "intake.duplicates": "the next picture that comes in",
    "keep.free_mb": "the next picture that comes in",
    "keep.jobs_days": "the next look at old jobs",
    "keep.jobs_mb": "the next look at old jobs",
}
"""By key, from when a change holds. Every other key needs a restart: an open port, a watched folder or a started
process was made with it."""


def reread(now: Settings, new: Settings) -> tuple[Settings, list[str]]:
    """What holds from now on, and a sentence for each key that has changed."""
    if _devices(now) != _devices(new):
        return now, ["machines has changed to other machines: restart linedrawd"]
    old, wanted = dict(_leaves(now.model_dump())), dict(_leaves(new.model_dump()))
    changed = [key for key in sorted(old | wanted) if old.get(key) != wanted.get(key)]
    taken = {key: wanted[key] for key in changed if key in wanted and since(key)}
    return Settings.model_validate(_with(now.model_dump(), taken)), [_words(key, wanted.get(key)) for key in changed]


def since(key: str) -> str:
    """From when a change of this key holds, in words; "" when it needs a restart. key: as `sheet.box_mm`."""
    return next((words for pattern, words in AT_ONCE.items() if fnmatchcase(key, pattern)), "")


def _devices(settings: Settings) -> dict[str, str]:
    return {name: machine.device for name, machine in settings.machines.items()}


def _words(key: str, value: object) -> str:
    said = f"{key} = {value}" if value is not None else f"{key}, which is no longer set,"
    return f"{said} holds from {since(key)} on" if since(key) else f"{said} needs a restart: restart linedrawd"


def _leaves(tree: Mapping[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    for key, value in tree.items():
        if isinstance(value, Mapping) and value:
            yield from _leaves(value, f"{above}{key}.")
        else:
            yield f"{above}{key}", value


def _with(tree: dict[str, Any], values: Mapping[str, Any]) -> dict[str, Any]:
    for key, value in values.items():
        *sections, last = key.split(".")
        place = tree
        for section in sections:
            place = place[section]
        place[last] = value
    return tree
