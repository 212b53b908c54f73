"""The threshold study of Raghav et al. (2020), Sec. 5.3: `python -m training.thresholds [--data FILE] [--draw]`.

Without --data it prints the tables of docs/compare/thresholds.json. With --data it measures the first --limit sketches
of a Quick, Draw! test file, the grid of tau0 and lambda on the first --grid of them, writes that file, the tables
between the marks of docs/compare/thresholds.md and the pictures; --draw makes tables and pictures again from the file.
One thread. Measured sketches are kept in runs/thresholds until the network, the graph room or the study changes.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np

import daemon.graph
from daemon.graph.feedback import Adaptation
from daemon.vision.segmenter import Segmenter, load_manifest
from training import quickdraw, thresholds_measure
from training.thresholds_measure import BETAS_PX, FIXED, MODES, RATES, ROUNDS, TAU0S, measure

FOLDER = Path("docs/compare")
CACHE = Path("runs/thresholds")
READINGS = {
    "known": "vertices of the rendering, lines between neighbouring vertices",
    "drawn": "vertices of the rendering, segments as drawn",
    "seen": "centroids of the network's corners, lines between neighbouring vertices",
}
FIGURES = ("precision", "recall", "edges", "length")
BINS = np.round(np.arange(-0.2, 1.0001, 0.02), 2)
_HEAD = {"alone": "equations alone", "paper": '`graph = "paper"`', "repaired": "repaired"}


def rows_of(data: Path, limit: int, grid: int) -> list[dict[str, Any]]:
    """What was measured on each of the first `limit` sketches; the cache is read first and written as we go."""
    sketches, segmenter = quickdraw.read([data], limit=limit), Segmenter(threads=1)
    CACHE.mkdir(parents=True, exist_ok=True)
    file = CACHE / f"{_digest(data, grid)}.jsonl"
    kept = [line for line in file.read_text().splitlines(keepends=True) if line.endswith("\n")] if file.exists() else []
    file.write_text("".join(kept))
    rows = [json.loads(line) for line in kept[: len(sketches)]]
    with file.open("a") as cache:
        for k in range(len(rows), len(sketches)):
            rows.append(measure(sketches[k], segmenter, grid=k < grid))
            cache.write(json.dumps(rows[-1]) + "\n")
            cache.flush()
            print(f"\r{len(rows)} of {len(sketches)} sketches", end="", file=sys.stderr)
    print(file=sys.stderr)
    return [row for row in rows if row]


def _digest(data: Path, grid: int) -> str:
    """Of everything that a measured sketch depends on."""
    code = [Path(str(thresholds_measure.__file__)), *sorted(Path(str(daemon.graph.__file__)).parent.glob("*.py"))]
    words = [load_manifest().sha256, str(data.resolve()), str(data.stat().st_size), str(grid)]
    words += [str((FIXED, ROUNDS, TAU0S, RATES, BETAS_PX))]
    return hashlib.sha256("\n".join(words + [file.read_text() for file in code]).encode()).hexdigest()[:16]


def summary(rows: Sequence[dict[str, Any]], command: str) -> dict[str, Any]:
    """What docs/compare/thresholds.json holds: means over the sketches, and histograms."""
    tried = [(tau0, rate) for tau0 in TAU0S for rate in RATES]
    on_grid = [row["grid"] for row in rows if row["grid"]]
    return {
        "command": command,
        "model": load_manifest().sha256,
        "n": len(rows),
        "lines": float(np.mean([row["lines"] for row in rows])),
        "short": sum(row["short"] for row in rows) / sum(row["lines"] for row in rows),
        "bins": BINS.tolist(),
        "thresholds": {f"{b:g}": _thresholds([row["thresholds"][f"{b:g}"] for row in rows]) for b in BETAS_PX},
        "settings": _settings([row["settings"] for row in rows], [_said(each) for each in (*FIXED, *ROUNDS)]),
        "grid_n": len(on_grid),
        "grid": _settings(on_grid, [{"tau0": tau0, "rate": rate} for tau0, rate in tried] if on_grid else []),
    }


def _said(adaptation: Adaptation) -> dict[str, float]:
    names = ("beta_px", "tau0", "rate", "rounds")
    return {name: getattr(adaptation, name) for name in names}


def _thresholds(rows: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """Of one beta: tau-hat and its distance to the mean eta in each reading, and what tau-hat tells apart."""
    found: dict[str, Any] = {}
    for reading in READINGS:
        tau, eta = np.array([row[reading] for row in rows if row[reading]]).T
        found[reading] = {"tau": _spread(tau), "margin": _spread(tau - eta), "eta": _spread(eta)}
        found[reading]["not_above"] = int((tau <= eta).sum())
    above = [[row["above"][k] / row["pairs"][k] for row in rows if row["pairs"][k]] for k in range(3)]
    ranked = [[row["ranked"][k] for row in rows if row["ranked"][k] is not None] for k in (0, 1)]
    return {
        **found,
        "above": [_mean(each) for each in above],
        "lines_above": _mean([row["above"][0] / sum(row["above"]) for row in rows if sum(row["above"])]),
        "ranked": [_mean(each) for each in ranked],
    }


def _mean(values: Sequence[float]) -> float | None:
    return float(np.mean(values)) if values else None


def _spread(values: np.ndarray[Any, Any]) -> dict[str, Any]:
    counts = np.histogram(np.clip(values, BINS[0], BINS[-1]), BINS)[0].tolist()
    return {
        "mean": float(values.mean()),
        "sd": float(values.std()),
        "low": float(np.percentile(values, 5)),
        "high": float(np.percentile(values, 95)),
        "counts": counts,
    }


def _settings(rows: Sequence[list[dict[str, list[float]]]], settings: Sequence[dict[str, float]]) -> list[Any]:
    """One entry a setting: its constants, and by mode the mean of each figure over the sketches."""
    return [
        {
            **setting,
            **{
                mode: dict(zip(FIGURES, np.mean([row[k][mode] for row in rows], axis=0).tolist(), strict=True))
                for mode in rows[0][k]
            },
        }
        for k, setting in enumerate(settings)
    ]


def tables(found: dict[str, Any]) -> dict[str, str]:
    """Markdown by the name of the mark that it stands under."""
    return {
        "measured": f"`{found['command']}`; n = {found['n']} sketches, {found['lines']:.0f} lines a sketch, "
        f"{found['short']:.0%} of all lines no longer than two discs; grid: n = {found['grid_n']}.",
        "tau-hat": _tau_table(found),
        "separation": _separation_table(found),
        "settings": _settings_table(found),
        "grid": "\n\n".join(_grid_table(found, mode) for mode in ("alone", "repaired")) if found["grid"] else "",
    }


def _tau_table(found: dict[str, Any]) -> str:
    spans = "mean, sd | 5 % ... 95 %"
    rows = [
        f"| reading | beta, px | tau-hat: {spans} | mean eta | tau-hat - mean eta: {spans} | not above |",
        "|---" * 8 + "|",
    ]
    for reading, words in READINGS.items():
        for beta, each in found["thresholds"].items():
            tau, margin, eta = (each[reading][name] for name in ("tau", "margin", "eta"))
            said = [f"{s['mean']:.3f}, {s['sd']:.3f} | {s['low']:.2f} ... {s['high']:.2f}" for s in (tau, margin)]
            rows.append(
                f"| {words} | {beta} | {said[0]} | {eta['mean']:.3f} | {said[1]} | {each[reading]['not_above']} |"
            )
    return "\n".join(rows)


def _separation_table(found: dict[str, Any]) -> str:
    above, rivals = "lines | through a vertex | off the ink", "one through a vertex | one off the ink"
    head = f"| beta, px | above tau-hat: {above} | lines among those above | a line outranks: {rivals} |"
    rows = [head, "|---" * 7 + "|"]
    for beta, each in found["thresholds"].items():
        shares = [*each["above"], each["lines_above"], *each["ranked"]]
        rows.append(f"| {beta} | {' | '.join('' if share is None else f'{share:.1%}' for share in shares)} |")
    return "\n".join(rows)


def _settings_table(found: dict[str, Any]) -> str:
    heads = [f"{_HEAD[mode]}: precision / recall | edges | length" for mode in MODES]
    rows = [f"| beta, tau0, N | {' | '.join(heads)} |", "|---" * (1 + 3 * len(MODES)) + "|"]
    for each in found["settings"]:
        said = [
            f"{f['precision']:.1f} / {f['recall']:.1f} | {f['edges']:.2f} | {f['length']:.2f}"
            for f in (each[mode] for mode in MODES)
        ]
        rows.append(f"| {each['beta_px']:g}, {each['tau0']:g}, {each['rounds']} | {' | '.join(said)} |")
    return "\n".join(rows)


def _grid_table(found: dict[str, Any], mode: str) -> str:
    """Rows tau0, columns lambda; precision / recall / edges per line."""
    rates = sorted({each["rate"] for each in found["grid"]})
    rows = [f"| {_HEAD[mode]}, tau0 | {' | '.join(f'lambda {rate:g}' for rate in rates)} |"]
    rows.append("|---" * (1 + len(rates)) + "|")
    for tau0 in sorted({each["tau0"] for each in found["grid"]}):
        cells = [each[mode] for each in found["grid"] if each["tau0"] == tau0]
        said = [f"{f['precision']:.1f} / {f['recall']:.1f} / {f['edges']:.2f}" for f in cells]
        rows.append(f"| {tau0:g} | {' | '.join(said)} |")
    return "\n".join(rows)


def fill(text: str, blocks: dict[str, str]) -> str:
    """The text with each block between its marks, `<!-- NAME -->` and `<!-- /NAME -->`. ValueError without them."""
    for name, block in blocks.items():
        marks = re.compile(f"(<!-- {name} -->\n).*?(<!-- /{name} -->)", re.DOTALL)
        text, count = marks.subn(lambda m, block=block: f"{m[1]}{block}\n{m[2]}", text)  # type: ignore[misc]
        if count != 1:
            raise ValueError(f"{count} places for the table {name!r}: write <!-- {name} --> and <!-- /{name} --> once")
    return text


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, help="simplified test rows: measure afresh")
    parser.add_argument("--limit", type=int, default=500, help="sketches")
    parser.add_argument("--grid", type=int, default=200, help="sketches of the grid of tau0 and lambda")
    parser.add_argument("--draw", action="store_true", help="make the tables of the page and the pictures again")
    given = parser.parse_args(arguments)
    cv2.setNumThreads(1)
    file, page = FOLDER / "thresholds.json", FOLDER / "thresholds.md"
    if given.data:
        command = f"python -m training.thresholds --data {given.data.name} --limit {given.limit} --grid {given.grid}"
        found = summary(rows_of(given.data, given.limit, given.grid), command)
        file.write_text(json.dumps(_rounded(found), indent=1) + "\n")
    found = json.loads(file.read_text())
    blocks = tables(found)
    print("\n\n".join(blocks.values()))
    if given.data or given.draw:
        from training.thresholds_pictures import draw  # noqa: PLC0415  the tables need no plotting

        page.write_text(fill(page.read_text(), blocks))
        draw(found, FOLDER)
    return 0


def _rounded(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _rounded(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_rounded(each) for each in value]
    return round(value, 4) if isinstance(value, float) else value


if __name__ == "__main__":
    raise SystemExit(main())
