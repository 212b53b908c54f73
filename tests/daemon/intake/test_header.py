"""What a header says, without decoding."""

from __future__ import annotations

import struct

import cv2
import pytest

from daemon.intake.header import read_header
from tests.daemon.intake import files


@pytest.mark.parametrize("extension", [".png", ".jpg", ".webp"])
def test_the_end_of_the_file_is_looked_for(extension: str) -> None:
    data = files.encoded(extension, files.wavy())
    assert read_header(data).whole
    assert read_header(data + b"something behind the picture").whole
    assert not read_header(data[:-4]).whole


def test_restart_markers_do_not_end_a_jpeg() -> None:
    data = files.encoded(".jpg", files.wavy(), cv2.IMWRITE_JPEG_RST_INTERVAL, 1)
    assert data.count(b"\xff\xd0") > 1
    assert read_header(data).whole


def test_an_extended_webp_may_be_wide_and_high() -> None:
    data = files.webp_with_exif(files.encoded(".webp", files.CORNER), 70_000, 66_000, files.exif())
    header = read_header(data)
    assert (header.width_px, header.height_px) == (70_000, 66_000)


def test_an_os2_bitmap_has_a_short_header() -> None:
    header = read_header(b"BM" + bytes(12) + struct.pack("<IHH", 12, 30, 20))
    assert (header.kind, header.width_px, header.height_px) == ("BMP", 30, 20)


def test_a_bitmap_from_top_to_bottom_has_a_negative_height() -> None:
    header = read_header(b"BM" + bytes(12) + struct.pack("<Iii", 40, 30, -20) + bytes(28))
    assert (header.width_px, header.height_px) == (30, 20)
