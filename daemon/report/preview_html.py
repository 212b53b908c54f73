"""preview.html: given, understood and drawn in one file that asks nobody for anything, readable on a phone."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from html import escape
from itertools import groupby, pairwise

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.report.canvas import counted
from daemon.report.preview import in_words
from daemon.report.preview_page import SCRIPT, STYLE
from daemon.shapes import Points, Stroke, Toolpath

_GIVEN_SIDE_PX, _JPEG_QUALITY = 1400, 80
_CHORD_MM, _CHORD_PX = 0.02, 0.25
_AROUND_MM = 4.0
_WATCHED_S = 20.0
_SPEEDS = (1, 4, 16, 64, 256)
_INK, _LINES = "#1e2228", "#e0630c"


@dataclass(frozen=True, slots=True)
class PenLook:
    """name: "" where nobody has named the one pen. colour: as "#rrggbb"."""

    name: str = ""
    colour: str = _INK


@dataclass(frozen=True, slots=True)
class Told:
    """What is written beside the pictures.

    strokes_s: for each stroke when the pen has travelled to it and when it is drawn, in s from the start; empty where
    nobody knows: lengths then stand for times. seconds: of the whole drawing. approve: the order that has it drawn;
    "" where it is drawn without.
    """

    name: str
    machine: str
    seconds: float = 0.0
    strokes_s: Sequence[tuple[float, float]] = ()
    warnings: Sequence[str] = ()
    steps: Sequence[str] = ()
    approve: str = ""
    pens: Sequence[PenLook] = field(default=(PenLook(),))


def preview_html(
    given: NDArray[np.uint8],
    understood: Sequence[Points],
    toolpath: Toolpath,
    *,
    box_mm: tuple[float, float],
    box_origin_mm: tuple[float, float],
    told: Told,
) -> str:
    """The whole page.

    given: the picture, upright, uint8 (H, W) or (H, W, 3) blue green red. understood: the strokes, each (N, 2) in px
    of it. box_mm, box_origin_mm: where the box lies in machine mm, like the toolpath. Names are words, never markup.
    """
    policy = f"default-src 'none'; img-src data:; style-src '{_hash(STYLE)}'; script-src '{_hash(SCRIPT)}'"
    rows = [
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">',
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        f"<title>{escape(told.name)}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<main>",
        *_head(toolpath, told),
        '<div class="both">',
        *_given(given, understood, toolpath, told.pens),
        *_drawn(toolpath, box_mm, box_origin_mm, told),
        "</div>",
        *_tables(toolpath, told),
        f"</main>\n<script>{SCRIPT}</script>\n</body>\n</html>\n",
    ]
    return "\n".join(rows)


def _hash(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def _head(toolpath: Toolpath, told: Told) -> Iterator[str]:
    points = np.concatenate([stroke.points for stroke in toolpath.strokes])
    (left, bottom), (right, top) = points.min(axis=0), points.max(axis=0)
    facts = {
        "time": in_words(told.seconds) if told.seconds else "not known",
        "size on the sheet": f"{right - left:.1f} × {top - bottom:.1f} mm",
        "lower left at": f"{left:.1f}, {bottom:.1f} mm",
        "pen lifts": str(len(toolpath.strokes)),
        "drawn": _length(toolpath.drawn_mm),
        "travelled": _length(toolpath.travelled_mm),
    }
    yield f'<h1>{escape(told.name)}</h1>\n<p class="quiet">as {escape(told.machine)} will draw it</p>'
    yield '<dl class="facts">'
    yield from (f"<div><dt>{name}</dt><dd>{value}</dd></div>" for name, value in facts.items())
    yield "</dl>"
    if told.approve:
        word = f"<p><code>{escape(told.approve)}</code> has it drawn.</p>"
        yield f"<section><h2>It waits for your word</h2>{word}</section>"
    if told.warnings:
        yield '<section class="warnings"><h2>Look twice</h2><ul>'
        yield from (f"<li>{escape(words)}</li>" for words in told.warnings)
        yield "</ul></section>"


def _length(mm: float) -> str:
    return f"{mm / 1000:.2f} m" if mm >= 1000 else f"{mm:.0f} mm"


def _given(
    given: NDArray[np.uint8], understood: Sequence[Points], toolpath: Toolpath, pens: Sequence[PenLook]
) -> Iterator[str]:
    height, width = given.shape[:2]
    yield "<section><h2>Given, and what was understood of it</h2>"
    yield (
        f'<svg viewBox="-0.5 -0.5 {width} {height}" role="img" aria-label="the given picture under the lines">'
        f'<image id="given" x="-0.5" y="-0.5" width="{width}" height="{height}" opacity="0.45" href="{_jpeg(given)}"/>'
        f'<g id="understood" fill="none" stroke-linecap="round" stroke-linejoin="round" '
        f'stroke-width="{max(width, height) / 500:.2f}">'
    )
    for line, stroke in zip(understood, toolpath.strokes, strict=True):
        colour = _LINES if len(pens) == 1 else pens[stroke.pen].colour
        yield f'<path stroke="{colour}" d="{_path(line, _CHORD_PX)}"/>'
    yield '</g></svg><div class="row">'
    yield '<label>picture <input id="fade" type="range" min="0" max="100" value="45"></label>'
    yield '<label><input id="lines" type="checkbox" checked> lines</label></div></section>'


def _jpeg(given: NDArray[np.uint8]) -> str:
    scale = _GIVEN_SIDE_PX / max(given.shape[:2])
    small = given if scale >= 1 else cv2.resize(given, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    data = cv2.imencode(".jpg", small, [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY])[1]
    return "data:image/jpeg;base64," + base64.b64encode(bytes(data)).decode()


def _drawn(
    toolpath: Toolpath, box_mm: tuple[float, float], box_origin_mm: tuple[float, float], told: Told
) -> Iterator[str]:
    """The sheet, y up, in mm; each stroke a path, and the way to it another."""
    corner = np.asarray(box_origin_mm, float)
    stops = _stops(toolpath)
    everything = np.concatenate([corner[None], (corner + box_mm)[None], *stops, *(s.points for s in toolpath.strokes)])
    (left, bottom), (right, top) = everything.min(axis=0) - _AROUND_MM, everything.max(axis=0) + _AROUND_MM
    times_s, end_s = _times(toolpath, stops, told)

    def on_sheet(points: Points) -> Points:
        return np.stack([points[:, 0] - left, top - points[:, 1]], axis=1)

    (x, y), (width, height) = on_sheet(np.array([[corner[0], corner[1] + box_mm[1]]]))[0], box_mm
    wide = max(right - left, top - bottom)
    yield "<section><h2>How it is drawn</h2>"
    yield (
        f'<svg id="sheet" viewBox="0 0 {right - left:.2f} {top - bottom:.2f}" role="img" aria-label="the sheet" '
        f'data-end="{end_s:.3f}" data-times="{" ".join(f"{t:.3f}" for pair in times_s for t in pair)}">'
        f'<rect x="{x:.2f}" y="{y:.2f}" width="{width:.2f}" height="{height:.2f}" fill="none" stroke="#c9c6c1" '
        f'stroke-width="{wide / 600:.3f}"/>'
        '<g fill="none" stroke-linecap="round" stroke-linejoin="round">'
        f'<g id="ways" stroke="#5b9bd5" stroke-width="{wide / 700:.3f}" stroke-opacity="0.7">'
    )
    yield from (f'<path d="{_path(on_sheet(way), 0.0)}"/>' for way in stops)
    yield f'</g><g id="strokes" stroke-width="{max(0.4, wide / 500):.3f}">'
    for stroke in toolpath.strokes:
        pen = told.pens[stroke.pen] if stroke.pen < len(told.pens) else PenLook()
        named = f' data-pen="{escape(pen.name)}"' if pen.name else ""
        yield f'<path stroke="{pen.colour}"{named} d="{_path(on_sheet(stroke.points), _CHORD_MM)}"/>'
    yield f'</g></g><circle id="pen" r="{wide / 110:.2f}" fill="#d3222a" fill-opacity="0.75"/></svg>'
    fastest = next((factor for factor in _SPEEDS if end_s / factor <= _WATCHED_S), _SPEEDS[-1])
    chosen = "".join(
        f'<option value="{factor}"{" selected" if factor == fastest else ""}>{factor} ×</option>' for factor in _SPEEDS
    )
    yield '<div class="row"><button id="play" type="button">Play</button>'
    yield '<input id="scrub" type="range" min="0" max="1000" value="1000" step="any" aria-label="moment">'
    yield f'<label>speed <select id="speed">{chosen}</select></label>'
    yield '<label><input id="travel" type="checkbox" checked> travel</label></div>'
    yield '<p id="clock" class="quiet"></p></section>'


def _stops(toolpath: Toolpath) -> list[Points]:
    """The ways with the pen up, each (N, 2): to every stroke, by the park place where the pen is changed, and home."""
    park, ways = np.array([toolpath.park_mm]), []
    here, before = np.array([toolpath.start_mm]), toolpath.strokes[:1]
    for stroke in toolpath.strokes:
        by = [park] * (before[0].pen != stroke.pen)
        ways.append(np.concatenate([here, *by, stroke.points[:1]]))
        here, before = stroke.points[-1:], (stroke,)
    return [*ways, np.concatenate([here, park])]


def _times(toolpath: Toolpath, ways: Sequence[Points], told: Told) -> tuple[Sequence[tuple[float, float]], float]:
    """When the pen comes down for each stroke and when it is drawn, and the end; by lengths where nobody knows."""
    if len(told.strokes_s) == len(toolpath.strokes):
        return told.strokes_s, max(told.seconds, told.strokes_s[-1][1])
    found, now = [], 0.0
    for way, stroke in zip(ways, toolpath.strokes, strict=False):
        down = now + _long(way) / 100
        now = down + max(0.1, stroke.length / 20)
        found.append((down, now))
    return found, now + _long(ways[-1]) / 100


def _long(points: Points) -> float:
    return float(np.hypot(*np.diff(points, axis=0).T).sum())


def _tables(toolpath: Toolpath, told: Told) -> Iterator[str]:
    if len(told.pens) > 1:
        yield "<section><h2>Pens, in the order in which they are asked for</h2><table>"
        yield "<tr><th>pen</th><th>strokes</th><th>drawn</th></tr>"
        yield from (_pass(told.pens[pen], list(strokes)) for pen, strokes in groupby(toolpath.strokes, _pen_of))
        yield "</table></section>"
    if told.steps:
        yield '<section><h2>What was done to the page first</h2><ol class="steps">'
        yield from (f"<li>{escape(words)}</li>" for words in told.steps)
        yield "</ol></section>"


def _pen_of(stroke: Stroke) -> int:
    return stroke.pen


def _pass(pen: PenLook, strokes: Sequence[Stroke]) -> str:
    drawn_mm = sum(stroke.length for stroke in strokes)
    return (
        f'<tr><td><svg class="swatch" viewBox="0 0 1 1"><rect width="1" height="1" fill="{pen.colour}"/></svg>'
        f"{escape(pen.name)}</td><td>{counted(len(strokes), 'stroke', 'strokes')}</td><td>{_length(drawn_mm)}</td></tr>"
    )


def _path(points: Points, chord: float) -> str:
    """As the `d` of an SVG path, with as few points as the chord allows; a dot has two."""
    if len(points) > 2 and chord:
        points = cv2.approxPolyDP(points.astype(np.float32)[:, None], chord, False)[:, 0].astype(float)
    places = [f"{x:.2f} {y:.2f}" for x, y in points.tolist()]
    kept = places[:1] + [place for before, place in pairwise(places) if place != before]
    return f"M{kept[0]}L{' '.join(kept[1:] or kept)}"
