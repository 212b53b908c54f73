"""`linedrawd models`: the shipped network, its manifest and how well it was measured to read."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import daemon.models
from daemon.errors import LinedrawError


def add_parser(subparsers: Any) -> None:
    words = "the shipped network and its measured accuracy"
    parser = subparsers.add_parser(
        "models",
        help=words,
        description=words[0].upper() + words[1:] + ".",
        epilog="example:\n  linedrawd models | grep -A 9 figures",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    manifests = sorted(Path(daemon.models.__file__).parent.glob("*.json"))
    if not manifests:
        raise LinedrawError("no network is shipped with this installation: install linedrawd again")
    for manifest in manifests:
        print(manifest.stem)
        for line in _lines(json.loads(manifest.read_text(encoding="utf-8")), "  "):
            print(line)
    return 0


def _lines(value: dict[str, Any], indent: str) -> Iterator[str]:
    for key, each in value.items():
        if isinstance(each, dict):
            yield f"{indent}{key}:"
            yield from _lines(each, indent + "  ")
        else:
            yield f"{indent}{key}: {', '.join(map(str, each)) if isinstance(each, list) else each}"
