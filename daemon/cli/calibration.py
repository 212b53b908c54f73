"""What `linedrawd calibrate` does: the test card is drawn, and its picture tells what the machine does wrong."""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from daemon.cli.card import draw, only_machine, settings_file, write
from daemon.cli.options import settings_of
from daemon.config import Settings
from daemon.errors import BadPicture, DiskTrouble, SettingsError
from daemon.intake.decode import decode
from daemon.setup.card import Card, card_in
from daemon.setup.find import Found, find_marks
from daemon.setup.fit import Errors, by_known_width, by_resolution, errors_of
from daemon.setup.paper import paper_mm
from daemon.setup.picture import found_picture
from daemon.setup.sheet_edges import px_to_mm_by_sheet
from daemon.shapes import Homography, PageImage

_NOISE_MM, _NOISE_DEG, _NOISE_SCALE = 0.02, 0.02, 0.0003
"""What a good machine seems to do wrong on a good scan."""
_MOST_TIMES = 2.0


def calibrate(args: argparse.Namespace) -> int:
    """0 when it is drawn or measured. Raises LinedrawError."""
    if args.picture is None:
        draw(settings_of(args, machine_needed=True, one_machine=True), corrected=args.corrected)
        return 0
    settings = settings_of(args, one_machine=True)
    name, _ = only_machine(settings)
    page, card, found, to_px = _seen(args, settings)
    errors = errors_of(found, px_to_mm=_px_to_mm(args, page, card, found, to_px))
    if not 1 / _MOST_TIMES <= errors.scale_x <= _MOST_TIMES:
        raise BadPicture(
            f"by its resolution of {25.4 * (page.px_per_mm or 0):.0f} dpi the card in {args.picture} was drawn "
            f"{errors.scale_x:.2f} times too large: say --known-mm or --paper, as for a photo"
        )
    print(f"{args.picture}: a card of {card.width_mm:g} x {card.height_mm:g} mm, {len(found)} of its "
          f"{len(card.marks)} marks found")  # fmt: skip
    _show_marks(args.picture, found_picture(page.grey, card, found, to_px))
    if args.check:
        print(f"the farthest mark lies {errors.before_mm:.2f} mm from where it should")
        return 0
    print("\n".join(_told(errors)))
    file = settings_file(args, dict(os.environ))
    write(file, {f"machines.{name}": values_of(errors)})
    return 0


def values_of(errors: Errors) -> dict[str, Any]:
    """The settings of a machine with these errors; what is no more than noise is nothing."""
    scale_x, scale_y = (
        1.0 if abs(scale - 1) < _NOISE_SCALE else round(scale, 5) for scale in (errors.scale_x, errors.scale_y)
    )
    skew_deg = 0.0 if abs(errors.skew_deg) < _NOISE_DEG else round(errors.skew_deg, 3)
    backlash_mm = [0.0 if play_mm < _NOISE_MM else round(play_mm, 3) for play_mm in errors.backlash_mm]
    return {"scale_x": scale_x, "scale_y": scale_y, "skew_deg": skew_deg, "backlash_mm": backlash_mm}


def _seen(args: argparse.Namespace, settings: Settings) -> tuple[PageImage, Card, list[Found], Homography]:
    name, _ = only_machine(settings)
    page = decode(args.picture, max_megapixels=settings.intake.max_megapixels)
    card = Card(*paper_mm(args.card)) if args.card else card_in(settings.sheet_of(name).box_mm)
    return page, card, *find_marks(page.grey, card)


def _px_to_mm(
    args: argparse.Namespace, page: PageImage, card: Card, found: list[Found], to_px: Homography
) -> Homography:
    if args.paper and args.known_mm:
        raise SettingsError("--paper and --known-mm both say how large everything is: give one of them")
    if args.paper:
        return px_to_mm_by_sheet(page.grey, paper_mm(args.paper))
    if args.known_mm:
        if args.known_mm <= 0:
            raise SettingsError("--known-mm is a width in mm: give a number above 0")
        return by_known_width(found, to_px, card, args.known_mm)
    if page.px_per_mm is None:
        raise BadPicture(
            f"{args.picture} does not say its resolution: scan it as PNG or TIFF with its dpi, or say --known-mm "
            "or --paper"
        )
    return by_resolution(page.px_per_mm)


def _show_marks(picture: Path, png: bytes) -> None:
    beside = picture.with_name(f"{picture.stem}-marks.png")
    try:
        beside.write_bytes(png)
    except OSError as error:
        raise DiskTrouble(f"{beside} cannot be written ({error.strerror}): copy the picture elsewhere") from None
    print(f"{beside} shows them")


def _told(errors: Errors) -> Iterator[str]:
    for axis, scale in (("X", errors.scale_x), ("Y", errors.scale_y)):
        per_cent = 100 * (scale - 1)
        yield f"{axis} is drawn {abs(per_cent):.2f} % too {'long' if per_cent > 0 else 'short'}"
    yield f"Y leans {abs(errors.skew_deg):.2f} degrees to the {'right' if errors.skew_deg > 0 else 'left'}"
    yield f"X has {errors.backlash_mm[0]:.2f} mm of backlash, Y {errors.backlash_mm[1]:.2f} mm"
    yield (
        f"the farthest mark lies {errors.before_mm:.2f} mm from where it should; these corrections leave "
        f"{errors.after_mm:.2f} mm"
    )
