"""Where the settings and everything else lie on this computer unless somebody says otherwise."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path


def usual_file(environment: Mapping[str, str]) -> Path | None:
    """The settings file that is read when none is named, None where there is none."""
    home = environment.get("HOME", "/nonexistent")
    folders = [Path(environment.get("XDG_CONFIG_HOME") or f"{home}/.config") / "linedrawd", Path("/etc/linedrawd")]
    return next((file for folder in folders if (file := folder / "linedrawd.toml").is_file()), None)


def usual_paths(environment: Mapping[str, str], state_dir: str | None) -> dict[str, str]:
    """systemd's folders where it gave some; below a state folder somebody chose; root's; the user's own."""
    home = environment.get("HOME") or str(Path.home())
    below = state_dir or environment.get("XDG_STATE_HOME", f"{home}/.local/state") + "/linedrawd"
    paths = {"state_dir": below, "log_dir": f"{below}/log", "runtime_dir": f"{below}/run"}
    if state_dir is None and environment.get("XDG_RUNTIME_DIR"):
        paths["runtime_dir"] = environment["XDG_RUNTIME_DIR"] + "/linedrawd"
    if state_dir is None and os.geteuid() == 0:
        paths = {"state_dir": "/var/lib/linedrawd", "log_dir": "/var/log/linedrawd", "runtime_dir": "/run/linedrawd"}
    for name, variable in [("state_dir", "STATE_"), ("log_dir", "LOGS_"), ("runtime_dir", "RUNTIME_")]:
        if environment.get(f"{variable}DIRECTORY"):
            paths[name] = environment[f"{variable}DIRECTORY"].split(":")[0]
    return paths
