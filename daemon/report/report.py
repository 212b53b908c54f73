"""report.json: the figures of one job."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from typing import Any, Literal, TypeAlias

from daemon.report.fidelity import Fidelity
from daemon.report.places import Place
from daemon.shapes import LineGraph, PageImage, Toolpath

FidelityOf: TypeAlias = Literal["planned", "executed"]


@dataclass(frozen=True, slots=True)
class PenShare:
    """What one of several pens draws."""

    colour: str
    strokes: int
    drawn_mm: float


@dataclass(frozen=True, slots=True)
class Report:
    """What is known of a job, in the order in which report.json tells it."""

    given_width_px: int
    given_height_px: int
    given_sha256: str
    page_width_px: int
    page_height_px: int
    line_width_px: float
    """Full width of the lines on the page put right, before it is scaled."""
    vertices: int
    edges: int
    strokes: int
    specks: int
    """Pieces of ink that were left out as dirt."""
    pens: Mapping[str, PenShare]
    """By name, in drawing order; none where one pen without a name draws everything."""
    drawn_mm: float
    travelled_mm: float
    estimated_s: float
    real_s: float | None
    """What the machine took; a simulated one has its own clock. None until it has drawn."""
    stage_s: Mapping[str, float]
    """Seconds of each stage of planning, in order."""
    peak_memory_mb: float
    """Of the planning process, resident."""
    to_given: Sequence[Sequence[float]]
    """Px of the page put right, as it is drawn and measured, to px of the given picture: 3 x 3, a homography."""
    page_steps: Sequence[str]
    """What was done to put the page right, in order."""
    warnings: Sequence[str]
    """What of the picture lies outside the range that is worked in, or was left out, in plain words."""
    from_px: Sequence[Sequence[float]]
    """Px of the page put right to machine mm: 2 x 3, as in Toolpath."""
    fidelity_of: FidelityOf
    """Which lines were compared with the page: the planned ones or the ink that a simulated machine has kept."""
    fidelity: Fidelity | None
    """None until the planned ones have been compared."""


def planned_report(
    pages: tuple[PageImage, PageImage],
    graph: LineGraph,
    toolpath: Toolpath,
    fidelity: Fidelity | None,
    *,
    line_width_px: float,
    estimated_s: float,
    stage_s: Mapping[str, float],
    peak_memory_mb: float,
) -> Report:
    """What is known once a job is planned; `fidelity` is that of its planned strokes, where it is known already.

    pages: the page put right, in whose px it is drawn, and the same scaled to be read.
    """
    upright, page = pages
    page_height_px, page_width_px = page.grey.shape
    return Report(
        given_width_px=page.given_width_px,
        given_height_px=page.given_height_px,
        given_sha256=page.sha256,
        page_width_px=page_width_px,
        page_height_px=page_height_px,
        line_width_px=line_width_px,
        vertices=len(graph.vertices),
        edges=len(graph.edges),
        strokes=len(toolpath.strokes),
        specks=graph.specks,
        pens=_pens(toolpath),
        drawn_mm=toolpath.drawn_mm,
        travelled_mm=toolpath.travelled_mm,
        estimated_s=estimated_s,
        real_s=None,
        stage_s=dict(stage_s),
        peak_memory_mb=peak_memory_mb,
        to_given=upright.to_given.tolist(),
        page_steps=[step.words for step in page.steps],
        warnings=list(page.warnings),
        from_px=toolpath.from_px.tolist(),
        fidelity_of="planned",
        fidelity=fidelity,
    )


def _pens(toolpath: Toolpath) -> dict[str, PenShare]:
    found: dict[str, PenShare] = {}
    for number, (name, colour) in enumerate(toolpath.pens):
        mine = [stroke for stroke in toolpath.strokes if stroke.pen == number]
        found[name] = PenShare(colour, len(mine), math.fsum(stroke.length for stroke in mine))
    return found


def executed_report(planned: Report, fidelity: Fidelity, *, real_s: float) -> Report:
    """The report once a simulated machine has drawn: `fidelity` is that of its ink, `real_s` its own seconds."""
    return replace(planned, real_s=real_s, fidelity_of="executed", fidelity=fidelity)


def to_json(report: Report) -> str:
    """report.json: figures to four decimals, `from_px` to all of them."""
    return json.dumps(_rounded(asdict(report)), indent=2, allow_nan=False) + "\n"


def from_json(text: str) -> Report:
    """The report that `to_json` wrote. Raises ValueError naming what is missing or unknown."""
    found = json.loads(text)
    if not isinstance(found, dict):
        raise ValueError("report.json holds no report: plan the picture again")
    names = {field.name for field in fields(Report)}
    if strange := names ^ found.keys():
        raise ValueError(
            f"report.json is not of this version, see {', '.join(sorted(strange))}: plan the picture again"
        )
    pens = {name: PenShare(**share) for name, share in found["pens"].items()}
    return Report(**{**found, "fidelity": _fidelity(found["fidelity"]), "pens": pens})


def _fidelity(found: dict[str, Any] | None) -> Fidelity | None:
    if found is None:
        return None
    lists = {name: tuple(Place(**place) for place in found[name]) for name in ("not_drawn", "not_on_ink")}
    return Fidelity(**found | lists)


def _rounded(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _rounded(each) for name, each in value.items()}
    if isinstance(value, float) and math.isfinite(value):
        return round(value, 4)
    return value
