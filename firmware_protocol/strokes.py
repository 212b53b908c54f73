"""Which strokes of a job a number of its lines covers."""

from __future__ import annotations

from collections.abc import Sequence


def strokes_before(strokes: Sequence[int | None], line: int) -> int:
    """Strokes that lie wholly before `line`. strokes: the stroke of each line, never falling."""
    return next((stroke for stroke in strokes[line:] if stroke is not None), strokes_touched(strokes, len(strokes)))


def strokes_touched(strokes: Sequence[int | None], lines: int) -> int:
    """No stroke from this number on has a line among the first `lines`."""
    for line in range(min(lines, len(strokes)) - 1, -1, -1):
        if (stroke := strokes[line]) is not None:
            return stroke + 1
    return next((stroke for stroke in strokes if stroke is not None), 0)
