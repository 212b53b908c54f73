"""What was found on a page is remembered for as long as the page lives: several rooms ask the same of it."""

from __future__ import annotations

import weakref
from collections import deque
from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

from daemon.shapes import Grey

Found = TypeVar("Found")

_LAST = 4


def remembered(look: Callable[[Grey], Found]) -> Callable[[Grey], Found]:
    """The same look at a page, taken once; of the last few pages. A page is a value: nobody changes its pixels."""
    known: deque[tuple[weakref.ref[Any], Found]] = deque(maxlen=_LAST)

    @wraps(look)
    def asked(grey: Grey) -> Found:
        for page, found in known:
            if page() is grey:
                return found
        found = look(grey)
        known.append((weakref.ref(grey), found))
        return found

    return asked
