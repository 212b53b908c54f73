"""Kill everything that can be killed, at random moments: `python -m tests.torture [N] [--seed SEED]`.

The last line is `kills N, lost 0, doubled 0, wrong prefix 0`. The exit code is 1 when anything was found, and the
folder is then kept. The same SEED does the same things at the same moments, as far as processes ever do.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
from pathlib import Path

from tests.torture.torture import Torture


def say(words: str) -> None:
    print(words, flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.torture", description=__doc__.splitlines()[0])
    parser.add_argument("kills", type=int, nargs="?", default=200, metavar="N")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, metavar="K", help="begin with this kill of the seed, from 0")
    parser.add_argument("--machines", type=int, default=1, choices=[1, 2], help="in the one daemon")
    parser.add_argument("--whole", action="store_true", help="plan with the network too, which takes longer")
    options = parser.parse_args()
    folder = Path(tempfile.mkdtemp(prefix="torture-"))
    with Torture(folder, options.seed, say=say, whole=options.whole, machines=options.machines) as torture:
        torture.run(options.kills, first=options.first)
        found = torture.checks.found
    for words in (*found.lost.values(), *found.doubled.values(), *found.wrong_prefix.values(), *found.other.values()):
        print(words)
    if found.count:
        print(f"seed {options.seed}: what was found lies in {folder}")
    else:
        shutil.rmtree(folder)
    print(found.last_line(options.kills))
    return 1 if found.count else 0


if __name__ == "__main__":
    sys.exit(main())
