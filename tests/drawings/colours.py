"""A drawing in three colours, as picture, as photograph and as SVG: `python -m tests.drawings.colours`."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np

from daemon.shapes import Colours, Points
from tests.drawings.hand import by_hand, curve, inked, line, ring

HERE = Path(__file__).parent
PENS = {"black": "#1a1a1a", "red": "#d03030", "blue": "#2040c0"}
SECTION = "[pens]\ncolours = { " + ", ".join(f'{name} = "{colour}"' for name, colour in PENS.items()) + " }\n"
"""What the settings say of them."""
SIDE_PX, WIDTH_PX = 600, 4.0


def scene() -> list[tuple[str, Points]]:
    """A house in black, a red roof that changes into its smoke, a blue stream before it, and lines that all cross."""
    return [
        ("black", line((18, 50), (18, 80), (62, 80), (62, 50), (18, 50))),
        ("red", line((12, 50), (40, 24), (68, 50))),
        ("black", line((34, 80), (34, 64), (46, 64), (46, 80))),
        ("red", ring(78, 20, 8)),
        *(("red", line((78 + 10 * x, 20 + 10 * y), (78 + 16 * x, 20 + 16 * y))) for x, y in _RAYS),
        ("blue", curve((4, 88), (20, 84), (36, 91), (52, 85), (68, 91), (84, 85), (96, 89))),
        ("blue", curve((4, 95), (20, 91), (36, 97), (52, 92), (68, 97), (84, 92), (96, 95))),
        ("blue", curve((28, 86), (27, 74), (29, 62), (26, 56))),
        ("black", line((72, 86), (88, 52))),
        ("red", line((70, 62), (94, 72))),
        ("blue", line((72, 52), (92, 84))),
        ("black", curve((80, 44), (84, 41), (88, 44), (92, 41), (96, 44))),
        ("blue", ring(28, 60, 3)),
        ("red", ring(52, 60, 2)),
        ("black", line((8, 10), (30, 10))),
        ("red", line((30, 10), (52, 10))),
    ]


_RAYS = [(np.cos(angle), np.sin(angle)) for angle in np.linspace(0, 2 * np.pi, 8, endpoint=False)]


def strokes(side_px: int = SIDE_PX) -> list[tuple[str, Points]]:
    """By hand, in px."""
    random = np.random.default_rng(7)
    return [(pen, by_hand(points * side_px / 100 - 0.5, random, wobble_px=0.0015 * side_px)) for pen, points in scene()]


def picture(side_px: int = SIDE_PX, width_px: float = WIDTH_PX, *, pens: dict[str, str] = PENS) -> Colours:
    """On white paper; the later line covers the earlier one."""
    seen = np.full((side_px, side_px, 3), 255.0)
    for pen, points in strokes(side_px):
        share = inked([points], (side_px, side_px), width_px=width_px)[..., None]
        seen = seen * (1 - share) + share * bgr(pens[pen])
    return np.asarray(np.rint(seen), np.uint8)


def photographed(clean: Colours, *, seed: int = 1) -> Colours:
    """The same under a warm lamp at one side, blurred, with noise, as a JPEG whose colours are half as fine."""
    random = np.random.default_rng(seed)
    height, width = clean.shape[:2]
    across = np.linspace(1.0, 0.62, width)[None, :, None] * np.linspace(1.0, 0.9, height)[:, None, None]
    warm = clean / 255 * np.array([0.78, 0.9, 0.97]) * across
    seen = cv2.GaussianBlur(warm * 255, (0, 0), 0.8) + random.normal(0, 4.0, clean.shape)
    file = cv2.imencode(".jpg", np.clip(seen, 0, 255).astype(np.uint8), [cv2.IMWRITE_JPEG_QUALITY, 80])[1]
    return np.asarray(cv2.imdecode(file, cv2.IMREAD_COLOR), np.uint8)


def svg() -> str:
    """In a unit of 1 mm; colours as attributes, and one inherited from its group."""
    rows = ['<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100">']
    for pen, colour in PENS.items():
        rows.append(f'<g fill="none" stroke="{colour}">')
        lines = (points for name, points in scene() if name == pen)
        rows += [f'<polyline points="{" ".join(f"{x:.2f},{y:.2f}" for x, y in points)}"/>' for points in lines]
        rows.append("</g>")
    return "\n".join([*rows, "</svg>"]) + "\n"


def bgr(colour: str) -> tuple[int, int, int]:
    red, green, blue = bytes.fromhex(colour[1:])
    return blue, green, red


if __name__ == "__main__":
    cv2.imwrite(str(HERE / "three_colours.png"), picture(), [cv2.IMWRITE_PNG_COMPRESSION, 9])
    (HERE / "three_colours.svg").write_text(svg(), encoding="utf-8")
