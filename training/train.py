"""Train a network: `python -m training.train --data DIR --net 7,3,4,3 --loss mwx --out runs/NAME [--resume]`.

The budget is seconds or images. The learning rate warms up, stays, and falls to nothing over the last part (so that a
run can go on from before the fall); the weights that are kept are an exponential moving average. A checkpoint is
written every few minutes and on SIGTERM or Ctrl-C; --resume goes on in the same order of canvases with the same state
of the optimiser.
"""

from __future__ import annotations

import argparse
import json
import signal
import time
from collections.abc import Callable, Sequence
from dataclasses import fields
from pathlib import Path

import torch
from tqdm import tqdm

from training import quickdraw
from training.canvas import Canvases, Source
from training.feed import feed
from training.network import Shape
from training.plot import draw_run
from training.render import Sample, reference
from training.run import Config, Run

HELD_OUT = 1000
"""The first rows of the training files are the validation set; they are never trained on."""


_KINDS: dict[str, type] = {"start": str, "seconds": float, "images": int}
"""Types of the options that are unset by default."""


def train(
    run: Run,
    canvases: Source,
    sets: dict[str, list[Sample]],
    *,
    save_every_s: float,
    stop: Callable[[], bool],
    workers: int = 0,
) -> None:
    """Until the budget is spent or `stop()` says so; validates and saves every save_every_s seconds and at the end."""
    config, saved = run.config, time.monotonic()
    bar = tqdm(total=config.images, initial=run.progress.images, unit="image", smoothing=0.02, mininterval=1.0)
    loss, shown = 0.0, {}
    batches = feed(config, canvases, begin=run.progress.batches, workers=workers)
    while run.progress.share(config) < 1.0 and not stop():
        began = time.monotonic()
        batch = next(batches)
        loss += 0.02 * (run.step(batch) - loss)
        run.progress.seconds += time.monotonic() - began
        bar.update(len(batch.ink))
        bar.set_postfix(loss=f"{loss:.4f}", at=f"{run.progress.share(config):.0%}", **shown, refresh=False)
        if time.monotonic() - saved > save_every_s:
            shown = _validated(run, canvases, sets)
            saved = time.monotonic()
    bar.close()
    _validated(run, canvases, sets)


def _validated(run: Run, canvases: Source, sets: dict[str, list[Sample]]) -> dict[str, str]:
    settled = run.settle(canvases)
    figures = run.validate(settled, sets)
    run.save(settled)
    draw_run(run.progress.history, run.folder / "curves.png")
    shown = {name: f"{figures[f'{name}_mean']:.2f}" for name in sets}
    tqdm.write(json.dumps({k: round(v, 2) for k, v in figures.items()}))
    return shown


def validation_sets(config: Config) -> dict[str, list[Sample]]:
    """`paper`: reference renderings of held-out simplified sketches; `curved`: canvases of held-out raw ones."""
    count = config.validation
    held = quickdraw.read([Path(config.data)], limit=count)
    sets = {"paper": [reference(held[k]) for k in range(len(held))]}
    if config.raw:
        raw = quickdraw.read([Path(config.raw)], limit=HELD_OUT)
        canvases = Canvases(raw, raw, seed=12345)
        sets["curved"] = [canvases.sample(k, curved=1.0) for k in range(count // 2)]
    return sets


def parse(arguments: Sequence[str] | None = None) -> tuple[Config, argparse.Namespace]:
    """Command line to what the run depends on, and the rest: where, and how it is carried out."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", required=True, help="simplified Quick, Draw! ndjson: a file or a folder")
    parser.add_argument("--raw", help="raw Quick, Draw! ndjson: a file or a folder; without it only the paper's family")
    parser.add_argument("--net", default="7,3,4,3", help="k1,k2,d,r")
    parser.add_argument("--channels", default="16,32,64,96,128", help="widths of the d + 1 levels")
    parser.add_argument("--no-batch-norm", action="store_true", help="as in the paper")
    parser.add_argument("--out", required=True, type=Path, help="folder of the run")
    parser.add_argument("--resume", action="store_true", help="go on from the folder's checkpoint")
    parser.add_argument("--save-every-s", type=float, default=240.0)
    parser.add_argument("--stop-after-s", type=float, help="stop then, wherever the budget stands; --resume goes on")
    parser.add_argument("--workers", type=int, default=0, help="processes that draw canvases ahead, for a GPU")
    parser.add_argument("--no-bf16", action="store_true")
    for option in fields(Config):
        if option.name not in ("data", "raw", "shape", "bf16"):
            kind = _KINDS.get(option.name) or type(option.default)
            parser.add_argument(f"--{option.name.replace('_', '-')}", type=kind, default=option.default)
    given = parser.parse_args(arguments)
    k1, k2, d, r = (int(value) for value in given.net.split(","))
    shape = Shape(k1, k2, d, r, tuple(int(value) for value in given.channels.split(",")), not given.no_batch_norm)
    options = {o.name: getattr(given, o.name) for o in fields(Config) if o.name not in ("shape", "bf16")}
    return Config(shape=shape, bf16=not given.no_bf16, **options), given


def main(arguments: Sequence[str] | None = None) -> int:
    began_s = time.monotonic()
    config, given = parse(arguments)
    if config.threads:
        torch.set_num_threads(config.threads)
    stopped: list[int] = []
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda n, _frame: stopped.append(n))
    run = Run(config, given.out)
    if given.resume:
        run.load()
    simplified = quickdraw.read([Path(config.data)], skip=HELD_OUT)
    raw = quickdraw.read([Path(config.raw)], skip=HELD_OUT) if config.raw else None
    canvases = Canvases(simplified, raw, seed=config.seed)

    def stop() -> bool:
        late = given.stop_after_s is not None and time.monotonic() - began_s > given.stop_after_s
        return late or bool(stopped)

    sets = validation_sets(config)
    train(run, canvases, sets, save_every_s=given.save_every_s, stop=stop, workers=given.workers)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
