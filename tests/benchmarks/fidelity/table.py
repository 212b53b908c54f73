"""The figures of a set as a table: one column a tool, the bar and its verdict beside ours."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from tests.benchmarks.fidelity.bars import BARS, FIGURES, Scored

OURS = "linedrawd"
_NAME, _FIGURE = 21, 19


def show(name: str, head: str, tools: Mapping[str, Sequence[Scored]]) -> None:
    """tools: the scores of every tool, ours among them, on the same drawings."""
    print(f"{name}: {head}")
    print(" " * _NAME + "".join(f"{tool:>{_FIGURE}}" for tool in tools) + f"{'bar':>{_FIGURE}}")
    for figure, of in FIGURES.items():
        values = {tool: of(scores) for tool, scores in tools.items()}
        print(f"{figure:{_NAME}}" + "".join(map(written, values.values())) + verdict(name, figure, values[OURS]))
    print(flush=True)


def written(value: float) -> str:
    return f"{value:>{_FIGURE}.4f}" if abs(value) < 10 else f"{value:>{_FIGURE}.1f}"


def verdict(name: str, figure: str, value: float) -> str:
    bar = BARS[name].get(figure)
    return "" if bar is None else f"{bar!s:>{_FIGURE}}  {'met' if bar.met(value) else 'MISSED'}"
