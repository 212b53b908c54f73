"""What stands around a program, and how programs are named."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_protocol.emco.dialects import DIALECTS, FANUC, SIEMENS, Dialect, dialect_of, program_name
from firmware_protocol.errors import LocalProtocolError

both = pytest.mark.parametrize("dialect", DIALECTS.values(), ids=list(DIALECTS))


def test_a_siemens_program_says_its_name_and_its_folder() -> None:
    assert SIEMENS.head("LD_CAT") == ("%_N_LD_CAT_MPF", ";$PATH=/_N_MPF_DIR")
    assert SIEMENS.tail == ()
    assert SIEMENS.file_name("LD_CAT") == "LD_CAT.MPF"


def test_a_fanuc_program_stands_between_two_percent_signs() -> None:
    assert FANUC.head("O0012") == ("%", "O0012")
    assert FANUC.tail == ("%",)


@pytest.mark.parametrize("name", ["", "L1", "1LD", "ld_cat", "LD-CAT", "LD" + "X" * 23, "LDÄ", "LD_CAT\n"])
def test_a_siemens_name_begins_with_two_letters(name: str) -> None:
    with pytest.raises(LocalProtocolError, match="two letters"):
        SIEMENS.head(name)


@pytest.mark.parametrize("name", ["", "O0000", "O1", "0001", "O00001", "o0001", "O000X"])
def test_a_fanuc_name_is_o_and_four_digits(name: str) -> None:
    with pytest.raises(LocalProtocolError, match="four digits"):
        FANUC.head(name)


@both
@given(text=st.text(max_size=60), number=st.integers(1, 10**7))
def test_any_picture_gets_a_name_that_the_control_takes(dialect: Dialect, text: str, number: int) -> None:
    dialect.check_name(dialect.name_from(text, number))


def test_fanuc_numbers_stay_below_the_protected_ones() -> None:
    numbers = {FANUC.name_from("", number) for number in range(1, 20_000)}
    assert (min(numbers), max(numbers)) == ("O0001", "O7999")


@both
def test_a_program_is_known_by_its_head(dialect: Dialect) -> None:
    name = dialect.name_from("cat", 7)
    assert program_name(dialect.head(name)) == (dialect, name)


@pytest.mark.parametrize("lines", [(), ("G21",), ("%",), ("%", "G21"), ("%_N_X_MPF",)])
def test_what_has_no_head_is_no_program(lines: tuple[str, ...]) -> None:
    with pytest.raises(LocalProtocolError):
        program_name(lines)


def test_the_first_line_of_a_siemens_program_holds_its_name() -> None:
    assert dialect_of("%_N_LD_1_MPF") == (SIEMENS, "LD_1")
