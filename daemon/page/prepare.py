"""A page is put right before it is read; what finds nothing to do changes nothing."""

from __future__ import annotations

from dataclasses import replace

from daemon.page.blots import rimmed
from daemon.page.dark import turn_dark
from daemon.page.dirt import clean_paper
from daemon.page.fills import Fill, hollow
from daemon.page.hatch import Hatch
from daemon.page.light import even_light, flatten_light, spread_tones
from daemon.page.line_width import fit_line_width
from daemon.page.overdrawn import merge_overdrawn
from daemon.page.photograph import warned_of_photograph
from daemon.page.ruling import take_off_ruling
from daemon.page.sheet import straighten
from daemon.page.skew import level
from daemon.page.working_range import warned_of_contrast, warned_of_size
from daemon.shapes import PageImage


def prepare(page: PageImage) -> PageImage:
    """Dark ink on light paper, evenly lit, with lines of the width that the network reads best.

    page: upright, as `decode` gives it. Returns a page whose `to_given` leads back to the given picture and whose
    `line_width_px` is known where the page holds ink.
    """
    return fit(put_right(page))


def put_right(page: PageImage) -> PageImage:
    """The sheet alone, upright, evenly lit, without what is no drawing on it: what is drawn and compared with.

    `to_given` leads back to the given picture. A clean page comes back as it is, bit by bit.
    """
    upright = level(warned_of_photograph(even_light(turn_dark(straighten(page)))))
    bare = take_off_ruling(upright)
    return clean_paper(spread_tones(warned_of_contrast(bare)))


def fit(page: PageImage, *, fill: Fill = "outline", merge: bool = True) -> PageImage:
    """The page put right at the scale at which it is read, its line width known, with what there is to warn of.

    fill: what becomes of areas that are wider than any line; a hatch's spacing is in px of the page given here.
    merge: whether the passes of a line that was drawn over itself become one line.
    """
    fitted = fit_line_width(merge_overdrawn(page) if merge else page)
    if isinstance(fill, Hatch):
        fill = replace(fill, spacing_px=fill.spacing_px * fitted.grey.shape[1] / page.grey.shape[1])
    return rimmed(hollow(warned_of_size(fitted), fill=fill))


def even_out(page: PageImage) -> PageImage:
    """Dark ink on light, evenly lit paper, pixel for pixel the given picture."""
    return flatten_light(turn_dark(page))
