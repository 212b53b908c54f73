"""Pictures of every kind become upright grey pages; what is none is refused with a sentence."""

from __future__ import annotations

import hashlib
import struct
from pathlib import Path

import cv2
import numpy as np
import pytest

from tests.daemon.intake import files
from tests.daemon.intake.files import CORNER, decoded, wavy


@pytest.mark.parametrize("extension", [".png", ".tiff", ".bmp", ".pgm"])
def test_a_lossless_picture_arrives_bit_by_bit(tmp_path: Path, extension: str) -> None:
    page = decoded(tmp_path, files.encoded(extension, wavy()))
    assert np.array_equal(page.grey, wavy())
    assert (page.given_width_px, page.given_height_px) == (160, 120)
    assert np.array_equal(page.to_given, np.eye(3))


@pytest.mark.parametrize("extension", [".jpg", ".webp"])
def test_a_lossy_picture_arrives_about_right(tmp_path: Path, extension: str) -> None:
    page = decoded(tmp_path, files.encoded(extension, CORNER))
    assert np.abs(page.grey.astype(int) - CORNER).mean() < 4


def test_a_progressive_jpeg_is_read(tmp_path: Path) -> None:
    page = decoded(tmp_path, files.encoded(".jpg", CORNER, cv2.IMWRITE_JPEG_PROGRESSIVE, 1))
    assert page.grey.shape == (24, 40)


def test_a_lossless_webp_is_read(tmp_path: Path) -> None:
    page = decoded(tmp_path, files.encoded(".webp", CORNER, cv2.IMWRITE_WEBP_QUALITY, 101))
    assert np.array_equal(page.grey, CORNER)


def test_the_kind_is_told_by_content_and_not_by_the_name(tmp_path: Path) -> None:
    assert decoded(tmp_path, files.encoded(".bmp", CORNER), "drawing.png").grey.shape == (24, 40)


def test_the_hash_is_that_of_the_files_bytes(tmp_path: Path) -> None:
    data = files.encoded(".png", CORNER)
    assert decoded(tmp_path, data).sha256 == hashlib.sha256(data).hexdigest()


# depth and colour


@pytest.mark.parametrize(
    ("data", "levels"),
    [
        pytest.param(files.png(4, 1, [b"\xa0"], depth=1), [255, 0, 255, 0], id="png-1"),
        pytest.param(files.png(4, 1, [b"\x1b"], depth=2), [0, 85, 170, 255], id="png-2"),
        pytest.param(files.png(2, 1, [b"\x40\x00\xff\xff"], depth=16), [64, 255], id="png-16"),
        pytest.param(files.png(1, 1, [b"\xff\0\0"], colour=files.RGB), [76], id="png-red"),
        pytest.param(
            files.png(2, 1, [b"\0\1"], colour=files.PALETTE, more=files.chunk(b"PLTE", b"\0\0\xff\xff\xff\xff")),
            [29, 255],
            id="png-palette",
        ),
        pytest.param(files.tiff(4, 1, b"\x50", bits=[1], photometric=1), [0, 255, 0, 255], id="tiff-1"),
        pytest.param(files.tiff(4, 1, b"\x50", bits=[1], photometric=0), [255, 0, 255, 0], id="tiff-fax"),
        pytest.param(files.tiff(2, 1, b"\0\x40\xff\xff", bits=[16]), [64, 255], id="tiff-16"),
        pytest.param(files.tiff(2, 1, b"\x40\0\xff\xff", bits=[16], order=">"), [64, 255], id="tiff-16-big-endian"),
        pytest.param(files.tiff(2, 1, b"\0\0\xff\xff", bits=[16], photometric=0), [255, 0], id="tiff-16-inverted"),
        pytest.param(
            files.tiff(2, 1, struct.pack("<ff", 0.25, 1.0), bits=[32], more={339: (3, [3])}), [64, 255], id="tiff-float"
        ),
        pytest.param(
            files.tiff(2, 1, struct.pack("<ff", 64, 255), bits=[32], more={339: (3, [3])}),
            [64, 255],
            id="tiff-float-255",
        ),
        pytest.param(files.tiff(2, 1, struct.pack("<II", 1 << 30, 2**32 - 1), bits=[32]), [64, 255], id="tiff-32"),
        pytest.param(files.tiff(2, 1, b"\0\0\0\xff\0\0\0\0", bits=[8] * 4, photometric=5), [0, 255], id="tiff-cmyk"),
        pytest.param(b"P1\n# ink\n4 1\n1 0 1 0\n", [0, 255, 0, 255], id="pbm"),
        pytest.param(b"P2 2 1 15 0 15\n", [0, 255], id="pgm-text"),
        pytest.param(b"P2 2 1 4095 0 4095\n", [0, 255], id="pgm-text-12"),
        pytest.param(b"P5 2 1 100\n\x32\x64", [128, 255], id="pgm-100"),
        pytest.param(b"P5 2 1 4095\n\x04\x04\x0f\xff", [64, 255], id="pgm-12"),
        pytest.param(b"P6 1 1 255\n\xff\0\0", [76], id="ppm"),
    ],
)
def test_every_depth_and_colour_becomes_grey_of_0_to_255(tmp_path: Path, data: bytes, levels: list[int]) -> None:
    assert decoded(tmp_path, data).grey.ravel().tolist() == pytest.approx(levels, abs=1)


@pytest.mark.parametrize(
    ("levels", "grey"), [((255, 255, 255, 255), 255), ((255, 255, 255, 0), 0), ((255, 255, 255, 100), 100)]
)
def test_a_cmyk_jpeg_is_read(tmp_path: Path, levels: tuple[int, int, int, int], grey: int) -> None:
    assert decoded(tmp_path, files.cmyk_jpeg(levels)).grey.ravel().tolist() == pytest.approx([grey] * 64, abs=2)


@pytest.mark.parametrize(
    "data",
    [
        pytest.param(files.png(3, 1, [b"\0\0\0\xff\0\x80"], colour=files.GREY_ALPHA), id="grey"),
        pytest.param(files.png(3, 1, [b"\0\0\0\0\0\0\0\xff\0\0\0\x80"], colour=files.RGBA), id="colour"),
        pytest.param(
            files.png(3, 1, [bytes(8) + bytes(6) + b"\xff\xff" + bytes(6) + b"\x80\0"], depth=16, colour=files.RGBA),
            id="16",
        ),
        pytest.param(
            files.tiff(3, 1, b"\0\0\0\0\0\0\0\xff\0\0\0\x80", bits=[8] * 4, photometric=2, more={338: (3, [2])}),
            id="tiff",
        ),
    ],
)
def test_what_is_transparent_shows_white_paper(tmp_path: Path, data: bytes) -> None:
    assert decoded(tmp_path, data).grey.ravel().tolist() == pytest.approx([255, 0, 127], abs=1)


def test_half_transparent_white_on_white_paper_is_white_in_a_tiff_too(tmp_path: Path) -> None:
    data = files.tiff(1, 1, b"\xff\xff\xff\x80", bits=[8] * 4, photometric=2, more={338: (3, [2])})
    assert decoded(tmp_path, data).grey.ravel().tolist() == pytest.approx([255], abs=1)


# the way up, and the scale

UPRIGHT = {1: (0, 0), 2: (0, 1), 3: (1, 1), 4: (1, 0), 5: (0, 0), 6: (0, 1), 7: (1, 1), 8: (1, 0)}
"""Where the ink of CORNER lies, as (lower, right) half, once the picture is turned as EXIF says."""


@pytest.mark.parametrize("turned", UPRIGHT)
@pytest.mark.parametrize("kind", ["jpeg", "png", "webp", "tiff"])
def test_a_turned_picture_is_put_upright(tmp_path: Path, kind: str, turned: int) -> None:
    block = files.exif(turned=turned, order="<>"[turned % 2])
    data = {
        "jpeg": lambda: files.jpeg_with_exif(files.encoded(".jpg", CORNER), block),
        "png": lambda: files.png(40, 24, [bytes(row) for row in CORNER], more=files.chunk(b"eXIf", block)),
        "webp": lambda: files.webp_with_exif(files.encoded(".webp", CORNER), 40, 24, block),
        "tiff": lambda: files.tiff(40, 24, CORNER.tobytes(), more={274: (3, [turned])}),
    }[kind]()
    page = decoded(tmp_path, data)
    wide, high = (24, 40) if turned >= 5 else (40, 24)
    assert (page.given_width_px, page.given_height_px) == (wide, high)
    y, x = np.argwhere(page.grey < 128).mean(axis=0)
    assert (int(y > high / 2), int(x > wide / 2)) == UPRIGHT[turned]


@pytest.mark.parametrize(
    "data",
    [
        pytest.param(
            files.png(1, 1, [b"\0"], more=files.chunk(b"pHYs", struct.pack(">IIB", 11811, 11811, 1))), id="png"
        ),
        pytest.param(files.jpeg_with_exif(files.encoded(".jpg", CORNER), files.exif(dpi=300)), id="exif"),
        pytest.param(
            files.encoded(".jpg", CORNER).replace(b"JFIF\0\1\1\0\0\1\0\1", b"JFIF\0\1\1\1\1\x2c\1\x2c"), id="jfif"
        ),
        pytest.param(
            files.encoded(".jpg", CORNER).replace(b"JFIF\0\1\1\0\0\1\0\1", b"JFIF\0\1\1\2\0\x76\0\x76"), id="jfif-cm"
        ),
        pytest.param(files.tiff(1, 1, b"\0", more={282: (5, [300, 1]), 283: (5, [300, 1])}), id="tiff"),
        pytest.param(files.tiff(1, 1, b"\0", order=">", more={282: (5, [1181, 10]), 296: (3, [3])}), id="tiff-cm"),
        pytest.param(
            files.encoded(".bmp", CORNER)[:38] + struct.pack("<ii", 11811, 11811) + files.encoded(".bmp", CORNER)[46:],
            id="bmp",
        ),
    ],
)
def test_a_stated_resolution_is_kept_as_px_per_mm(tmp_path: Path, data: bytes) -> None:
    assert decoded(tmp_path, data).px_per_mm == pytest.approx(300 / 25.4, rel=2e-3)


@pytest.mark.parametrize(
    "data",
    [
        pytest.param(files.encoded(".png", CORNER), id="none"),
        pytest.param(files.png(1, 1, [b"\0"], more=files.chunk(b"pHYs", struct.pack(">IIB", 3, 4, 0))), id="no-unit"),
        pytest.param(files.tiff(1, 1, b"\0", more={282: (5, [204, 1]), 283: (5, [98, 1])}), id="fax-not-square"),
        pytest.param(files.tiff(1, 1, b"\0", more={282: (5, [300, 0])}), id="division-by-zero"),
    ],
)
def test_no_usable_resolution_is_no_resolution(tmp_path: Path, data: bytes) -> None:
    assert decoded(tmp_path, data).px_per_mm is None
