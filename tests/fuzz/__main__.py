"""Feed random bytes to the parsers for a while.

    python -m tests.fuzz [TARGET...] [--seconds S] [--bytes N] [--inputs FOLDER]

Each target runs in a process of its own until it has had S seconds or N bytes. A crash or a hang is printed with its
traceback, its input is kept in FOLDER, and the exit code is 1. Needs atheris (`make fuzz` installs it).
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

HANGS_AFTER_S = 20
LONGEST_BYTES = 4096
_INSIDE = "LINEDRAWD_FUZZ_INSIDE"


def main(arguments: Sequence[str] | None = None) -> int:
    """0 when every target has taken its bytes."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__.splitlines()[0])
    parser.add_argument("targets", nargs="*", metavar="TARGET", help="default: all")
    parser.add_argument("--seconds", type=float, default=60.0, help="for each target, at most (60)")
    parser.add_argument("--bytes", type=float, default=1e7, help="for each target, at most (1e7)")
    parser.add_argument("--inputs", type=Path, default=Path("fuzz"), help="where inputs that break something are kept")
    options = parser.parse_args(arguments)
    if corpus := os.environ.get(_INSIDE):
        return _take_bytes(options.targets[0], options.seconds, options.bytes, options.inputs, Path(corpus))
    from tests.fuzz.targets import TARGETS  # noqa: PLC0415

    if strange := set(options.targets) - TARGETS.keys():
        parser.error(f"there is no target {', '.join(strange)}: name some of {', '.join(TARGETS)}")
    passed = [_in_a_process(name, options) for name in options.targets or TARGETS]
    print(f"{sum(passed)} of {len(passed)} targets took their bytes without a crash or a hang")
    return 0 if all(passed) else 1


def _in_a_process(name: str, options: argparse.Namespace) -> bool:
    limits = ["--seconds", str(options.seconds), "--bytes", str(options.bytes), "--inputs", str(options.inputs)]
    with tempfile.TemporaryDirectory() as corpus:
        inside = os.environ | {_INSIDE: corpus}
        command = [sys.executable, "-m", "tests.fuzz", name, *limits]
        ran = subprocess.run(command, check=False, env=inside, stderr=subprocess.PIPE)
    if ran.returncode:
        print(f"{name}: exit code {ran.returncode}\n{ran.stderr.decode(errors='replace')[-4000:]}", flush=True)
    return ran.returncode == 0


def _take_bytes(name: str, seconds: float, most_bytes: float, inputs: Path, corpus: Path) -> int:
    """Never returns in the good case: libFuzzer has no other end."""
    import atheris  # noqa: PLC0415

    with atheris.instrument_imports(include=["firmware_protocol", "daemon.control", "daemon.program"]):
        from tests.fuzz.targets import ALLOWED, TARGETS  # noqa: PLC0415

    target, began_s = TARGETS[name], time.monotonic()
    taken = inputs_taken = 0

    def take(data: bytes) -> None:
        nonlocal taken, inputs_taken
        with suppress(ALLOWED):
            target.take(data)
        taken, inputs_taken = taken + len(data), inputs_taken + 1
        took_s = time.monotonic() - began_s
        if taken >= most_bytes or took_s >= seconds:
            print(f"{name:16}{taken:>12,} bytes in {inputs_taken:>8,} inputs, {took_s:6.1f} s", flush=True)
            os._exit(0)

    inputs.mkdir(parents=True, exist_ok=True)
    for number, seed in enumerate(target.seeds()):
        (corpus / str(number)).write_bytes(seed[:LONGEST_BYTES])
    limits = [f"-max_len={LONGEST_BYTES}", "-len_control=0", f"-timeout={HANGS_AFTER_S}", "-rss_limit_mb=2048"]
    kept = f"-artifact_prefix={inputs}/{name.replace(' ', '-')}-"
    atheris.Setup([sys.argv[0], str(corpus), kept, "-verbosity=0", *limits], take)
    atheris.Fuzz()
    return 1


if __name__ == "__main__":
    raise SystemExit(main())
