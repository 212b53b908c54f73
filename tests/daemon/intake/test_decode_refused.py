"""What is no picture, or one too large or damaged, is refused with a sentence that says what, where and what to do."""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import cv2
import numpy as np
import pytest

from daemon.errors import BadPicture
from daemon.intake.decode import decode
from tests.daemon.intake import files


def refusal(tmp_path: Path, data: bytes, name: str = "picture") -> str:
    with pytest.raises(BadPicture) as caught:
        files.decoded(tmp_path, data, name)
    assert str(tmp_path / name) in str(caught.value)
    return str(caught.value)


def test_an_empty_file_is_refused(tmp_path: Path) -> None:
    assert "it is empty" in refusal(tmp_path, b"")


def test_a_text_file_named_png_is_refused(tmp_path: Path) -> None:
    assert "it begins with b'Dear all'" in refusal(tmp_path, b"Dear all, this is no picture", "letter.png")


def test_a_bomb_is_refused_before_it_is_decoded(tmp_path: Path) -> None:
    row = zlib.compress(bytes(50_001 * 200))
    head = struct.pack(">IIBBBBB", 50_000, 50_000, 8, 0, 0, 0, 0)
    bomb = b"\x89PNG\r\n\x1a\n" + files.chunk(b"IHDR", head) + files.chunk(b"IDAT", row) + files.chunk(b"IEND", b"")
    assert "PNG of 50000 x 50000 px, at most 100 megapixels are read: make it smaller" in refusal(tmp_path, bomb)


@pytest.mark.parametrize("extension", [".png", ".jpg", ".tiff", ".bmp", ".webp", ".pgm"])
def test_the_limit_holds_for_every_kind(tmp_path: Path, extension: str) -> None:
    data = files.encoded(extension, files.wavy())
    with pytest.raises(BadPicture, match=r"160 x 120 px, at most 0\.019 megapixels"):
        files.decoded(tmp_path, data, max_megapixels=0.019)
    assert files.decoded(tmp_path, data, max_megapixels=0.0192).grey.size == 19_200


@pytest.mark.parametrize("kept", [0.05, 0.5, 0.9, 0.999])
@pytest.mark.parametrize("extension", [".png", ".jpg", ".tiff", ".bmp", ".webp", ".pgm"])
def test_a_file_that_is_cut_short_is_refused(tmp_path: Path, extension: str, kept: float) -> None:
    data = files.encoded(extension, files.wavy())
    assert "cut short" in refusal(tmp_path, data[: int(kept * len(data))])


@pytest.mark.parametrize("lost", [1, 2, 3, 100])
def test_a_progressive_jpeg_without_its_last_bytes_is_refused(tmp_path: Path, lost: int) -> None:
    data = files.encoded(".jpg", files.wavy(), cv2.IMWRITE_JPEG_PROGRESSIVE, 1)
    assert "cut short" in refusal(tmp_path, data[:-lost])


def test_a_png_with_a_changed_byte_is_refused(tmp_path: Path) -> None:
    data = bytearray(files.encoded(".png", files.wavy()))
    data[len(data) // 2] ^= 0xFF
    assert "damaged" in refusal(tmp_path, bytes(data))


@pytest.mark.parametrize("data", [b"P5 0 4 255\n", b"P5 4 4 99999\n", b"P5 4", files.png(0, 4, [])])
def test_a_picture_without_a_size_is_refused(tmp_path: Path, data: bytes) -> None:
    assert "its header" in refusal(tmp_path, data)


@pytest.mark.parametrize("extension", [".png", ".jpg", ".tiff", ".bmp", ".webp", ".pgm"])
def test_noise_behind_a_good_beginning_raises_nothing_but_bad_picture(tmp_path: Path, extension: str) -> None:
    good = files.encoded(extension, files.CORNER)
    rng = np.random.default_rng(3)
    for _ in range(40):
        noisy = bytearray(good)
        for place in rng.integers(0, min(len(good), 80), 4):
            noisy[place] = rng.integers(0, 256)
        with suppress(BadPicture):
            files.decoded(tmp_path, bytes(noisy), max_megapixels=1.0)


def test_a_symbolic_link_is_refused(tmp_path: Path) -> None:
    (tmp_path / "real.png").write_bytes(files.encoded(".png", files.CORNER))
    (tmp_path / "link.png").symlink_to(tmp_path / "real.png")
    with pytest.raises(BadPicture, match=r"link\.png is a symbolic link"):
        decode(tmp_path / "link.png")


def test_a_fifo_is_refused_at_once(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.png")
    with pytest.raises(BadPicture, match=r"pipe\.png is no regular file"):
        decode(tmp_path / "pipe.png")


def test_a_folder_and_a_missing_file_are_refused(tmp_path: Path) -> None:
    with pytest.raises(BadPicture, match="Is a directory"):
        decode(tmp_path)
    with pytest.raises(BadPicture, match="cannot be read"):
        decode(tmp_path / "gone.png")


def test_an_unreadable_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "mine.png").write_bytes(files.encoded(".png", files.CORNER))
    (tmp_path / "mine.png").chmod(0)
    with as_somebody_else(), pytest.raises(BadPicture, match="Permission denied"):
        decode(tmp_path / "mine.png")


@contextmanager
def as_somebody_else() -> Iterator[None]:
    """Root may read everything, so it becomes another user for a moment."""
    user = os.geteuid()
    if user == 0:
        os.seteuid(65534)
    try:
        yield
    finally:
        os.seteuid(user)


def test_a_file_far_too_large_is_not_even_read(tmp_path: Path) -> None:
    with open(tmp_path / "huge.png", "wb") as file:
        file.truncate(10**12)
    with pytest.raises(BadPicture, match="make it smaller"):
        decode(tmp_path / "huge.png")


def test_a_picture_for_which_there_is_no_memory_is_not_called_damaged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        cv2.resize(np.zeros((2, 2), np.uint8), (1 << 24, 1 << 24))

    (tmp_path / "a.png").write_bytes(files.encoded(".png", files.CORNER))
    monkeypatch.setattr(cv2, "imdecode", full)
    with pytest.raises(MemoryError):
        decode(tmp_path / "a.png")
