"""The paper's table, in small."""

import json
from pathlib import Path

import numpy as np
import pytest

from training import compare
from training.train import HELD_OUT

pytestmark = [pytest.mark.training, pytest.mark.filterwarnings("ignore")]


def test_every_network_of_the_table_is_trained_and_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    random = np.random.default_rng(3)
    rows = [{"word": "zigzag", "drawing": [random.integers(0, 256, (2, 4)).tolist()]} for _ in range(HELD_OUT + 8)]
    data = tmp_path / "zigzags.ndjson"
    data.write_text("\n".join(map(json.dumps, rows)))
    monkeypatch.setattr(compare, "RESULTS", tmp_path / "results.json")
    monkeypatch.setattr(compare, "TABLE", compare.TABLE[3:])
    options = [
        "--data",
        str(data),
        "--test",
        str(data),
        "--limit",
        "4",
        "--images",
        "8",
        "--validation",
        "4",
        "--out",
        str(tmp_path / "r"),
        "--threads",
        "1",
    ]
    assert compare.main(["--run", *options]) == 0
    results = json.loads((tmp_path / "results.json").read_text())
    assert set(results) == {compare.key_of(entry, norm) for entry in compare.TABLE for norm in (False, True)}
    assert all(0.0 < each["test"]["test_mean"] < 100.0 and each["images"] == 8 for each in results.values())
    assert "| (9 3 3 2) | XENT | 75.09 |" in capsys.readouterr().out
    assert (tmp_path / "iou.png").stat().st_size > 1000
    readme = (tmp_path / "README.md").read_text()
    assert "| (9 3 3 2) | XENT | 75.09 |" in readme
    assert "of 1 pairs of networks" in readme


def test_pairs_that_stand_in_another_order_are_named() -> None:
    figures = dict(zip(compare.TABLE, (95.0, 91.0, 92.0, 96.0, 93.0), strict=True))
    results = {compare.key_of(entry, False): {"test": {"test_mean": iou}} for entry, iou in figures.items()}
    said = compare.order(results)
    assert "6 of 10 pairs" in said
    assert "(7 3 4 3) mwx (95.00) and (9 3 3 2) xent (96.00)" in said
