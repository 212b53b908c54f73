"""The table of commands: bytes, values and text."""

from __future__ import annotations

import struct
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_protocol.dobot import commands
from firmware_protocol.dobot.commands import BY_NAME, KINDS, Command, Kind, command, parse, question, text_of
from firmware_protocol.dobot.packet import Packet, PacketReader, ctrl
from firmware_protocol.errors import LocalProtocolError, ProtocolError, RemoteProtocolError
from tests.firmware_protocol.dobot.vectors import numbered, sound

REQUESTS = sound()
WRITTEN = [kind for kind in KINDS.values() if kind.writes is not None and kind.writes != "text"]


def packet_of(frame: str) -> Packet:
    (packet,) = PacketReader().feed(bytes.fromhex(frame))
    return packet


@pytest.mark.parametrize("vector", REQUESTS, ids=numbered(REQUESTS))
def test_captured_requests_mean_what_they_say_and_are_written_the_same(vector: dict[str, Any]) -> None:
    packet = packet_of(vector["request"])
    if vector.get("malformed"):
        with pytest.raises(RemoteProtocolError, match="bytes of parameters instead of"):
            commands.decode(packet)
    elif packet.write:
        written = commands.decode(packet)
        assert list(written.values) == pytest.approx(vector["asks"])
        assert written.packet(queued=packet.queued).encode().hex() == vector["request"]
    else:
        assert packet.id in KINDS


@pytest.mark.parametrize("vector", [v for v in REQUESTS if "reply" in v], ids=lambda vector: str(vector["id"]))
def test_captured_replies_say_what_they_mean(vector: dict[str, Any]) -> None:
    packet = packet_of(vector["reply"])
    if packet.write and packet.queued:
        assert [commands.index_of(packet)] == vector["says"]
    elif packet.write:
        assert (packet.params, vector["says"]) == (b"", [])
    elif vector["says"] and not packet.queued:
        assert list(commands.answer(packet)) == pytest.approx(vector["says"])


def values_of(kind: Kind) -> st.SearchStrategy[tuple[float | int, ...]]:
    """Values that the structure and three decimals keep."""
    codes = {
        "f": st.integers(-4_000_000, 4_000_000).map(lambda number: number / 1000),
        "B": st.integers(0, 255),
        "H": st.integers(0, 65535),
        "I": st.integers(0, 2**32 - 1),
        "i": st.integers(-(2**31), 2**31 - 1),
    }
    letters = [letter for letter in commands.field_codes(kind.writes or "")]
    return st.tuples(*(codes[letter] for letter in letters))


@given(st.sampled_from(WRITTEN).flatmap(lambda kind: st.tuples(st.just(kind), values_of(kind))))
def test_what_is_encoded_is_decoded_and_what_is_written_down_is_read(drawn: tuple[Kind, tuple[float, ...]]) -> None:
    kind, values = drawn
    written = Command(kind, values)
    assert commands.decode(written.packet()).values == pytest.approx(values, abs=1e-3)
    assert parse(text_of(written)).values == pytest.approx(values, abs=1e-3)
    assert text_of(parse(text_of(written))) == text_of(written)


def test_a_cp_command_reads_like_its_fields() -> None:
    cp = command("CP", 1, 210.0, 5.0, 20.0, 60.0)
    assert text_of(cp) == "CP 1 210.000 5.000 20.000 60.000"
    assert cp.packet().encode().hex() == "aaaa135b030100005243" + "0000a0400000a0410000704299"


def test_homing_is_written_with_and_without_its_number() -> None:
    assert parse("HOME").packet().encode().hex() == "aaaa021f03de"
    assert parse("HOME 0").packet().encode().hex() == "aaaa061f0300000000de"


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ("CP 1 2 3", "CP takes mode x_mm y_mm z_mm mm_s"),
        ("CP 1 2 3 4 x", "could not convert"),
        ("CP 1 2 3 4 nan", "finite"),
        ("CP 300 2 3 4 5", "CP takes"),
        ("CP 1 2 3 4 1e39", "CP takes"),
        ("DRAW 1", "there is no command 'DRAW'"),
        ("Pose", "Pose cannot be written"),
        ("", "there is no command ''"),
    ],
)
def test_a_line_that_is_no_command_says_why(line: str, fault: str) -> None:
    with pytest.raises(LocalProtocolError, match=fault):
        parse(line)


@given(st.text(max_size=40) | st.sampled_from(sorted(BY_NAME)).flatmap(lambda name: st.just(name + " 1 2 3")))
def test_any_text_is_a_command_or_a_protocol_error(line: str) -> None:
    try:
        parse(line)
    except ProtocolError:
        return


@given(st.builds(Packet, st.integers(0, 255), st.integers(0, 3), st.binary(max_size=40)))
def test_any_packet_is_understood_or_a_protocol_error(packet: Packet) -> None:
    for read in (commands.decode, commands.answer, commands.index_of):
        try:
            read(packet)
        except ProtocolError:
            continue


def test_the_left_space_may_be_four_or_eight_bytes_wide() -> None:
    for width in (4, 8):
        assert commands.answer(Packet(247, 0, (32).to_bytes(width, "little"))) == (32,)


def test_a_question_has_no_parameters_and_some_commands_cannot_be_asked() -> None:
    assert question("Pose").encode().hex() == "aaaa020a00f6"
    with pytest.raises(LocalProtocolError, match="cannot be read"):
        question("CP")


def test_every_kind_has_a_name_for_each_of_its_fields() -> None:
    for kind in KINDS.values():
        structure = kind.reads if kind.writes is None else kind.writes
        if structure not in (None, "", "text", "16s"):
            assert len(kind.fields) == len(struct.unpack(structure, bytes(struct.calcsize(structure)))), kind.name
    assert len(BY_NAME) == len(KINDS)


def test_zeros_are_an_answer() -> None:
    assert commands.answer_params(KINDS[134], commands.zeros(KINDS[134])) == bytes(3)
    assert ctrl() == 0
