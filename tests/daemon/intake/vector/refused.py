"""A vector file that is not drawn: it is named, and a sentence says why."""

from __future__ import annotations

from pathlib import Path

import pytest

from daemon.errors import BadPicture
from daemon.intake.picture import open_picture


def assert_refused(file: Path, data: bytes, kind: str, words: str) -> None:
    """kind: what the file is called, as "an SVG". words: a pattern in the sentence."""
    file.write_bytes(data)
    with pytest.raises(BadPicture, match=words) as found:
        open_picture(file, name=file.name)
    assert str(found.value).startswith(f"{file.name} is {kind} that ")
