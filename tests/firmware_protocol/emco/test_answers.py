"""Answers to single blocks are found in any stream."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_protocol.emco.answers import Answer, AnswerReader

ACK, NAK = b"\x06", b"\x15"


def read(data: bytes, *, ack: bytes = ACK, nak: bytes = NAK) -> list[Answer]:
    return list(AnswerReader(ack=ack, nak=nak).feed(data))


def test_control_characters_are_found_anywhere() -> None:
    assert read(b"\x06noise\x15\x06") == [Answer.ACK, Answer.NAK, Answer.ACK]


def test_text_is_an_answer_only_as_a_whole_line() -> None:
    assert read(b"ok\r\nlook\nok then\n ok \nerr\n", ack=b"ok", nak=b"err") == [Answer.ACK, Answer.ACK, Answer.NAK]


def test_text_and_a_control_character_may_be_mixed() -> None:
    assert read(b"ok\n\x15ok\n", ack=b"ok") == [Answer.ACK, Answer.NAK, Answer.ACK]


def test_answers_of_several_characters_are_found() -> None:
    assert read(b"\x10\x10\x30\x10\x31", ack=b"\x10\x30", nak=b"\x10\x31") == [Answer.ACK, Answer.NAK]


def test_what_is_no_answer_is_kept() -> None:
    reader = AnswerReader(ack=b"ok", nak=b"err")
    list(reader.feed(b"alarm 12\r\n"))
    assert reader.other == "alarm 12"


@pytest.mark.parametrize(("ack", "nak"), [(b"", b"\x15"), (b"ok", b"ok"), (b"\x06", b"\x10\x06")])
def test_answers_that_cannot_be_told_apart_are_refused(ack: bytes, nak: bytes) -> None:
    with pytest.raises(ValueError, match="told apart"):
        AnswerReader(ack=ack, nak=nak)


@given(st.binary(max_size=300), st.integers(0, 300), st.sampled_from([ACK, b"ok", b"\r", b"\x10\x30"]))
def test_answers_do_not_depend_on_how_bytes_are_chunked(data: bytes, cut: int, ack: bytes) -> None:
    reader = AnswerReader(ack=ack, nak=NAK)
    assert [*reader.feed(data[:cut]), *reader.feed(data[cut:])] == read(data, ack=ack)
