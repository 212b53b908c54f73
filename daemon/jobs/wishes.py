"""What is wished for one picture, laid over the settings."""

from __future__ import annotations

from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from daemon.config import PenSettings, Settings
from daemon.errors import SettingsError, unknown
from daemon.intake.side import Wishes, parse, read_bytes

SIDE_NAME = "side.toml"
"""Of the side file in a job's folder."""


def with_wishes(settings: Settings, wishes: Wishes, machine: str, place: str) -> Settings:
    """The settings for one picture on this machine. Raises SettingsError: the place, the key and the cure."""
    sheet, own = settings.sheet_of(machine), settings.machines[machine]
    if wishes.box_mm:
        if 2 * sheet.margin_mm >= min(wishes.box_mm):
            raise SettingsError(f"{place}: size_mm leaves no room in the margin of {sheet.margin_mm:g} mm: say more")
        sheet = sheet.model_copy(update={"box_mm": wishes.box_mm, "size": "fit"})
    if wishes.pen:
        own = own.model_copy(update={"pen": _pen(own.pen, wishes, place)})
    if wishes.approve:
        settings = settings.model_copy(update={"intake": settings.intake.model_copy(update={"approve": True})})
    own = own.model_copy(update={"box_mm": None, "box_origin_mm": None, "corner": None})
    return settings.model_copy(update={"sheet": sheet, "machines": {machine: own}})


def machines_for(settings: Settings, wishes: Wishes, place: str) -> list[str]:
    """The machines that a picture with these wishes may be drawn by. Raises SettingsError where there is none."""
    if wishes.machine and wishes.machine not in settings.machines:
        raise SettingsError(unknown(f"{place}: machine '{wishes.machine}'", wishes.machine, list(settings.machines)))
    return [wishes.machine] if wishes.machine else sorted(settings.sharing)


def _pen(pen: PenSettings, wishes: Wishes, place: str) -> PenSettings:
    if "kind" in wishes.pen:
        raise SettingsError(f"{place}: [pen] kind belongs to the machine: leave it out")
    try:
        wished = TypeAdapter[PenSettings](PenSettings).validate_python(pen.model_dump() | wishes.pen)
        if wished.kind == "z" and pen.kind == "z" and (pen.up_mm > pen.down_mm):
            wished.check_lifts()
    except ValidationError as error:
        raise SettingsError(
            "; ".join(_sentence(item["loc"], item["msg"], pen, place) for item in error.errors())
        ) from None
    except ValueError as error:
        raise SettingsError(f"{place}: {error}") from None
    return wished


def _sentence(loc: tuple[int | str, ...], words: str, pen: PenSettings, place: str) -> str:
    key, known = str(loc[-1]), [name for name in type(pen).model_fields if name != "kind"]
    where = f"{place}: [pen] {key}"
    return f"{where}: {words}" if key in known else unknown(where, key, known)


def settings_for(folder: Path, settings: Settings, machine: str) -> Settings:
    """The settings for the job in this folder. Raises SettingsError where its side file does not suit the machine."""
    place, path = f"{folder.name}/{SIDE_NAME}", folder / SIDE_NAME
    wishes = parse(read_bytes(path), place) if path.exists() else Wishes()
    return with_wishes(settings, wishes, machine, place)
