"""The pages of the manual say every command, option and setting, and nothing in them is taken for an order."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from daemon.cli.__main__ import whole_parser
from tests.systemd.test_wheels import _module

man = _module("man")
TOML = (Path(__file__).parents[2] / "systemd/linedrawd.toml").read_text(encoding="utf-8")
COMMANDS = man.commands(whole_parser(), version="1.2", date="2026-01-02")
SETTINGS = man.settings(TOML, version="1.2", date="2026-01-02")


@pytest.mark.parametrize("words", ["plan", "next", "machine check", "simulate grbl", "report"])
def test_a_command_has_its_section_and_its_options(words: str) -> None:
    (section,) = re.findall(rf"^\.SS linedrawd {words}\n(.*?)^\.S[SH]", COMMANDS, re.MULTILINE | re.DOTALL)
    assert ".TP\n\\fB\\-\\-" in section
    assert len(section.splitlines()) > 4


def test_options_that_are_for_none_of_the_commands_come_first() -> None:
    options = COMMANDS.partition(".SH OPTIONS")[2].partition(".SH COMMANDS")[0]
    assert "\n\\fB\\-\\-device {grbl,emco,dobot,sim}\\fR\n" in options
    assert "\\-\\-help" not in options


def test_every_setting_is_in_its_page() -> None:
    keys = re.findall(r"^#?(\w+) = ", TOML, re.MULTILINE)
    assert len(keys) > 50
    assert all(f"\n{key} = " in SETTINGS or f"\n#{key} = " in SETTINGS for key in keys)


@pytest.mark.parametrize("page", [COMMANDS, SETTINGS])
def test_lines_begin_with_no_other_order_than_is_meant(page: str) -> None:
    assert set(re.findall(r"^\.\w*|^'.*", page, re.MULTILINE)) <= {
        ".TH", ".SH", ".SS", ".TP", ".PP", ".B", ".BR", ".I", ".nf", ".fi",
    }  # fmt: skip


@pytest.mark.skipif(shutil.which("groff") is None, reason="groff is not installed")
@pytest.mark.parametrize("page", [COMMANDS, SETTINGS])
def test_the_typesetter_warns_of_nothing(page: str) -> None:
    typeset = ["groff", "-man", "-Tutf8", "-Kutf8", "-ww", "-z"]
    assert subprocess.run(typeset, input=page.encode(), capture_output=True, check=True).stderr == b""
