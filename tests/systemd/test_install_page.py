"""docs/install.md names only files and commands that there are, and installs every file for systemd."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from daemon.cli.__main__ import main

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "install.md").read_text(encoding="utf-8")


def test_every_file_for_systemd_is_installed_by_its_page() -> None:
    named = set(re.findall(r"systemd/[\w./-]+\.[a-z]+", TEXT)) | {
        f"systemd/drop-ins/{name}" for name in re.findall(r"^\| `(\w+\.conf)`", TEXT, re.MULTILINE)
    }
    there = {
        str(path.relative_to(ROOT))
        for path in (ROOT / "systemd").rglob("*")
        if path.is_file() and ROOT / "systemd/debian" not in path.parents
    }
    assert {name for name in named if not name.startswith(("systemd/system", "systemd/journald"))} == there


def test_every_page_and_drawing_that_it_leads_to_is_there() -> None:
    for link in re.findall(r"\]\(([\w/.]+)\)", TEXT):
        assert (ROOT / "docs" / link).is_file(), link
    for picture in re.findall(r"tests/drawings/[\w.]+", TEXT):
        assert (ROOT / picture).is_file(), picture


@pytest.mark.parametrize(
    "words", sorted(set(re.findall(r"linedrawd ((?:machine )?[a-z]+)(?: +#|` | &&|`\.|$)", TEXT, re.M)))
)
def test_every_command_that_it_names_is_one(words: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main([*words.split(), "--help"])
    assert ended.value.code == 0
    assert f"usage: linedrawd {words}" in capsys.readouterr().out
