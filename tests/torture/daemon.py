"""The daemon as `linedrawd` starts it, but for the planner: `python -m tests.torture.daemon CONFIG STATE [RECORD]`."""

from __future__ import annotations

import sys
from pathlib import Path

from daemon.config import Options, load_settings
from daemon.parts import parts_of
from daemon.service import Service

PLANNER = "tests.torture.planner"


def main() -> int:
    config, state, *record = map(Path, sys.argv[1:])
    settings = load_settings(Options(config=config, state_dir=state), machine_needed=True)
    with parts_of(settings, planner=PLANNER, record=record[0] if record else None) as parts:
        service = Service(settings, parts)
        service.end_on_signals()
        return 0 if service.run() else 1


if __name__ == "__main__":
    sys.exit(main())
