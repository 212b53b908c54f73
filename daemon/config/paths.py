"""The folders and files of this computer."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from daemon.config.section import Section
from daemon.places import usual_paths

_SAID = ("state_dir", "inbox", "log_dir")


class Paths(Section):
    """Where everything lies; nothing is written anywhere else."""

    state_dir: Path
    """Jobs, journal and, unless said otherwise, everything else."""
    inbox: Path
    """Where pictures are dropped."""
    log_dir: Path
    """Where linedrawd.log is written."""
    runtime_dir: Path
    """status.json and the control socket; best in memory."""

    @property
    def jobs(self) -> Path:
        return self.state_dir / "jobs"

    @property
    def journal(self) -> Path:
        return self.state_dir / "journal.sqlite"

    @property
    def status(self) -> Path:
        return self.runtime_dir / "status.json"

    @property
    def control(self) -> Path:
        return self.runtime_dir / "control.sock"


def paths_of(given: dict[str, Any], said: Mapping[str, Path | None], environment: Mapping[str, str]) -> dict[str, Any]:
    """The section [paths], complete and absolute: `said` wins over the file (`given`), the file over the usual places.

    said: by name, what the command line says of state_dir, inbox and log_dir.
    """
    wanted = {name: said.get(name) or given.get(name) for name in _SAID}
    usual = usual_paths(environment, str(wanted["state_dir"]) if wanted["state_dir"] else None)
    paths = usual | given | {name: value for name, value in wanted.items() if value}
    paths.setdefault("inbox", f"{paths['state_dir']}/inbox")
    return {name: _absolute(value) for name, value in paths.items()}


def _absolute(value: Any) -> Any:
    return Path(value).expanduser().absolute() if isinstance(value, str | Path) else value
