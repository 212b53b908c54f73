"""docs/first-hour.md names only commands and options that there are, and shows what they say."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from daemon.cli.__main__ import main

TEXT = (Path(__file__).parents[3] / "docs" / "first-hour.md").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "words", sorted(set(re.findall(r"linedrawd (doctor|setup|calibrate|report)((?: [^#`\n]*)?)(?=[#`\n])", TEXT)))
)
def test_every_command_has_the_options_that_the_page_gives_it(
    words: tuple[str, str], capsys: pytest.CaptureFixture[str]
) -> None:
    command, rest = words
    with pytest.raises(SystemExit) as ended:
        main([command, "--help"])
    assert ended.value.code == 0
    said = capsys.readouterr().out
    assert all(option in said for option in re.findall(r"--[a-z-]+", rest))


def test_all_four_commands_are_on_the_page() -> None:
    assert {"doctor", "setup", "calibrate", "report"} <= set(re.findall(r"linedrawd (\w+)", TEXT))
