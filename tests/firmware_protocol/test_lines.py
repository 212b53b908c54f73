"""Bytes become lines, however they are chunked, up to a length limit."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_protocol.errors import RemoteProtocolError
from firmware_protocol.lines import LineReader


def lines_of(chunks: list[bytes], *, limit_bytes: int = 16) -> tuple[list[str], bool]:
    """What was read, and whether the reader gave up."""
    reader, lines = LineReader(limit_bytes=limit_bytes), []
    try:
        for chunk in chunks:
            for line in reader.feed(chunk):
                lines.append(line)
    except RemoteProtocolError:
        return lines, True
    return lines, False


def test_cr_lf_and_crlf_each_end_a_line() -> None:
    assert lines_of([b"\r\nGrbl\nok\rok\r\n"]) == (["Grbl", "ok", "ok"], False)


def test_an_unfinished_line_is_kept_for_later() -> None:
    assert lines_of([b"o", b"k", b"\r", b"\nerr"]) == (["ok"], False)


def test_a_line_of_the_limit_is_a_line_and_one_more_byte_is_a_fault() -> None:
    assert lines_of([b"a" * 16 + b"\n"]) == (["a" * 16], False)
    assert lines_of([b"ok\n" + b"a" * 17]) == (["ok"], True)


def test_after_an_endless_line_nothing_is_trusted() -> None:
    reader = LineReader(limit_bytes=4)
    with pytest.raises(RemoteProtocolError, match="4 bytes"):
        list(reader.feed(b"aaaaa"))
    with pytest.raises(RemoteProtocolError):
        list(reader.feed(b"\nok\n"))


@given(st.lists(st.binary(max_size=20)))
def test_lines_do_not_depend_on_how_bytes_are_chunked(chunks: list[bytes]) -> None:
    assert lines_of(chunks) == lines_of([b"".join(chunks)])
