"""The batches of a run, one after the other, made in this process or ahead of time by others."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

from torch.utils.data import DataLoader, Dataset

from training.canvas import Batch, Source
from training.run import Config


def place_of(config: Config, number: int) -> tuple[int, int, int | None]:
    """Batch `number` of a run, from 0: its first canvas, how many there are, and their side where they are wide ones.

    Every wide_every-th batch is one of fewer, larger canvases, so that the network knows pages of more than one size.
    """
    many, few = config.batch, max(1, config.batch // 2)
    wide = number // config.wide_every if config.wide_every else 0
    first = (number - wide) * many + wide * few
    if config.wide_every and (number + 1) % config.wide_every == 0:
        return first, few, config.wide_px
    return first, many, None


class _Batches(Dataset[Batch]):
    def __init__(self, config: Config, source: Source) -> None:
        self._config, self._source = config, source

    def __getitem__(self, number: int) -> Batch:
        first, count, side_px = place_of(self._config, number)
        size = {} if side_px is None else {"canvas_px": side_px}
        return self._source.batch(first, count, curved=self._config.curved, **size)


def feed(config: Config, source: Source, *, begin: int, workers: int = 0) -> Iterator[Batch]:
    """Endless, from batch `begin` on. With workers, processes render ahead for a device that learns faster than one
    core draws; the batches are the same."""
    loader = DataLoader(
        _Batches(config, source),
        batch_size=None,
        sampler=itertools.count(begin),  # type: ignore[arg-type]  # any iterable of indices
        collate_fn=_as_it_is,
        num_workers=workers,
        prefetch_factor=4 if workers else None,
    )
    return iter(loader)


def _as_it_is(batch: Batch) -> Batch:
    return batch
