"""Words of a G-code line: what GRBL keeps of a line, how it reads numbers, and how we write them."""

from __future__ import annotations

from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_protocol.gcode import GcodeError, Word, clean_line, format_line, format_number, read_number, read_words

LETTERS = st.sampled_from("FGIJKLMNPRSTXYZ")
NUMBERS = st.integers(-9_999_999, 9_999_999).map(lambda n: n / 1000)


@pytest.mark.parametrize(
    ("raw", "kept"),
    [
        (b"g0 x 2 . 5", "G0X2.5"),
        (b"G1(a)F5(b)0(c)0", "G1F500"),
        (b"F600;F700", "F600"),
        (b"S5(;)F650", "S5F650"),
        (b"G/1 F/4/5", "G1F45"),
        (b"(not closed", ""),
        (b"((x)F700", "F700"),
        (b"\xff\xfeF3\xc3\xb03\t\x00", "F33"),
    ],
)
def test_blanks_comments_slashes_and_high_bytes_are_dropped(raw: bytes, kept: str) -> None:
    assert clean_line(raw) == kept


def test_a_line_of_79_characters_is_taken_and_one_of_80_is_error_11() -> None:
    assert len(clean_line(b"G1 F" + b"7" * 76)) == 79
    with pytest.raises(GcodeError, match="error:11"):
        clean_line(b"G1 F" + b"7" * 77)


@pytest.mark.parametrize(
    ("text", "value"), [("+100", 100.0), ("100.", 100.0), (".5", 0.5), ("-.5", -0.5), ("0001.5", 1.5), ("-0", 0.0)]
)
def test_numbers_need_a_digit_and_nothing_more(text: str, value: float) -> None:
    assert read_number(text) == (value, len(text))


@pytest.mark.parametrize(
    ("line", "code"), [("X", 2), ("X--1", 2), ("X.", 2), ("HELLO", 2), ("X1..2", 1), ("%", 1), ("12", 1), ("G0*71", 1)]
)
def test_the_first_fault_of_a_line_has_the_code_that_grbl_gives(line: str, code: int) -> None:
    with pytest.raises(GcodeError) as caught:
        list(read_words(line))
    assert caught.value.code == code


def test_words_before_a_fault_are_read() -> None:
    words = read_words("G1X2%")
    assert [next(words), next(words)] == [Word("G", 1.0), Word("X", 2.0)]


def test_an_exponent_is_a_word_of_its_own() -> None:
    assert list(read_words("F1E3")) == [Word("F", 1.0), Word("E", 3.0)]


@pytest.mark.parametrize(
    ("value", "text"), [(1.5, "1.5"), (-0.0001, "0"), (-0.0, "0"), (1e-7, "0"), (1200.0, "1200"), (-2.3456, "-2.346")]
)
def test_numbers_are_written_short_and_never_as_minus_zero(value: float, text: str) -> None:
    assert format_number(value) == text


def test_whole_numbers_keep_their_zeros_without_decimals() -> None:
    assert format_number(1200.4, 0) == "1200"


@given(st.lists(st.tuples(LETTERS, NUMBERS), max_size=6))
def test_what_is_written_is_read_back(words: list[tuple[str, float]]) -> None:
    assert list(read_words(clean_line(format_line(words).encode()))) == [Word(*word) for word in words]


@given(st.binary(max_size=120))
def test_noise_raises_nothing_but_a_code(raw: bytes) -> None:
    with suppress(GcodeError):
        assert all("A" <= word.letter <= "Z" for word in read_words(clean_line(raw)))
