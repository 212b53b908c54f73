"""Keys of a settings file are changed; everything else in it, comments too, stays as a person wrote it."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeAlias

from daemon.durable import sync_folder, whole_file
from daemon.errors import SettingsError

Values: TypeAlias = Mapping[str, Mapping[str, Any]]
"""By section, as "machines.plotter", then by key."""

_HEADER = re.compile(r"\s*#?\s*\[{1,2}[^\[\]=]+\]{1,2}\s*(#.*)?$")
_ANY_KEY = re.compile(r"#? ?[a-z_]+ *=")


def with_keys(text: str, values: Values) -> str:
    """The file's text with these keys set: in place where they stand, also behind a #, else at the section's end.

    Raises SettingsError where the file sets them in another way than a key a line below its [section].
    """
    wanted = tomllib.loads(text)
    lines = text.splitlines()
    for section, keys in values.items():
        lines = _with_section(lines, section, keys)
        _merge(wanted, section, keys)
    changed = "\n".join(lines) + "\n"
    with suppress(tomllib.TOMLDecodeError):
        if tomllib.loads(changed) == json.loads(json.dumps(wanted)):
            return changed
    raise SettingsError(f"the settings cannot be changed by themselves: write into them\n{lines_of(values)}")


def lines_of(values: Values) -> str:
    """As somebody would write them."""
    return "\n\n".join(
        "\n".join([f"[{section}]", *(_line(key, value) for key, value in keys.items())])
        for section, keys in values.items()
    )


def without_keys(text: str, section: str) -> str:
    """Every key of this section is put behind a #: it belonged to another kind of machine."""
    lines = text.splitlines()
    begin, end = _body(lines, section)
    body = [f"#{line}" if _ANY_KEY.match(line) and not line.startswith("#") else line for line in lines[begin:end]]
    return "\n".join([*lines[:begin], *body, *lines[end:]]) + "\n"


def replace_file(file: Path, text: str) -> Path | None:
    """Write the settings, whole or not at all. Returns where those of before are kept; None where there were none.

    Raises SettingsError where the file cannot be written.
    """
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        kept = _keep(file)
        with whole_file(file) as part:
            part.write(text.encode())
        sync_folder(file.parent)
    except OSError as error:
        raise SettingsError(
            f"{file} cannot be written ({error.strerror}): say it as a user who may, with sudo, or give --config"
        ) from None
    return kept


def put_back(file: Path, kept: Path | None) -> None:
    """The settings of before, as `replace_file` has kept them."""
    if kept is None:
        file.unlink()
    else:
        kept.replace(file)


def _keep(file: Path) -> Path | None:
    if not file.exists():
        return None
    names = (file.with_name(f"{file.name}.before{number}") for number in ("", *range(2, 1000)))
    kept = next(name for name in names if not name.exists())
    with whole_file(kept) as copy:
        copy.write(file.read_bytes())
    return kept


def _with_section(lines: Sequence[str], section: str, keys: Mapping[str, Any]) -> list[str]:
    begin, end = _body(lines, section)
    if begin == 0:
        gap = [""] if lines and lines[-1].strip() else []
        return [*lines, *gap, f"[{section}]", *(_line(key, value) for key, value in keys.items())]
    body = list(lines[begin:end])
    for key, value in keys.items():
        places = [at for at, line in enumerate(body) if re.match(rf"\s*{key}\s*=", line)]
        hidden = [at for at, line in enumerate(body) if re.match(rf"# ?{key} *=", line)]
        if places or hidden:
            body[(places or hidden)[0]] = _line(key, value)
        else:
            last = max((at for at, line in enumerate(body) if _ANY_KEY.match(line)), default=-1)
            body.insert(last + 1, _line(key, value))
    return [*lines[:begin], *body, *lines[end:]]


def _body(lines: Sequence[str], section: str) -> tuple[int, int]:
    """From the line behind the section's header to the next header, also one behind a #; (0, 0) without it."""
    header = re.compile(rf"\s*\[\s*{re.escape(section)}\s*\]\s*(#.*)?$")
    begin = next((at + 1 for at, line in enumerate(lines) if header.match(line)), 0)
    if not begin:
        return 0, 0
    return begin, next((at for at in range(begin, len(lines)) if _HEADER.match(lines[at])), len(lines))


def _merge(tree: dict[str, Any], section: str, keys: Mapping[str, Any]) -> None:
    for name in section.split("."):
        tree = tree.setdefault(name, {})
    tree.update(keys)


def _line(key: str, value: Any) -> str:
    return f"{key} = {json.dumps(value)}"
