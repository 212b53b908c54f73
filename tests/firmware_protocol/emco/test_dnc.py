"""Header and checksum of EMCO's DNC packages."""

from __future__ import annotations

import contextlib
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_protocol.emco.dnc import Package, Packages, checksum, decode, encode
from firmware_protocol.errors import LocalProtocolError, ProtocolError, RemoteProtocolError

plain = st.characters(min_codepoint=0x20, max_codepoint=0x7E)
packages = st.builds(
    Package,
    st.text(plain, min_size=1, max_size=1),
    st.text(plain, min_size=1, max_size=1),
    st.text(plain, min_size=1, max_size=1),
    st.text(plain, min_size=2, max_size=2),
    st.text(plain, max_size=9),
)


def test_the_checksum_of_the_rule() -> None:
    assert checksum(b"A100100") == ord("S")
    assert encode(Package("A", "1", "0", "01")) == b"SA100100"


@given(packages)
def test_what_is_encoded_is_decoded(package: Package) -> None:
    assert decode(encode(package)) == package


@given(st.lists(packages, max_size=5), st.lists(st.integers(0, 200), max_size=6))
def test_packages_do_not_depend_on_how_bytes_are_chunked(sent: list[Package], cuts: list[int]) -> None:
    data = b"".join(map(encode, sent))
    places = [0, *sorted(cut % (len(data) + 1) for cut in cuts), len(data)]
    reader = Packages()
    assert [package for a, b in pairwise(places) for package in reader.feed(data[a:b])] == sent


@given(st.binary(max_size=60), packages)
def test_a_package_behind_noise_is_found(noise: bytes, package: Package) -> None:
    found = list(Packages().feed(noise + b"\x00" * 17 + encode(package)))
    assert found[-1] == package


@given(st.binary(max_size=20))
def test_noise_raises_nothing_but_protocol_errors(data: bytes) -> None:
    list(Packages().feed(data))
    with contextlib.suppress(ProtocolError):
        decode(data)


def test_a_flipped_bit_is_refused() -> None:
    data = bytearray(encode(Package("A", "1", "0", "01", "X12")))
    data[-1] ^= 1
    with pytest.raises(RemoteProtocolError, match="checksum"):
        decode(bytes(data))


@pytest.mark.parametrize(
    "package", [Package("AB", "1", "0", "01"), Package("A", "1", "0", "1"), Package("A", "1", "0", "01", "X" * 10),
                Package("Ä", "1", "0", "01")],
)  # fmt: skip
def test_what_the_header_has_no_place_for_is_not_encoded(package: Package) -> None:
    with pytest.raises(LocalProtocolError):
        encode(package)
