"""EMCO's own DNC interface: header and checksum of its packages, as far as they are public. There is no session.

EMCO's description of the interface (reduced ASCII format) is public in part: packages with acknowledgements over
RS-232 or TCP, where the machine listens on port 5557. Its tables of command groups, codes, acknowledgements and error
numbers are not public, and neither are its time limits. So nothing here sends a package. Whoever owns the manual can
build a session on `encode`, `Packages` and a table of the commands: `Package.group` and `Package.code` are its keys.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from firmware_protocol.errors import LocalProtocolError, RemoteProtocolError

TCP_PORT = 5557
HEADER_BYTES = 8
LONGEST_BYTES = 9
"""Of the text that follows a header."""

_PLAIN = re.compile(r"[ -~]*")


@dataclass(frozen=True, slots=True)
class Package:
    """group, code, number: one character each; message: two. text: what follows the header, 9 characters at most."""

    group: str
    code: str
    number: str
    message: str
    text: str = ""


def checksum(body: bytes) -> int:
    """Of all bytes of a package but the checksum itself: their sum modulo 64, plus 48."""
    return sum(body) % 64 + 48


def encode(package: Package) -> bytes:
    """The bytes of a package. Raises LocalProtocolError for a field of another length than the header has."""
    fields = (package.group, package.code, package.number, package.message)
    head = "".join(fields)
    if [len(field) for field in fields] != [1, 1, 1, 2] or len(package.text) > LONGEST_BYTES:
        raise LocalProtocolError(
            f"{package} is no DNC package: group, code, number 1, message 2, text 0 to 9 characters"
        )
    if not _PLAIN.fullmatch(head + package.text):
        raise LocalProtocolError(f"{package} is no DNC package: use printable ASCII")
    body = f"{head}{len(package.text):02d}{package.text}".encode("ascii")
    return bytes([checksum(body)]) + body


def decode(data: bytes) -> Package:
    """The package that these bytes are, whole. Raises RemoteProtocolError where they are none."""
    length = _length(data) if data else 0
    if len(data) != HEADER_BYTES + length:
        raise RemoteProtocolError(f"a DNC package of {len(data)} bytes says that it has {HEADER_BYTES + length}")
    if data[0] != checksum(data[1:]):
        raise RemoteProtocolError(f"a DNC package has checksum {data[0]}, its bytes add up to {checksum(data[1:])}")
    text = data[1:].decode("latin-1")
    if not _PLAIN.fullmatch(text):
        raise RemoteProtocolError(f"a DNC package holds {text!r}, which is not printable ASCII")
    return Package(text[0], text[1], text[2], text[3:5], text[7:])


class Packages:
    """Finds packages in a stream of bytes, however it is chunked; what is none is passed over byte by byte."""

    def __init__(self) -> None:
        self._rest = b""

    def feed(self, data: bytes) -> Iterator[Package]:
        """The packages that `data` completes. Take them all before feeding again."""
        self._rest += data
        while len(self._rest) >= HEADER_BYTES:
            try:
                end = HEADER_BYTES + _length(self._rest)
                if len(self._rest) < end:
                    return
                package = decode(self._rest[:end])
            except RemoteProtocolError:
                self._rest = self._rest[1:]
                continue
            self._rest = self._rest[end:]
            yield package


def _length(data: bytes) -> int:
    """Of the text, by the header. Raises RemoteProtocolError for what is no header."""
    if not 48 <= data[0] < 48 + 64 or not _PLAIN.fullmatch(data[1:HEADER_BYTES].decode("latin-1")):
        raise RemoteProtocolError(f"{data[:HEADER_BYTES]!r} is no header of a DNC package")
    digits = data[6:8]
    if len(digits) < 2 or not digits.isdigit() or int(digits) > LONGEST_BYTES:
        raise RemoteProtocolError(f"a DNC package says a length of {digits!r}: 00 to 09 are possible")
    return int(digits)
