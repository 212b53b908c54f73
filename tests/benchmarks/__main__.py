"""Every benchmark, one after the other: `python -m tests.benchmarks [stages] [arcs] [streaming] [memory] ...`."""

from __future__ import annotations

import os
import sys

# One thread, as on the board; the libraries look at this once, when they are imported.
os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "ORT_DISABLE_TELEMETRY": "1"}


def main() -> None:
    from tests.benchmarks import (  # noqa: PLC0415
        arcs,
        dobot,
        done,
        jitter,
        latency,
        memory,
        sheets,
        stages,
        streaming,
        upkeep,
    )

    known = {
        "stages": stages.show,
        "arcs": arcs.show,
        "streaming": streaming.show,
        "dobot": dobot.show,
        "done": done.show,
        "memory": memory.show,
        "sheets": sheets.show,
        "latency": latency.show,
        "jitter": jitter.show,
        "upkeep": upkeep.show,
    }
    wanted = sys.argv[1:] or list(known)
    if unknown := set(wanted) - known.keys():
        raise SystemExit(f"no benchmark is called {', '.join(sorted(unknown))}: choose from {', '.join(known)}")
    for name in wanted:
        known[name]()
        print(flush=True)


if __name__ == "__main__":
    main()
