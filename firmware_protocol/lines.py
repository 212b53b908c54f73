"""Bytes become lines, however they are chunked, up to a length limit."""

from __future__ import annotations

from collections.abc import Iterator

from firmware_protocol.errors import RemoteProtocolError

LIMIT_BYTES = 1024
"""Well above the longest line of GRBL (a `$I` answer of grblHAL), well below what a babbling port sends in a second."""


class LineReader:
    """Cuts a byte stream at CR and LF; empty lines, so also the gap between CR and LF, are dropped.

    Each byte is one character (Latin-1), so noise stays readable and never fails to decode.
    """

    def __init__(self, *, limit_bytes: int = LIMIT_BYTES) -> None:
        self._limit_bytes = limit_bytes
        self._rest = b""
        self._broken = False

    def feed(self, data: bytes) -> Iterator[str]:
        """The lines that `data` completes, without their ends. Take them all before feeding again.

        Raises RemoteProtocolError behind the last good line once a line is longer than the limit, and ever after:
        where lines have no end, nothing that follows can be trusted.
        """
        *whole, self._rest = (self._rest + data).replace(b"\r", b"\n").split(b"\n")
        for line in whole:
            self._check(line)
            if line:
                yield line.decode("latin-1")
        self._check(self._rest)

    def _check(self, line: bytes) -> None:
        self._broken = self._broken or len(line) > self._limit_bytes
        if self._broken:
            self._rest = b""
            raise RemoteProtocolError(
                f"a line of more than {self._limit_bytes} bytes: check the baud rate and the cable"
            )
