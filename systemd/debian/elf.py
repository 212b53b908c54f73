"""Libraries that the daemon never calls are replaced by empty ones, and what asks for them gets by without."""

from __future__ import annotations

import struct
from collections.abc import Iterator

_HEADER = struct.Struct("<16sHHIQQQIHHHHHH")
_SEGMENT = struct.Struct("<IIQQQQQQ")
_SECTION = struct.Struct("<IIQQQQIIQQ")
_SYMBOL = struct.Struct("<IBBHQQ")
_ENTRY = struct.Struct("<qQ")
_LOAD, _DYNAMIC, _STACK = 1, 2, 0x6474E551
_STRTAB, _SYMTAB, _STRSZ, _SYMENT = 5, 6, 10, 11
_DYNSYM, _WEAK, _SHARED = 11, 2, 3
_PAGE = 0x10000


def empty(library: bytes) -> bytes:
    """A library for the same processor that offers nothing and needs nothing. Raises ValueError for another file."""
    machine = _read(library)[2]
    entries = _HEADER.size + 3 * _SEGMENT.size
    symbols = entries + 5 * _ENTRY.size
    strings = symbols + _SYMBOL.size
    size = strings + 1
    dynamic = ((_STRTAB, strings), (_SYMTAB, symbols), (_STRSZ, 1), (_SYMENT, _SYMBOL.size), (0, 0))
    where = (entries, entries, entries, symbols - entries, symbols - entries, 8)
    return b"".join(
        (
            _HEADER.pack(
                library[:16], _SHARED, machine, 1, 0, _HEADER.size, 0, 0, _HEADER.size, _SEGMENT.size, 3, 0, 0, 0
            ),
            _SEGMENT.pack(_LOAD, 6, 0, 0, 0, size, size, _PAGE),
            _SEGMENT.pack(_DYNAMIC, 6, *where),
            _SEGMENT.pack(_STACK, 6, 0, 0, 0, 0, 0, 16),
            *(_ENTRY.pack(*entry) for entry in dynamic),
            bytes(_SYMBOL.size + 1),
        )
    )


def without(library: bytes, prefixes: tuple[str, ...]) -> bytes:
    """The same library, which loads also where nobody offers the functions whose names begin so.

    What it wants of them becomes weak: a call would end the process, as they are not there.
    """
    weaker = bytearray(library)
    for offset, name, (name_at, kind, other, section, value, size) in _symbols(library):
        if section == 0 and name.startswith(prefixes):
            _SYMBOL.pack_into(weaker, offset, name_at, _WEAK << 4 | kind & 15, other, section, value, size)
    return bytes(weaker)


def wanted(library: bytes) -> set[str]:
    """The names that it cannot do without, and looks for in others."""
    return {name for _, name, symbol in _symbols(library) if symbol[3] == 0 and symbol[1] >> 4 != _WEAK and name}


def _symbols(library: bytes) -> Iterator[tuple[int, str, tuple[int, ...]]]:
    """Where each symbol for the loader lies in the file, its name and its fields."""
    header = _read(library)
    at, size, count = header[6], header[11], header[12]
    sections = [_SECTION.unpack_from(library, at + index * size) for index in range(count)]
    for _, kind, _, _, offset, length, strings, *_ in sections:
        if kind == _DYNSYM:
            names = sections[strings][4]
            for place in range(offset, offset + length, _SYMBOL.size):
                symbol = _SYMBOL.unpack_from(library, place)
                begin = names + symbol[0]
                yield place, library[begin : library.index(0, begin)].decode(), symbol


def _read(library: bytes) -> tuple[int, ...]:
    if library[:6] != b"\x7fELF\x02\x01":
        raise ValueError("no library of a 64-bit processor that counts its bytes from the lowest")
    return _HEADER.unpack_from(library)
