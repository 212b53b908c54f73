"""The paper's table of five networks, trained under one budget: `python -m training.compare [--run ...]`.

Without --run it prints the table of docs/compare/results.json beside the paper's own figures and keeps it, with where
the order agrees and the curves of validation IoU and loss, as docs/compare/README.md. With --run it trains what that
file does not hold yet, one network after the other, as the paper does it: RMSProp 0.9, no normalisation, each sketch
drawn once at 188 px and padded with white to the network's next legal size; and all of it again with BatchNorm. Test
figures: pooled mean IoU of the reference rendering.
"""

from __future__ import annotations

import argparse
import itertools
import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch

from training import quickdraw
from training.canvas import Batch, stack
from training.network import Shape, legal_size_px
from training.quickdraw import Sketches
from training.render import CANVAS_PX, Sample, reference
from training.run import Config, Run
from training.train import HELD_OUT, train

_FAT = "Corner pixels painted, in percent of the true ones: "
_README = """# The paper's five networks under one budget

Made by `python -m training.compare` from results.json; `--run --data FILE --test FILE` trains what that file lacks.

{table}

Pooled mean IoU in percent of background, lines and corners on the first {n:,} sketches of the test split, reference
rendering. Every network saw the same sketches once, in the same order: RMSProp 0.9, cross-entropy weights with the
square root of the inverse class frequency, weights begun as He et al. do, rate 3e-3 rising over the first and falling
over the last part. The paper states neither its budget nor these.

{order}

![Validation IoU over images](iou.png)

![Validation cross-entropy over images](loss.png)

## What weighing by the greater label changes

The same network, (7 3 4 3) without normalisation, taught by weighted cross-entropy and by MWX; corners are red.

![Page, truth, XENT, MWX](crop.png)

{fat}

The threshold study of Sec. 5.3 is in [thresholds.md](thresholds.md).
"""

RESULTS = Path("docs/compare/results.json")
FIVE, FOUR = (8, 16, 32, 64, 128), (8, 16, 32, 64)


@dataclass(frozen=True, slots=True)
class Entry:
    """A row of the paper's Table 1."""

    name: str
    loss: str
    shape: Shape
    paper_iou: float


TABLE = (
    Entry("(7 3 4 3)", "mwx", Shape(7, 3, 4, 3, FIVE), 98.02),
    Entry("(9 3 4 2)", "mwx", Shape(9, 3, 4, 2, FIVE), 91.24),
    Entry("(7 3 4 3)", "xent", Shape(7, 3, 4, 3, FIVE), 92.57),
    Entry("(9 3 3 2)", "xent", Shape(9, 3, 3, 2, FOUR), 75.09),
    Entry("vanilla", "xent", Shape(3, 3, 4, 2, FIVE, vanilla=True), 94.23),
)


_CROP = {"XENT": "(7 3 4 3) xent", "MWX": "(7 3 4 3) mwx"}
"""The networks whose answers are shown side by side."""


class Pages:
    """Reference renderings, each sketch once, in the order of the file; stands where `Canvases` does."""

    def __init__(self, sketches: Sketches, size_px: int) -> None:
        self._sketches, self._size_px = sketches, size_px

    def batch(self, first: int, count: int, *, curved: float = 0.0, canvas_px: int = CANVAS_PX) -> Batch:
        return stack([self.page((first + k) % len(self._sketches)) for k in range(count)])

    def page(self, index: int) -> Sample:
        return padded(reference(self._sketches[index]), self._size_px)


def padded(sample: Sample, size_px: int) -> Sample:
    """White paper to the right and below, up to size_px."""
    by = ((0, size_px - len(sample.ink)),) * 2
    return Sample(np.pad(sample.ink, by), np.pad(sample.label, by))


def key_of(entry: Entry, batch_norm: bool) -> str:
    return f"{entry.name} {entry.loss}{' BatchNorm' if batch_norm else ''}"


def train_one(entry: Entry, batch_norm: bool, given: argparse.Namespace) -> dict[str, Any]:
    """Train one network of the table and measure it on the test file."""
    shape = replace(entry.shape, batch_norm=batch_norm)
    size_px = legal_size_px(shape, CANVAS_PX)
    config = Config(
        data=str(given.data), shape=shape, loss=entry.loss, omega_exponent=given.omega, plain_share=0.0,
        optimiser="rmsprop", learning_rate=given.learning_rate, images=given.images, wide_every=0, curved=0.0, seed=1,
        validation=given.validation, threads=given.threads,
    )  # fmt: skip
    run = Run(config, given.out / key_of(entry, batch_norm).replace(" ", "-"))
    if (run.folder / "checkpoint.pt").exists():
        run.load()
    pages = Pages(quickdraw.read([given.data], skip=HELD_OUT, limit=given.images), size_px)
    held = Pages(quickdraw.read([given.data], limit=config.validation), size_px)
    sets = {"paper": [held.page(k) for k in range(config.validation)]}
    train(run, pages, sets, save_every_s=given.every_s, stop=lambda: False)
    test = quickdraw.read([given.test], limit=given.limit)
    tested = Pages(test, size_px)
    figures = run.validate(run.settle(pages), {"test": [tested.page(k) for k in range(len(test))]})
    return {"images": run.progress.images, "n": len(test), "test": figures, "history": run.progress.history[:-1]}


def run_all(given: argparse.Namespace) -> None:
    """Every network that the results do not hold yet; the file is written after each."""
    results = read_results()
    for batch_norm in (False, True):
        for entry in TABLE:
            key = key_of(entry, batch_norm)
            if key not in results:
                print(f"== {key}")
                results[key] = train_one(entry, batch_norm, given)
                RESULTS.parent.mkdir(parents=True, exist_ok=True)
                RESULTS.write_text(json.dumps(results, indent=1) + "\n")


def read_results() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    return found


def table(results: dict[str, Any]) -> str:
    """Markdown: the paper's figure, ours without normalisation, ours with BatchNorm."""
    rows = ["| network | loss | paper | ours, as in the paper | ours, BatchNorm | images |", "|---" * 6 + "|"]
    for entry in TABLE:
        ours = [results.get(key_of(entry, norm)) for norm in (False, True)]
        said = [f"{each['test']['test_mean']:.2f}" if each else "" for each in ours]
        images = next((f"{each['images']:,}" for each in ours if each), "")
        loss = entry.loss.upper()
        rows.append(f"| {entry.name} | {loss} | {entry.paper_iou:.2f} | {said[0]} | {said[1]} | {images} |")
    return "\n".join(rows)


def order(results: dict[str, Any]) -> str:
    """Which of two networks is the better one: the pairs on which we and the paper agree, and those on which not."""
    lines = []
    for norm, said in ((False, "As in the paper"), (True, "With BatchNorm")):
        ours = {e: results[key_of(e, norm)]["test"]["test_mean"] for e in TABLE if key_of(e, norm) in results}
        pairs = list(itertools.combinations(ours, 2))
        if not pairs:
            continue
        other = [(a, b) for a, b in pairs if (a.paper_iou > b.paper_iou) != (ours[a] > ours[b])]
        against = [
            f"{key_of(a, False)} ({ours[a]:.2f}) and {key_of(b, False)} ({ours[b]:.2f})"
            for a, b in (sorted(pair, key=lambda e: -e.paper_iou) for pair in other)
        ]
        agreed = f"{said}: {len(pairs) - len(other)} of {len(pairs)} pairs of networks stand in the paper's order"
        lines.append(agreed + (f"; turned over are {', '.join(against)}." if against else "."))
    return "\n\n".join(lines)


def write_readme(results: dict[str, Any], fat: dict[str, float] | None) -> None:
    """docs/compare/README.md. fat: corner pixels of each network of the crop, where it was drawn anew."""
    readme = RESULTS.parent / "README.md"
    before = readme.read_text() if readme.exists() else ""
    kept = next((line for line in before.splitlines() if line.startswith(_FAT)), "")
    if fat:
        kept = _FAT + ", ".join(f"{name} {100 * share:.0f} %" for name, share in fat.items()) + "."
    tested = next(iter(results.values()))["n"]
    readme.write_text(_README.format(table=table(results), order=order(results), fat=kept, n=tested))


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--run", action="store_true", help="train what docs/compare/results.json does not hold yet")
    parser.add_argument("--data", type=Path, help="simplified training rows")
    parser.add_argument("--test", type=Path, help="simplified test rows")
    parser.add_argument("--limit", type=int, default=1000, help="test sketches")
    parser.add_argument("--validation", type=int, default=160, help="held-out sketches of the curves")
    parser.add_argument("--images", type=int, default=15000, help="the budget of each network")
    parser.add_argument("--learning-rate", type=float, default=3e-3)
    parser.add_argument("--omega", type=float, default=0.5, help="exponent of the class weights, 1 = inverse frequency")
    parser.add_argument("--every-s", type=float, default=60.0, help="seconds between points of the curves")
    parser.add_argument("--threads", type=int, default=0, help="0: as many as there are cores")
    parser.add_argument("--out", type=Path, default=Path("runs/compare"))
    given = parser.parse_args(arguments)
    if given.threads:
        torch.set_num_threads(given.threads)
    if given.run:
        if not (given.data and given.test):
            parser.error("--run needs --data and --test")
        run_all(given)
    results = read_results()
    print(table(results))
    if results:
        # The table needs no plotting.
        from training.plot import draw_table  # noqa: PLC0415

        fat = None
        crop_of = {name: given.out / key.replace(" ", "-") / "checkpoint.pt" for name, key in _CROP.items()}
        if results.keys() >= set(_CROP.values()) and all(path.exists() for path in crop_of.values()):
            from training.crop import draw_crop  # noqa: PLC0415

            fat = draw_crop(crop_of, RESULTS.parent / "crop.png")
        write_readme(results, fat)
        draw_table({key: each["history"] for key, each in results.items()}, RESULTS.parent)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
