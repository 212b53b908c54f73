"""Which picture comes first, by its name."""

from __future__ import annotations

import re
from typing import Literal, TypeAlias

Order: TypeAlias = Literal["arrival", "name", "priority"]
Rank: TypeAlias = tuple[tuple[int, str], ...]
"""The lower comes first; equals come in the order in which they arrived."""

_LAST = 10_000
_PREFIX = re.compile(r"(\d{1,4})-")


def rank(name: str, order: Order) -> Rank:
    """ "name": as people sort, 2 before 10; "priority": 1-NAME before 2-NAME before NAME; "arrival": all alike."""
    if order == "name":
        parts = re.split(r"(\d+)", name.casefold())
        return tuple((int(part), "") if part.isdecimal() else (-1, part) for part in parts)
    if order == "priority":
        prefix = _PREFIX.match(name)
        return ((int(prefix[1]) if prefix else _LAST, ""),)
    return ()
