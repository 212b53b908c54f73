"""Packets, byte for byte, and how they are found behind noise."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_protocol.dobot.packet import LONGEST_LENGTH, Packet, PacketReader, ctrl
from firmware_protocol.errors import LocalProtocolError
from tests.firmware_protocol.dobot.vectors import GOLDEN, VECTORS, numbered, sound

PACKETS = st.builds(Packet, st.integers(0, 255), st.integers(0, 255), st.binary(max_size=LONGEST_LENGTH - 2))
STREAMS = st.lists(
    st.one_of(st.binary(max_size=30), st.just(b"\xaa"), st.just(b"\xaa\xaa"), PACKETS.map(Packet.encode)), max_size=8
).map(b"".join)


def read(data: bytes) -> list[Packet]:
    return PacketReader().feed(data)


@pytest.mark.parametrize("vector", VECTORS, ids=numbered(VECTORS))
def test_every_captured_packet_is_read_and_written_byte_for_byte(vector: dict[str, Any]) -> None:
    frames = [vector["request"]] if vector.get("sound", True) else []
    frames += [vector["reply"]] if "reply" in vector else []
    for frame in frames:
        (packet,) = read(bytes.fromhex(frame))
        assert packet.encode().hex() == frame


def test_a_wrong_checksum_is_no_packet() -> None:
    unsound = [vector for vector in VECTORS if vector not in sound()]
    assert len(unsound) == 6
    assert [read(bytes.fromhex(vector["request"])) for vector in unsound] == [[]] * 6


@pytest.mark.parametrize("case", GOLDEN["streams"], ids=[case["name"] for case in GOLDEN["streams"]])
def test_packets_are_found_where_the_vendor_finds_them(case: dict[str, Any]) -> None:
    assert [packet.encode().hex() for packet in read(bytes.fromhex(case["stream"]))] == case["packets"]


def test_the_control_byte_says_write_and_queue() -> None:
    bits = [(Packet(84, value).write, Packet(84, value).queued) for value in range(4)]
    assert bits == [(False, False), (True, False), (False, True), (True, True)]
    assert ctrl(write=True, queued=True) == 3


def test_a_packet_that_the_arm_does_not_take_is_refused() -> None:
    longest = Packet(1, 1, bytes(LONGEST_LENGTH - 2))
    assert read(longest.encode()) == [longest]
    with pytest.raises(LocalProtocolError, match="too long"):
        Packet(1, 1, bytes(LONGEST_LENGTH - 1)).encode()


def test_a_reply_inside_an_unfinished_packet_is_found_when_nobody_waits_for_its_end() -> None:
    reader, reply = PacketReader(), Packet(246, 0, bytes(8))
    assert reader.feed(b"\xaa\xaa\x60\x01" + reply.encode()) == []
    assert reader.give_up() == [reply]


def test_damaged_packets_are_counted() -> None:
    reader = PacketReader()
    reader.feed(bytes.fromhex("aaaa020a00f5") + Packet(10, 0).encode())
    assert reader.damaged == 1


@given(PACKETS)
def test_what_is_encoded_is_decoded(packet: Packet) -> None:
    assert read(packet.encode()) == [packet]


@given(STREAMS, st.lists(st.integers(0, 2000), max_size=12))
def test_packets_do_not_depend_on_how_bytes_are_chunked(stream: bytes, places: list[int]) -> None:
    reader, at = PacketReader(), [0, *sorted(place % (len(stream) + 1) for place in places), len(stream)]
    assert [packet for start, end in pairwise(at) for packet in reader.feed(stream[start:end])] == read(stream)


@given(STREAMS, PACKETS)
def test_the_reader_recovers_from_any_noise(noise: bytes, packet: Packet) -> None:
    reader = PacketReader()
    reader.feed(noise)
    # Zeros hold no header and end whatever a false header has begun.
    reader.feed(bytes(LONGEST_LENGTH + 4))
    assert reader.feed(packet.encode()) == [packet]
