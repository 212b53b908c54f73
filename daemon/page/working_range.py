"""What of a page lies outside the range that is worked in, in plain words."""

from __future__ import annotations

from dataclasses import replace

from daemon.page.back import given_px
from daemon.page.tones import tones
from daemon.shapes import PageImage

WIDTHS_PX = (1.0, 40.0)
LEAST_CONTRAST = 0.15
LEAST_SIDE_PX = 64
_A_LITTLE = 0.85
"""Estimates are not exact: what is beyond by less is not warned of."""


def warned_of_contrast(page: PageImage) -> PageImage:
    """The page, with a warning where its ink is hardly darker than its paper. page: evenly lit, tones not spread."""
    found = tones(page.grey)
    if found is None or found.full_ink <= found.paper * (1 - LEAST_CONTRAST):
        return page
    percent = 100 * (1 - found.full_ink / max(found.paper, 1.0))
    return warned(
        page,
        f"the ink is only {percent:.0f} % darker than the paper, {100 * LEAST_CONTRAST:.0f} % are wanted: lines may be "
        "missed; scan it darker, or draw it with a softer pencil",
    )


def warned_of_size(page: PageImage) -> PageImage:
    """The page, its line width known, with warnings where lines are very thin or wide or the picture is very small."""
    if min(page.given_width_px, page.given_height_px) < LEAST_SIDE_PX:
        page = warned(
            page,
            f"the picture is {page.given_width_px} x {page.given_height_px} px, {LEAST_SIDE_PX} px a side are wanted: "
            "what is drawn may be coarse; scan it larger",
        )
    if page.line_width_px is None:
        return page
    width_px = page.line_width_px * given_px(page)
    if _A_LITTLE * WIDTHS_PX[0] <= width_px <= WIDTHS_PX[1] / _A_LITTLE:
        return page
    remedy = "larger" if width_px < WIDTHS_PX[0] else "smaller"
    return warned(
        page,
        f"the lines are about {width_px:.1f} px wide, {WIDTHS_PX[0]:g} to {WIDTHS_PX[1]:g} px are wanted: some may be "
        f"missed or drawn twice; scan it {remedy}",
    )


def warned(page: PageImage, words: str) -> PageImage:
    """The page with one more warning."""
    return replace(page, warnings=(*page.warnings, words))
