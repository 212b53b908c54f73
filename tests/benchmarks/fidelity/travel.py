"""The order of strokes: lifts and pen-up length on 24 drawings and on random strokes, beside vpype and annealing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from daemon.graph.strokes import strokes
from daemon.shapes import LineGraph, Points, Stroke
from daemon.toolpath.order import Place, order
from daemon.toolpath.rejoin import rejoined
from tests.benchmarks.fidelity import peers
from tests.benchmarks.fidelity.curves import curves
from tests.benchmarks.fidelity.known import Known
from tests.benchmarks.fidelity.measure import pen_up_px
from tests.benchmarks.fidelity.planar import graph, planar
from tests.benchmarks.fidelity.sketches import sketches
from tests.benchmarks.fidelity.technical import technical

CURVES, TECHNICAL, SKETCHES = 8, 6, 10
LEAST_SAVED = 0.20
MOST_OVER_REFERENCE = 1.03
SEEDS = (1, 2, 3)
REFERENCE_MM = {
    100: (1210.6, 1313.2, 1189.0),
    300: (1929.8, 1879.2, 1883.8),
    1000: (3033.8, 3087.5, 3050.9),
}
"""Pen-up length of the random sets there and back, by annealing: `python -m tests.benchmarks.fidelity.travel`."""
_SHEET_MM = 200.0
_HOME = (0.0, 0.0)
_MERGED_PX = 0.1


@dataclass(frozen=True, slots=True)
class Ordered:
    """One drawing, cut at its junctions, its edges shuffled: lifts and pen-up px of ours and of vpype.

    Ours is ordered twice: to end anywhere, as vpype ends, and to come back.
    """

    name: str
    edges: int
    minimum: int
    lifts: int
    pen_up_px: float
    pen_up_and_back_px: float
    vpype: Mapping[str, tuple[int, float, float]]
    """Lifts, pen-up and pen-up with the way back of each of vpype's sorters; empty without the peers."""


def show(quickdraw: Path | None) -> dict[str, object]:
    """Print both tables; every figure again."""
    rows = ordered(drawings(quickdraw))
    _show_drawings(rows)
    ratios = random_ratios()
    for count, ratio in ratios.items():
        met = "met" if ratio <= MOST_OVER_REFERENCE else "MISSED"
        print(f"{count:>5} random strokes: {ratio:.4f} of the annealed length   <= {MOST_OVER_REFERENCE:g}  {met}")
    print(flush=True)
    return {"drawings": rows, "random": ratios}


def drawings(quickdraw: Path | None) -> list[Known]:
    """8 of curves, 6 technical ones and, with a file of sketches, its first ten that resolve."""
    real = sketches(quickdraw, limit=2 * SKETCHES)[0][:SKETCHES] if quickdraw else []
    return curves()[:CURVES] + technical()[:TECHNICAL] + real


def ordered(every: Sequence[Known]) -> list[Ordered]:
    graphs = [shuffled(graph(known.strokes)) for known in every]
    theirs = peers.vpype(
        {known.name: [edge.polyline for edge in cut.edges] for known, cut in zip(every, graphs, strict=True)},
        tolerance_px=_MERGED_PX,
    )
    return [_ordered(known, cut, theirs.get(known.name, {})) for known, cut in zip(every, graphs, strict=True)]


def shuffled(cut: LineGraph) -> LineGraph:
    """The edges in another order, as a tracer might find them."""
    turn = np.random.default_rng(0).permutation(len(cut.edges))
    return replace(cut, edges=tuple(cut.edges[i] for i in turn))


def _ordered(known: Known, cut: LineGraph, vpype: Mapping[str, Sequence[Points]]) -> Ordered:
    drawn = strokes(cut, width_px=known.side_px, height_px=known.side_px).strokes
    one_way, there_and_back = _tour(drawn, None), _tour(drawn, _HOME)
    theirs = {how: (len(found), pen_up_px(found), pen_up_px(found, back=True)) for how, found in vpype.items()}
    fewest = planar(known.strokes).fewest_strokes
    up_px, back_px = pen_up_px(one_way), pen_up_px(there_and_back, back=True)
    return Ordered(known.name, len(cut.edges), fewest, max(len(one_way), len(there_and_back)), up_px, back_px, theirs)


def _tour(drawn: Sequence[Stroke], end: Place | None) -> list[Points]:
    ordered = order(drawn, start_mm=_HOME, end_mm=end)
    return [stroke.points for stroke in rejoined(ordered, start_mm=_HOME, end_mm=end)]


def _show_drawings(rows: Sequence[Ordered]) -> None:
    sorters = list(rows[0].vpype)
    print(f"order: {len(rows)} drawings cut at their junctions, shuffled; pen-up px from (0, 0) on, and there and back")
    print(f"{'':20}{'edges':>7}{'minimum':>9}{'lifts':>7}{'pen-up':>9}{'and back':>10}", end="")
    print("".join(f"{'vpype ' + how:>17}{'pen-up':>9}{'and back':>10}" for how in sorters))
    for row in rows:
        print(f"{row.name:20}{row.edges:>7}{row.minimum:>9}{row.lifts:>7}", end="")
        print(f"{row.pen_up_px:>9.0f}{row.pen_up_and_back_px:>10.0f}", end="")
        print("".join(f"{lifts:>17}{up:>9.0f}{back:>10.0f}" for lifts, up, back in row.vpype.values()))
    lifts, minimum = sum(row.lifts for row in rows), sum(row.minimum for row in rows)
    print(f"lifts {lifts}, minimum {minimum}   {'met' if lifts == minimum else 'MISSED'}")
    if sorters:
        _show_verdict(rows)


def _show_verdict(rows: Sequence[Ordered]) -> None:
    for words, ours, at in (("pen-up", "pen_up_px", 1), ("pen-up and back", "pen_up_and_back_px", 2)):
        own = sum(getattr(row, ours) for row in rows)
        saved = 1 - own / sum(row.vpype["linesort"][at] for row in rows)
        above = [row.name for row in rows if getattr(row, ours) > min(v[at] for v in row.vpype.values()) + 0.5]
        print(f"{words}: {own:.0f} px, {saved:.1%} below linemerge + linesort", end="")
        print(f"   >= {LEAST_SAVED:.0%}  {'met' if saved >= LEAST_SAVED else 'MISSED'}")
        print(f"{words} above the better of vpype's two: {', '.join(above) or 'none'}", end="")
        print(f"   {'MISSED' if above else 'met'}")


def random_strokes(count: int, seed: int) -> list[Points]:
    """Strokes of 2 to 8 points anywhere on 200 x 200 mm."""
    rng = np.random.default_rng([count, seed])
    sizes = rng.integers(2, 9, count)
    starts = rng.uniform(0, _SHEET_MM, (count, 2))
    return [
        np.clip(start + np.cumsum(rng.normal(0, 4, (size, 2)), axis=0), 0, _SHEET_MM)
        for start, size in zip(starts, sizes, strict=True)
    ]


def random_ratios() -> dict[int, float]:
    """Our pen-up length, the way back among it, by the annealed one: mean over the seeds for each size."""
    return {
        count: float(np.mean([_tour_mm(count, seed) / mm for seed, mm in zip(SEEDS, lengths, strict=True)]))
        for count, lengths in REFERENCE_MM.items()
    }


def _tour_mm(count: int, seed: int) -> float:
    return pen_up_px(_tour([Stroke(points) for points in random_strokes(count, seed)], _HOME), back=True)


def main() -> None:
    """Anneal the random sets anew and print the reference; needs `make peers`."""
    for count in (100, 300, 1000):
        sets = [[[s[0].tolist(), s[-1].tolist()] for s in random_strokes(count, seed)] for seed in SEEDS]
        print(f"    {count}: ({', '.join(f'{mm:.1f}' for mm in peers.annealed(sets))}),", flush=True)


if __name__ == "__main__":
    main()
