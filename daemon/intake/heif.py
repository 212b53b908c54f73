"""A HEIC photograph becomes pixels. The only door to pi_heif."""

from __future__ import annotations

import re

import numpy as np

from daemon.intake.tone import to_colours, to_grey
from daemon.intake.vector.common import Rendered

HEAD = re.compile(rb"....ftyp(?:hei[cxms]|hev[cx]|mif1|msf1|avif)", re.DOTALL)


def read_heif(data: bytes, *, max_megapixels: float, in_colour: bool = False) -> Rendered:
    """The photograph of a HEIC file, upright; of several the one that the file calls its first.

    Raises ValueError with what is wrong and its cure, ModuleNotFoundError without pi_heif.
    """
    import pi_heif  # noqa: PLC0415 - an extra

    try:
        photograph = pi_heif.open_heif(data, bgr_mode=True)
        width_px, height_px = photograph.size
        if width_px * height_px <= max_megapixels * 1e6:
            pixels, dimmed = np.asarray(photograph), bool(photograph.premultiplied_alpha)
            colour = to_colours(pixels, premultiplied=dimmed) if in_colour else None
            return Rendered(to_grey(pixels, premultiplied=dimmed), colour=colour)
    except (ValueError, RuntimeError, SyntaxError, EOFError) as error:
        raise ValueError(f"cannot be read ({str(error).strip()}): copy it again, or save it as JPEG") from error
    raise ValueError(
        f"has {width_px} x {height_px} px, at most {max_megapixels:g} megapixels are read: make it smaller, or raise "
        "max_megapixels"
    )
