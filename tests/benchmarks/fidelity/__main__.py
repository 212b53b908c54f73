"""How close the strokes come: `python -m tests.benchmarks.fidelity [--quickdraw FILE] [--set NAME] [--worst N]`."""

from __future__ import annotations

import os

# One thread, as on the board; the libraries look at this once, when they are imported.
os.environ |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "ORT_DISABLE_TELEMETRY": "1"}

if __name__ == "__main__":
    from tests.benchmarks.fidelity.run import main

    main()
