"""A document that would take all memory or all time takes no more than the worker may."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest

from daemon.errors import PlanningFailed
from daemon.jobs.pool import PLANNER, Pool
from tests.daemon.intake.vector.pdfs import pdf, stream
from tests.daemon.jobs.test_pool import settings_with


def form_in_itself() -> bytes:
    """Twice in each of itself: who follows it to the depth of 40 meets it 2^40 times."""
    form = stream(
        "/F Do /F Do", "/Type /XObject /Subtype /Form /BBox [0 0 9 9] /Resources << /XObject << /F 3 0 R >> >>"
    )
    return pdf(["/F Do"], resources="/XObject << /F 3 0 R >>", more=[form])


def bomb() -> bytes:
    """Few bytes that say many more of lines than there is memory."""
    lines = zlib.compress(zlib.compress(b" " * 320_000_000, 1)).decode("latin-1")
    packed = stream(lines, "/Filter [/FlateDecode /FlateDecode]")
    return pdf([""], more=[packed]).replace(b"/Contents 5 0 R", b"/Contents 3 0 R")


@pytest.mark.parametrize("data", [form_in_itself, bomb])
def test_what_grows_without_end_ends_with_the_worker(tmp_path: Path, data: Callable[[], bytes]) -> None:
    (tmp_path / "source.pdf").write_bytes(data())
    pool = Pool(settings_with(tmp_path, time_limit_s=120.0), planner=PLANNER)
    with closing(pool), pytest.raises(PlanningFailed, match=r"was killed by|needs more than 256 MB"):
        pool.plan(tmp_path / "source.pdf", tmp_path, "plotter", progress=lambda stage: None)
