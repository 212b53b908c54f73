"""Runs the sets that are asked for through linedrawd, other tracers beside it, and prints their figures."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path

import cv2

from daemon.report import canvas
from daemon.shapes import Points
from tests.benchmarks.fidelity import peers, table, travel
from tests.benchmarks.fidelity.bars import Scored
from tests.benchmarks.fidelity.curves import curves
from tests.benchmarks.fidelity.dashes import dashes
from tests.benchmarks.fidelity.known import Known
from tests.benchmarks.fidelity.measure import measure
from tests.benchmarks.fidelity.ours import Understood, explained, understood
from tests.benchmarks.fidelity.overdrawn import apart, overdrawn
from tests.benchmarks.fidelity.overlay import overlay
from tests.benchmarks.fidelity.photographed import hard_photos, photos
from tests.benchmarks.fidelity.scanned import scans
from tests.benchmarks.fidelity.sketches import SKETCHES, sketches
from tests.benchmarks.fidelity.technical import technical

SETS = (
    "quickdraw",
    "scribbles",
    "curves",
    "technical",
    "photo",
    "hard photo",
    "scan",
    "overdrawn",
    "apart",
    "dashes",
    "order",
)
OWN: dict[str, Callable[[], list[Known]]] = {
    "curves": curves,
    "technical": technical,
    "photo": photos,
    "hard photo": hard_photos,
    "scan": scans,
    "overdrawn": overdrawn,
    "apart": apart,
    "dashes": dashes,
}


def main() -> None:
    cv2.setNumThreads(1)
    wanted = options()
    kept: dict[str, object] = {}
    for name, (head, drawings) in chosen(wanted).items():
        tools = {table.OURS: scored(drawings, wanted.worst, wanted.folder / name)}
        tools |= beside(drawings) if wanted.peers else {}
        table.show(name, head, tools)
        kept[name] = {tool: [asdict(score) for score in scores] for tool, scores in tools.items()}
    if "order" in (wanted.set or SETS):
        kept["order"] = travel.show(wanted.quickdraw)
    if wanted.json:
        wanted.json.write_text(json.dumps(kept, indent=1, default=asdict))


def options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.benchmarks.fidelity", description=__doc__)
    parser.add_argument("--quickdraw", type=Path, metavar="FILE", help="ndjson of Quick, Draw!, plain or .gz")
    parser.add_argument("--set", choices=SETS, action="append", help="only this set (may be given more than once)")
    parser.add_argument("--limit", type=int, default=None, metavar="N", help="only the first N drawings of each set")
    parser.add_argument("--peers", action="store_true", help="other tracers side by side, needs make peers")
    parser.add_argument("--worst", type=int, default=0, metavar="N", help="pictures of the worst N of each set")
    parser.add_argument("--folder", type=Path, default=Path("fidelity"), help="where those pictures go")
    parser.add_argument("--json", type=Path, metavar="FILE", help="every figure of every drawing")
    return parser.parse_args()


def chosen(wanted: argparse.Namespace) -> dict[str, tuple[str, list[Known]]]:
    """The sets that are asked for and that there are drawings of, each with a few words about it."""
    names = wanted.set or SETS
    found = from_quickdraw(wanted) if {"quickdraw", "scribbles"} & set(names) else {}
    for name, drawings in OWN.items():
        if name in names:
            some = drawings()[: wanted.limit]
            found[name] = f"{len(some)} drawings of {some[0].side_px} px", some
    return {name: value for name, value in found.items() if name in names and value[1]}


def from_quickdraw(wanted: argparse.Namespace) -> dict[str, tuple[str, list[Known]]]:
    if wanted.quickdraw is None:
        print("quickdraw, scribbles: left out, name a file of sketches (QUICKDRAW=FILE or --quickdraw FILE)\n")
        return {}
    try:
        resolved, scribbles = sketches(wanted.quickdraw, limit=wanted.limit or SKETCHES)
    except (OSError, ValueError) as error:
        raise SystemExit(f"no sketches to measure with: {error}") from error
    every = len(resolved) + len(scribbles)
    return {
        "quickdraw": (f"{len(resolved)} of {every} sketches resolve ({len(resolved) / every:.1%}), 256 px", resolved),
        "scribbles": (f"the {len(scribbles)} of {every} sketches that do not resolve, 256 px", scribbles),
    }


def scored(drawings: list[Known], worst: int, folder: Path) -> list[Scored]:
    """The scores of all drawings; pictures of the worst by F1 go into the folder."""
    understood(drawings[0].grey)  # Loads the network and warms what is slow once.
    seen = [understood(known.grey) for known in drawings]
    scores = [
        Scored(known.name, measure(known, each.strokes), each.cpu_ms, each.network_cpu_ms)
        for known, each in zip(drawings, seen, strict=True)
    ]
    ranked = sorted(zip(scores, drawings, seen, strict=True), key=lambda row: row[0].measure.f1)
    for rank, (_, known, each) in enumerate(ranked[:worst], start=1):
        show_how(known, each, folder / f"{rank:02} {known.name}")
    return scores


def show_how(known: Known, seen: Understood, path: Path) -> None:
    """Two pictures of one drawing: the job's explain picture, and what was drawn over what is true."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.with_name(path.name + " explain.png").write_bytes(explained(seen, known.name))
    path.with_name(path.name + " truth.png").write_bytes(canvas.png(overlay(known, seen.strokes)))


def beside(drawings: list[Known]) -> dict[str, list[Scored]]:
    """The scores of the other tracers on the same drawings, and of their strokes merged and sorted by vpype."""
    if not peers.installed():
        print("the other tracers are left out: make peers\n")
        return {}
    pictures, found = {known.name: known.grey for known in drawings}, {}
    for tool in peers.TRACERS:
        traced = peers.traced(tool, pictures)
        merged = peers.vpype({name: lines for name, (lines, _) in traced.items()}, tolerance_px=1.5)
        found[tool] = [compared(known, *traced[known.name]) for known in drawings]
        found[f"{tool} + vpype"] = [
            compared(known, merged[known.name]["linesort"], traced[known.name][1]) for known in drawings
        ]
    return found


def compared(known: Known, strokes: list[Points], cpu_ms: float) -> Scored:
    return Scored(known.name, measure(known, strokes), cpu_ms)
