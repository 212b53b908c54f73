"""Reading ndjson: both forms, both packings, and rows that are no drawing."""

import gzip
import json
from pathlib import Path

import numpy as np
import pytest

from training import quickdraw


def row(word: str, *strokes: list[list[float]]) -> str:
    return json.dumps({"word": word, "drawing": list(strokes)})


GOOD = [
    row("cat", [[0, 10, 20], [0, 5, 0]], [[1, 2], [3, 4]]),
    row("cat", [[0, 9], [0, 9]]),
    row("bus", [[0, 1], [2, 3]]),
]


def test_strokes_come_back_as_they_were(tmp_path: Path) -> None:
    (tmp_path / "a.ndjson").write_text("\n".join(GOOD))
    sketches = quickdraw.read([tmp_path / "a.ndjson"])
    first, second = sketches[0]
    assert first.tolist() == [[0, 0], [10, 5], [20, 0]]
    assert second.tolist() == [[1, 3], [2, 4]]
    assert sketches.words == ("cat", "cat", "bus")


def test_raw_rows_carry_a_third_list_of_times(tmp_path: Path) -> None:
    (tmp_path / "a.ndjson").write_text(row("cat", [[0.5, 9.5], [0, 9], [0, 40]]))
    assert quickdraw.read([tmp_path / "a.ndjson"])[0][0].tolist() == [[0.5, 0], [9.5, 9]]


def test_a_folder_of_plain_and_packed_files(tmp_path: Path) -> None:
    (tmp_path / "a.ndjson").write_text("\n".join(GOOD))
    with gzip.open(tmp_path / "b.ndjson.gz", "wt") as packed:
        packed.write("\n".join(GOOD))
    assert len(quickdraw.read([tmp_path])) == 6
    assert len(quickdraw.read([tmp_path], skip=2, limit=3)) == 3


def test_bad_rows_are_counted_and_skipped(tmp_path: Path) -> None:
    bad = [
        "",
        "{",
        row("cat"),
        row("cat", [[0, 0], [0, 0]]),
        '{"word": "cat"}',
        row("cat", [[0, float("nan")], [0, 1]]),
    ]
    (tmp_path / "a.ndjson").write_text("\n".join([*bad, *GOOD]))
    sketches = quickdraw.read([tmp_path / "a.ndjson"])
    assert (len(sketches), sketches.bad_rows) == (3, len(bad))


def test_nothing_readable_says_so(tmp_path: Path) -> None:
    (tmp_path / "a.ndjson").write_text("hello\n")
    with pytest.raises(ValueError, match="1 bad rows"):
        quickdraw.read([tmp_path / "a.ndjson"])
    with pytest.raises(FileNotFoundError, match=r"no \.ndjson"):
        quickdraw.read([tmp_path / "nowhere"])


def test_a_category_without_a_row_is_named(tmp_path: Path) -> None:
    """A folder of Google's files, one a category: a truncated or empty-handed one must not vanish in the rest."""
    (tmp_path / "cat.ndjson").write_text("\n".join(GOOD))
    (tmp_path / "owl.ndjson").write_text("<html>not found</html>\n")
    with pytest.raises(ValueError, match=r"no readable sketch in owl\.ndjson"):
        quickdraw.read([tmp_path])


def test_dense_sketches_are_drawn_more_often(tmp_path: Path) -> None:
    (tmp_path / "a.ndjson").write_text(
        "\n".join([row("cat", [[0, 9], [0, 9]]), row("cat", [[*range(8)], [*range(8)]])])
    )
    weights = quickdraw.read([tmp_path / "a.ndjson"]).sampling_weights(dense=0.5)
    assert weights[1] == pytest.approx(2 * weights[0])


def test_rare_categories_are_drawn_more_often_than_their_share(tmp_path: Path) -> None:
    (tmp_path / "a.ndjson").write_text("\n".join([*GOOD[:2] * 8, GOOD[2]]))
    weights = quickdraw.read([tmp_path / "a.ndjson"]).sampling_weights()
    assert weights.sum() == pytest.approx(1.0)
    assert weights[-1] == pytest.approx(1 / (1 + np.sqrt(16)))
