"""How good a network is: `python -m training.evaluate --data FILES [--model ONNX|CHECKPOINT] [--limit N] [--json]`.

On the reference rendering (training/render.py). Pooled IoU over the three classes and their mean, the per-image mean
beside it, corners found (a component of the corners channel whose centroid lies within 2 px of a true corner), and the
mean IoU of each category. Without --model the paper's network is measured, on pictures the product's. An ONNX file
needs no PyTorch.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.vision.segmenter import MODELS, load_manifest, open_model
from training import quickdraw
from training.canvas import Canvases
from training.measure import CLASSES, Confusion
from training.pictures import corners_of
from training.render import CORNERS, UNSURE, Sample, reference

Label = NDArray[np.uint8]
FOUND_WITHIN_PX = 2.0
CURVED_SEED = 20
_BATCH = 8


@dataclass(slots=True)
class Score:
    """Everything that is counted while pages go by."""

    pooled: Confusion = field(default_factory=Confusion)
    by_word: dict[str, Confusion] = field(default_factory=dict)
    per_image: list[float] = field(default_factory=list)
    true_corners: int = 0
    said_corners: int = 0
    recalled: int = 0
    confirmed: int = 0

    def add(self, word: str, said: Label, sample: Sample) -> None:
        alone = Confusion()
        for confusion in (alone, self.pooled, self.by_word.setdefault(word, Confusion())):
            confusion.add(said, sample.label)
        self.per_image.append(alone.percent()["mean"])
        true, found = centroids(sample.label), centroids(np.where(sample.label == UNSURE, UNSURE, said))
        self.true_corners += len(true)
        self.said_corners += len(found)
        self.recalled += _near(true, found)
        self.confirmed += _near(found, true)

    def summary(self) -> dict[str, object]:
        iou = {name: round(value, 2) for name, value in self.pooled.percent().items()}
        return {
            "mean_iou": iou.pop("mean"),
            "iou": iou,
            "n": len(self.per_image),
            "per_image_mean_iou": round(float(np.mean(self.per_image)), 2),
            "corner_recall": round(100.0 * self.recalled / max(1, self.true_corners), 2),
            "corner_precision": round(100.0 * self.confirmed / max(1, self.said_corners), 2),
        }


def centroids(label: Label) -> NDArray[np.float64]:
    """(N, 2) x, y of the components of the corners channel."""
    _, _, _, centres = cv2.connectedComponentsWithStats((label == CORNERS).astype(np.uint8), connectivity=8)
    return np.asarray(centres[1:], float)


def _near(points: NDArray[np.float64], others: NDArray[np.float64]) -> int:
    if not len(points) or not len(others):
        return 0
    distance = np.hypot(*(points[:, None] - others[None]).transpose(2, 0, 1)).min(axis=1)
    return int((distance <= FOUND_WITHIN_PX).sum())


def evaluate(label_of: Callable[[NDArray[np.float32]], Label], pages: Iterator[tuple[str, Sample]]) -> Score:
    """label_of: ink float32 (N, S, S) in 0..1 -> label uint8 (N, S, S)."""
    score = Score()
    for batch in _batches(pages):
        said = label_of(np.stack([s.ink for _, s in batch]).astype(np.float32) / 255.0)
        for (word, sample), answer in zip(batch, said, strict=True):
            score.add(word, answer, sample)
        print(f"\r{len(score.per_image)} pages, {score.pooled.percent()['mean']:.2f} %", end="", file=sys.stderr)
    print(file=sys.stderr)
    return score


def _batches(pages: Iterator[tuple[str, Sample]]) -> Iterator[list[tuple[str, Sample]]]:
    batch = []
    for page in pages:
        batch.append(page)
        if len(batch) == _BATCH:
            yield batch
            batch = []
    if batch:
        yield batch


def labeller(model: Path, *, threads: int) -> Callable[[NDArray[np.float32]], Label]:
    """Of an ONNX file, or of a checkpoint (which needs PyTorch)."""
    if model.suffix == ".onnx":
        session = open_model(model, threads=threads)
        return lambda ink: session.run(None, {"ink": ink[:, None]})[0].argmax(axis=1).astype(np.uint8)
    import torch  # noqa: PLC0415  an ONNX file must not need it

    from training.export import load  # noqa: PLC0415

    torch.set_num_threads(threads)
    net = load(model)

    def label_of(ink: NDArray[np.float32]) -> Label:
        with torch.inference_mode():
            answer: Label = net(torch.from_numpy(ink[:, None])).argmax(dim=1).byte().numpy()
        return answer

    return label_of


def reference_pages(files: Sequence[Path], limit: int | None) -> Iterator[tuple[str, Sample]]:
    sketches = quickdraw.read(files, limit=limit)
    return ((word, reference(sketches[k])) for k, word in enumerate(sketches.words))


def curved_pages(files: Sequence[Path], limit: int | None, *, worn: float) -> Iterator[tuple[str, Sample]]:
    """Smooth curves 1 to 6 px wide (training/canvas.py), as many as there are rows."""
    raw = quickdraw.read(files, limit=limit)
    canvases = Canvases(raw, raw, seed=CURVED_SEED, worn=worn)
    return ((word, canvases.sample(k, curved=1.0)) for k, word in enumerate(raw.words))


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--model", type=Path, help="an .onnx file or a checkpoint; default: of the shipped two the one for that"
    )
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--data", type=Path, nargs="+", help="Quick, Draw! ndjson, simplified form")
    what.add_argument("--pictures", type=Path, nargs="+", help="any pictures: the largest patch painted as a corner")
    parser.add_argument("--raw", type=Path, nargs="+", help="raw form: curved pages are measured too, clean and worn")
    parser.add_argument("--limit", type=int, help="only the first N rows")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--json", action="store_true", help="only one line of JSON on stdout")
    parser.add_argument("--manifest", action="store_true", help="keep the figures in the manifest beside the model")
    given = parser.parse_args(arguments)
    model = given.model or MODELS / load_manifest("linedrawd" if given.pictures else "paper").file
    label_of = labeller(model, threads=given.threads)
    if given.pictures:
        print_corners(given.pictures, label_of)
        return 0
    score = evaluate(label_of, reference_pages(given.data, given.limit))
    if not given.json:
        print_table(score)
    summary = score.summary()
    for name, worn in (("curved", 0.0), ("worn", 1.0)) if given.raw else ():
        summary[name] = evaluate(label_of, curved_pages(given.raw, given.limit, worn=worn)).summary()
    if given.manifest:
        keep_figures(model.with_suffix(".json"), summary, given)
    print(json.dumps(summary))
    return 0


def keep_figures(manifest: Path, summary: dict[str, object], given: argparse.Namespace) -> None:
    """Write the summary into the manifest, with the command that gives it again."""
    options = [("--data", given.data), ("--raw", given.raw or ())]
    words = [word for option, files in options if files for word in (option, *(file.name for file in files))]
    words = ["--model", given.model.as_posix(), *words] if given.model else words
    words += ["--limit", str(given.limit)] if given.limit else []
    values = json.loads(manifest.read_text())
    values["figures"] = {"command": " ".join(["python -m training.evaluate", *words]), **summary}
    manifest.write_text(json.dumps(values, indent=1) + "\n")


def print_corners(pictures: Sequence[Path], label_of: Callable[[NDArray[np.float32]], Label]) -> None:
    """Components of the corners channel of each picture and the largest one's pixels at 3 px line width."""
    print(f"{'picture':24} {'line px':>8} {'corners':>8} {'largest px':>11}")
    for picture in pictures:
        found = corners_of(picture, label_of)
        print(f"{found.name:24} {found.line_width_px:8.2f} {found.components:8} {found.largest_px:11.0f}")


def print_table(score: Score) -> None:
    print(f"{'category':24} {'mean':>7} " + " ".join(f"{name:>10}" for name in CLASSES))
    for word, confusion in sorted(score.by_word.items(), key=lambda item: item[1].percent()["mean"]):
        iou = confusion.percent()
        print(f"{word:24} {iou['mean']:7.2f} " + " ".join(f"{iou[name]:10.2f}" for name in CLASSES))


if __name__ == "__main__":
    raise SystemExit(main())
