"""What somebody who is to find a mistake needs of one job, in a zip: no secret is in it, and it says what is."""

from __future__ import annotations

import os
import re
import stat
import zipfile
from collections.abc import Mapping
from pathlib import Path

from daemon.errors import DiskTrouble

MOST_MB_OF_A_LOG = 2.0
"""Of a log only so much is taken, from its end."""
_SECRET_KEY = re.compile(
    r"""^(\s*#?\s*["']?[\w-]*(?:pass|secret|token|key|credential)[\w-]*["']?\s*[=:]\s*).*$""", re.I | re.M
)
_IN_URL = re.compile(r"(\w+://)[^\s/@\"']+@")
_HIDDEN = '"(left out)"'


def without_secrets(text: str) -> str:
    """Without what stands behind keys that are called after a secret, and without names and passwords in URLs."""
    return _IN_URL.sub(r"\1(left out)@", _SECRET_KEY.sub(rf"\1{_HIDDEN}", text))


def tail(path: Path, *, most_mb: float = MOST_MB_OF_A_LOG) -> bytes:
    """The end of a file, from the beginning of a line on; nothing where it cannot be read."""
    try:
        with path.open("rb") as file:
            size = file.seek(0, os.SEEK_END)
            file.seek(max(0, size - int(most_mb * 1e6)))
            said = file.read()
    except OSError:
        return b""
    return said if len(said) == size else said.partition(b"\n")[2]


def folder_files(folder: Path, *, below: str) -> dict[str, Path]:
    """Every plain file of a job's folder, links left out, by its name in the bundle."""
    plain = (path for path in sorted(folder.iterdir()) if stat.S_ISREG(path.lstat().st_mode))
    return {f"{below}/{path.name}": path for path in plain}


def write_bundle(bundle: Path, parts: Mapping[str, Path | bytes | str]) -> list[tuple[str, int]]:
    """Write the zip. Returns each part's name and size in bytes, in order.

    parts: what is in it, by name. Raises DiskTrouble where it cannot be written, or would replace something.
    """
    told: list[tuple[str, int]] = []
    try:
        with bundle.open("xb") as file, zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as into:
            os.fchmod(file.fileno(), 0o600)
            for name, part in parts.items():
                data = part.read_bytes() if isinstance(part, Path) else part.encode() if isinstance(part, str) else part
                into.writestr(name, data)
                told.append((name, len(data)))
    except FileExistsError:
        raise DiskTrouble(f"{bundle} is there already: give another name with -o") from None
    except OSError as error:
        bundle.unlink(missing_ok=True)
        raise DiskTrouble(f"{bundle} cannot be written ({error.strerror}): give another place with -o") from None
    return told
