"""A side file: what is wished for one picture, in `picture.toml` beside `picture.png`."""

from __future__ import annotations

import os
import tomllib
from pathlib import Path
from typing import Annotated, Any, TypeAlias

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from pydantic_core import ErrorDetails

from daemon.errors import SettingsError, unknown

SUFFIX = ".toml"
LIMIT_BYTES = 65536
Length: TypeAlias = Annotated[float, Field(gt=0, le=10000)]


class Wishes(BaseModel):
    """What a side file may say; what it leaves out is as in the settings."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    size_mm: Length | tuple[Length, Length] | None = None
    """The box that the picture is fitted into: its side, or its width and height."""
    copies: Annotated[int, Field(ge=1, le=100)] = 1
    machine: str = ""
    """The name of its section in the settings."""
    approve: bool = False
    """It waits, planned, until somebody says `linedrawd approve JOB`; where the settings say so, it does anyway."""
    pen: dict[str, Any] = Field(default_factory=dict)
    """Keys of the machine's pen that are different for this picture."""

    @property
    def box_mm(self) -> tuple[float, float] | None:
        """Width and height of the box, None where nothing is said of it."""
        return (self.size_mm, self.size_mm) if isinstance(self.size_mm, float) else self.size_mm


def side_name(picture: str) -> str:
    """The name of the side file that belongs to a picture of this name."""
    return stem(picture) + SUFFIX


def is_side(name: str) -> bool:
    return name.endswith(SUFFIX)


def stem(name: str) -> str:
    """The name without its last suffix; a dot at its beginning is none."""
    return os.path.splitext(name)[0]


def read_bytes(path: Path) -> bytes:
    """What a side file holds. Raises OSError, also where the file is a link, and SettingsError for one too large."""
    descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
    with open(descriptor, "rb") as file:
        data = file.read(LIMIT_BYTES + 1)
    if len(data) > LIMIT_BYTES:
        raise SettingsError(f"{path.name} has more than {LIMIT_BYTES} bytes: a side file is a few lines of TOML")
    return data


def parse(data: bytes, place: str) -> Wishes:
    """The wishes in a side file's bytes. Raises SettingsError, which names the place, the key and the cure."""
    try:
        given = tomllib.loads(data.decode("utf-8"))
    except (ValueError, RecursionError) as error:
        raise SettingsError(f"{place} is not TOML ({error}): correct that place") from None
    try:
        return Wishes.model_validate(given)
    except ValidationError as error:
        raise SettingsError("; ".join(_sentences(error, place))) from None


def _sentences(error: ValidationError, place: str) -> list[str]:
    """One for each key that is wrong: a size is wrong in two ways at once, as a number and as a pair."""
    first: dict[str, ErrorDetails] = {}
    for item in error.errors():
        first.setdefault(str(item["loc"][0]), item)
    return [_sentence(key, item["type"], item["msg"], place) for key, item in first.items()]


def _sentence(key: str, kind: str, words: str, place: str) -> str:
    if kind == "extra_forbidden":
        return unknown(f"{place}: {key}", key, list(Wishes.model_fields))
    if key == "size_mm":
        words = "Input should be a length above 0, or two such as [80, 60]"
    return f"{place}: {key}: {words}"
