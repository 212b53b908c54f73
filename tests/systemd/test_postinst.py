"""An upgrade restarts nothing while a sheet lies under a pen."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import pytest

from daemon.jobs.states import Reason, State
from daemon.status import Diary

POSTINST = Path(__file__).parents[2] / "systemd" / "debian" / "postinst"


@pytest.mark.parametrize(
    ("state", "reason", "draws"),
    [
        (State.DRAWING, Reason.NONE, True),
        (State.PAUSED, Reason.PERSON, True),
        (State.PAUSED, Reason.AT_THE_MACHINE, True),
        (State.DONE, Reason.NONE, False),
        (State.INTERRUPTED, Reason.POSITION_KNOWN, False),
    ],
)
def test_a_machine_draws_also_while_it_is_paused(tmp_path: Path, state: State, reason: Reason, draws: bool) -> None:
    for job in ("000001-a", "000002-b"):
        (tmp_path / "jobs" / job).mkdir(parents=True)
    with closing(Diary(tmp_path, tmp_path / "jobs")) as diary:
        diary.say("told", job="000001-a", state=state.value, reason=reason.value)
        diary.say("drawing and paused are words of it", job="000002-b", state="queued")
    linedrawd = tmp_path / "linedrawd"
    linedrawd.write_text(f'#!/bin/sh\nexec {sys.executable} -m daemon.cli "$@" --state-dir {tmp_path}\n')
    linedrawd.chmod(0o755)
    (function,) = re.findall(r"^draws\(\) \{.*?^\}", POSTINST.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    path = {"PATH": f"{tmp_path}:{os.environ['PATH']}"}
    said = subprocess.run(["sh", "-c", f"{function}\ndraws"], env=os.environ | path, check=False)
    assert (said.returncode == 0) is draws
