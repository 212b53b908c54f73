"""Documents of many pages: each page of a TIFF is its own, and they are counted elsewhere, within limits."""

from __future__ import annotations

import os
import signal
import struct
import subprocess
import zlib
from pathlib import Path

import pytest

from daemon.errors import BadPicture
from daemon.intake import pages
from daemon.intake.decode import decode
from daemon.intake.pages import MOST_PAGES, UNCOUNTED, count_pages
from daemon.intake.picture import open_picture
from daemon.shapes import PageImage
from tests.daemon.intake import files
from tests.daemon.intake.vector.pdfs import ENCRYPTED, pdf

_SMALLER, _MASK = 1, 4


def book(*kinds: int, last: int | None = None) -> bytes:
    """A TIFF file with a page of N x 1 px for the N-th of these kinds (tag 254), of the grey 10 N.

    last: behind the last one lies again the page of this index; None: none.
    """
    data, places = b"II*\0" + bytes(4), []
    for number, kind in enumerate(kinds, start=1):
        entries = {254: kind, 256: number, 257: 1, 258: 8, 259: 1, 262: 1, 273: len(data), 277: 1, 278: 1, 279: number}
        data += bytes([10 * number % 256] * number).ljust(number + number % 2, b"\0")
        places.append(len(data))
        data += struct.pack("<H", len(entries))
        data += b"".join(struct.pack("<HHII", tag, 4, 1, value) for tag, value in entries.items()) + bytes(4)
    # Eight bytes of the header come first, and each directory ends with the place of the next.
    links = [4, *(place + 2 + 12 * 10 for place in places)]
    after = [*places, places[last] if last is not None else 0]
    for link, place in zip(links, after, strict=True):
        data = data[:link] + struct.pack("<I", place) + data[link + 4 :]
    return data


def counted(tmp_path: Path, data: bytes) -> int:
    (tmp_path / "a").write_bytes(data)
    return count_pages(tmp_path / "a")


def widths(tmp_path: Path, data: bytes) -> list[tuple[int, int]]:
    (tmp_path / "a.tiff").write_bytes(data)
    found = [decode(tmp_path / "a.tiff", page=page) for page in range(1, counted(tmp_path, data) + 1)]
    return [(page.grey.shape[1], int(page.grey[0, 0])) for page in found]


def test_each_page_of_a_tiff_is_read(tmp_path: Path) -> None:
    assert widths(tmp_path, book(0, 2, 2)) == [(1, 10), (2, 20), (3, 30)]


def test_smaller_copies_and_masks_are_no_pages(tmp_path: Path) -> None:
    assert widths(tmp_path, book(0, _SMALLER, 0, _MASK)) == [(1, 10), (3, 30)]
    assert widths(tmp_path, book(_SMALLER)) == [(1, 10)]


@pytest.mark.parametrize("last", [0, 1, 2])
def test_pages_that_point_at_each_other_are_each_read_once(tmp_path: Path, last: int) -> None:
    assert widths(tmp_path, book(0, 0, 0, last=last)) == [(1, 10), (2, 20), (3, 30)]


@pytest.mark.parametrize(
    ("data", "page", "words"),
    [
        (book(0, 0), 3, "has 2 pages, there is no page 3"),
        (files.encoded(".png", files.CORNER), 2, "has 1 page, there is no page 2"),
        (book(*[0] * (MOST_PAGES + 1)), 1, f"has {MOST_PAGES + 1} pages, at most {MOST_PAGES} are drawn: split it"),
        (book(0, 0)[:-60], 1, "is a TIFF that is damaged or cut short"),
    ],
    ids=["beyond the last", "beyond the only", "too many", "cut short"],
)
def test_what_is_not_there_or_too_much_is_refused(tmp_path: Path, data: bytes, page: int, words: str) -> None:
    (tmp_path / "a").write_bytes(data)
    with pytest.raises(BadPicture, match=words):
        decode(tmp_path / "a", page=page)


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (pdf(["", "0 0 m 9 9 l S", ""]), 3),
        (b"before it\n" + pdf(["", ""]), 2),
        (ENCRYPTED, 1),
        (b"%PDF-1.7\nnothing of the kind", 1),
        (pdf([""] * (MOST_PAGES + 1)), 1),
        (pdf([""] * MOST_PAGES), MOST_PAGES),
        (book(*[0] * (MOST_PAGES + 1)), 1),
        (book(0, 0)[:-60], 1),
    ],
    ids=["pdf", "pdf behind other bytes", "encrypted", "corrupt", "too many", "as many as may be", "tiff", "cut short"],
)
def test_pages_are_counted_and_what_is_refused_is_one(tmp_path: Path, data: bytes, expected: int) -> None:
    assert counted(tmp_path, data) == expected


def test_a_path_may_begin_where_the_command_was_given(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.pdf").write_bytes(pdf(["", ""]))
    monkeypatch.chdir(tmp_path)
    assert count_pages(Path("a.pdf")) == 2


def test_what_can_have_no_pages_is_not_opened_by_anybody(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pages.subprocess, "run", None)
    assert counted(tmp_path, files.encoded(".png", files.CORNER)) == 1
    (tmp_path / "link").symlink_to(tmp_path / "a")
    os.mkfifo(tmp_path / "pipe")
    assert [count_pages(tmp_path / name) for name in ("link", "pipe", "gone")] == [1, 1, 1]


def test_a_count_that_takes_too_long_is_broken_off_and_told_from_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(pages, "_WITHIN_S", 0.001)
    assert counted(tmp_path, pdf(["", ""])) == UNCOUNTED


def test_a_count_that_is_killed_for_its_memory_is_told_from_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    killed = subprocess.CompletedProcess[bytes]([], -signal.SIGABRT, b"")
    monkeypatch.setattr(pages.subprocess, "run", lambda *args, **options: killed)
    assert counted(tmp_path, pdf(["", ""])) == UNCOUNTED


def test_a_file_that_the_memory_does_not_hold_is_told_from_one(tmp_path: Path) -> None:
    with (tmp_path / "a").open("wb") as file:
        file.write(book(0, 0))
        file.truncate((pages._MEMORY_MB + 64) << 20)
    assert count_pages(tmp_path / "a") == UNCOUNTED


def test_a_picture_that_names_a_pdf_in_its_head_is_no_pdf(tmp_path: Path) -> None:
    whole = files.encoded(".png", files.CORNER)
    note = b"tEXtComment\0from %PDF-1.7"
    chunk = struct.pack(">I", len(note) - 4) + note + struct.pack(">I", zlib.crc32(note))
    (tmp_path / "a").write_bytes(whole[:33] + chunk + whole[33:])
    assert count_pages(tmp_path / "a") == 1
    found = open_picture(tmp_path / "a")
    assert isinstance(found, PageImage)
    assert found.grey.shape == files.CORNER.shape[:2]


def test_of_an_uncounted_document_no_page_is_left_out_in_silence(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(book(0))
    assert decode(tmp_path / "a", page=UNCOUNTED).grey.shape == (1, 1)
    (tmp_path / "a").write_bytes(book(0, 0))
    with pytest.raises(BadPicture, match="has 2 pages, which could not be counted when it came: drop it again"):
        decode(tmp_path / "a", page=UNCOUNTED)
