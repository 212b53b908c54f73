"""One worker for the tests of a file, one bench for each test, and a power that may be cut."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from daemon.jobs.pool import Pool
from tests.daemon.jobs.bench import Bench
from tests.daemon.jobs.intake_bench import Cuts
from tests.daemon.jobs.test_pool import PLANNER, settings_with


@pytest.fixture(scope="module")
def shared_pool(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Pool]:
    pool = Pool(settings_with(tmp_path_factory.mktemp("pool")), planner=PLANNER)
    yield pool
    pool.close()


@pytest.fixture
def bench(tmp_path: Path, shared_pool: Pool) -> Iterator[Bench]:
    bench = Bench(tmp_path, pool=shared_pool)
    yield bench
    bench.journal.close()


@pytest.fixture(params=["same disk", "other disk"])
def cuts(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Cuts:
    return Cuts(monkeypatch, other_disk=request.param == "other disk")


@pytest.fixture(params=["same disk", "other disk"])
def full_disk(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Cuts:
    return Cuts(monkeypatch, other_disk=request.param == "other disk", full=True)
