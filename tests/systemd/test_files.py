"""The files for systemd, udev and logrotate say what the daemon needs, in words that these programs know."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from daemon.machine.ports import DOBOT_IDS, GRBL_IDS
from daemon.service import LIFT_WITHIN_S

HERE = Path(__file__).parents[2] / "systemd"
EXPOSURE = 1.5
UNIT = (HERE / "linedrawd.service").read_text(encoding="utf-8")


def value(key: str) -> str:
    """The last value of a key of the unit."""
    return str(re.findall(rf"^{key}=(.*)$", UNIT, re.MULTILINE)[-1])


def here(tmp_path: Path, *, drop_ins: bool = True) -> Path:
    """The unit as it is installed, but for its program, which is one that there is."""
    unit = tmp_path / "linedrawd.service"
    unit.write_text(UNIT.replace("/opt/linedrawd/bin/linedrawd", sys.executable))
    if drop_ins:
        shutil.copytree(HERE / "drop-ins", tmp_path / "linedrawd.service.d")
    return unit


def run(*command: str | Path) -> subprocess.CompletedProcess[str]:
    assert shutil.which(str(command[0])), f"{command[0]} is not installed: apt-get install systemd logrotate"
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_the_unit_waits_for_ready_and_starts_again_what_can_get_better() -> None:
    keys = ("Type", "NotifyAccess", "ExecStart", "ExecReload", "Restart", "RestartPreventExitStatus", "OOMPolicy")
    assert {key: value(key) for key in keys} == {
        "Type": "notify",
        "NotifyAccess": "main",
        "ExecStart": "/opt/linedrawd/bin/linedrawd -v",
        "ExecReload": '/bin/sh -c "kill -HUP ${MAINPID}"',
        "Restart": "on-failure",
        "RestartPreventExitStatus": "2",
        "OOMPolicy": "continue",
    }


def test_a_stop_has_the_time_to_lift_the_pen() -> None:
    assert float(value("TimeoutStopSec")) > LIFT_WITHIN_S


def test_every_adapter_that_the_daemon_looks_for_starts_it() -> None:
    rules = (HERE / "70-linedrawd.rules").read_text(encoding="utf-8")
    found = re.findall(r'ENV{ID_VENDOR_ID}=="(\w{4})", ENV{ID_MODEL_ID}=="([\w|]+)", GOTO="linedrawd_machine"', rules)
    ids = {(int(vendor, 16), int(model, 16)) for vendor, models in found for model in models.split("|")}
    assert ids == GRBL_IDS | DOBOT_IDS


def test_the_rules_come_after_those_they_lean_on_and_lead_only_to_their_own_labels() -> None:
    rules = [path for path in HERE.glob("*.rules")]
    assert [path.name for path in rules if path.name > "60-serial.rules"] == [path.name for path in rules] != []
    text = rules[0].read_text(encoding="utf-8")
    assert set(re.findall(r'GOTO="(\w+)"', text)) == set(re.findall(r'LABEL="(\w+)"', text))


@pytest.mark.system
def test_systemd_finds_nothing_wrong_with_the_unit_and_its_drop_ins(tmp_path: Path) -> None:
    # A key that it does not know is said on stderr and is no failure.
    said = run("systemd-analyze", "verify", "--man=no", here(tmp_path))
    assert (said.returncode, said.stdout, said.stderr) == (0, "", "")


@pytest.mark.system
def test_the_unit_is_exposed_as_little_as_was_measured(tmp_path: Path) -> None:
    threshold = f"--threshold={10 * EXPOSURE:.0f}"
    said = run("systemd-analyze", "security", "--offline=true", threshold, here(tmp_path, drop_ins=False))
    assert said.returncode == 0, said.stdout
    assert "Overall exposure level" in said.stdout


@pytest.mark.system
def test_the_user_is_made_with_its_groups_and_the_inbox_takes_what_the_group_drops(tmp_path: Path) -> None:
    (tmp_path / "etc").mkdir()
    assert run("systemd-sysusers", f"--root={tmp_path}", HERE / "linedrawd.sysusers").returncode == 0
    groups = (tmp_path / "etc/group").read_text()
    assert re.findall(r"^(dialout|scanner):.*:linedrawd$", groups, re.MULTILINE) == ["dialout", "scanner"]
    made = run("systemd-tmpfiles", f"--root={tmp_path}", "--create", HERE / "linedrawd.tmpfiles")
    assert (made.returncode, made.stderr) == (0, "")
    state = tmp_path / "var/lib/linedrawd"
    assert [oct(path.stat().st_mode & 0o7777) for path in (state, state / "inbox")] == ["0o750", "0o2770"]


@pytest.mark.system
def test_logrotate_understands_its_file() -> None:
    said = run("logrotate", "--debug", HERE / "linedrawd.logrotate")
    assert (said.returncode, "error:" in said.stderr) == (0, False), said.stderr
    assert "/var/log/linedrawd/linedrawd.log" in said.stderr + said.stdout
