"""How a byte travels on a serial line."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_protocol.emco.line_format import FORMATS, FormatName, lower_seven, parity_is_even, with_even_parity


@pytest.mark.parametrize(("name", "bits"), [("7E1", 10), ("7E2", 11), ("8N1", 10)])
def test_a_byte_takes_its_bits(name: FormatName, bits: int) -> None:
    assert FORMATS[name].bits_per_byte == bits
    assert FORMATS[name].bytes_per_s(9600) == 9600 / bits


def test_xon_and_xoff_with_even_parity() -> None:
    assert with_even_parity(b"\x11\x13") == b"\x11\x93"


@given(st.binary())
def test_parity_is_made_even_and_taken_away_again(data: bytes) -> None:
    made = with_even_parity(data)
    assert all(map(parity_is_even, made))
    assert lower_seven(made) == lower_seven(data)
