"""A key of a keyboard, a keypad or a foot switch that types, as the kernel tells of it (Linux input.h, evdev)."""

from __future__ import annotations

import fcntl
import os
import struct
from collections.abc import Callable, Iterator

from daemon.intake.button import ButtonTrouble
from daemon.intake.keys import MOST

_EVENT = struct.Struct("llHHi")
"""struct input_event: seconds, microseconds, type, code, value; 24 bytes where a long has 64 bits."""
_KEY, _DOWN = 1, 1
"""EV_KEY; the value of a key that goes down. 0 is one that comes up, 2 one that is still held."""
_KEY_BYTES = MOST // 8 + 1
_EVIOCGBIT_KEY = 2 << 30 | _KEY_BYTES << 16 | ord("E") << 8 | 0x20 + _KEY
_EVIOCGRAB = 1 << 30 | 4 << 16 | ord("E") << 8 | 0x90
_AT_ONCE = 64


def keys_at(opened: int) -> frozenset[int]:
    """The codes of the keys that a keyboard has. Raises OSError where that is none."""
    held = bytearray(_KEY_BYTES)
    fcntl.ioctl(opened, _EVIOCGBIT_KEY, held)
    return frozenset(code for code in range(MOST + 1) if held[code // 8] >> code % 8 & 1)


class KeyButton:
    """A `Button`. path: below /dev/input, best /dev/input/by-id/NAME-event-kbd. code: of the key; None is any.

    grab: what is typed there goes nowhere else. keys_at: which keys are at an open file.
    """

    def __init__(
        self, path: str, code: int | None, *, grab: bool = False, keys_at: Callable[[int], frozenset[int]] = keys_at
    ) -> None:
        self._path, self._code, self._grab, self._keys_at = path, code, grab, keys_at
        self._opened, self._rest = -1, b""

    def open(self) -> int:
        """As `Button.open`."""
        self.close()
        try:
            self._opened = os.open(self._path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
        except PermissionError:
            raise ButtonTrouble(
                f"the keyboard {self._path} may not be read: `sudo adduser USER input` and log in again; the service "
                "needs the drop-in keyboard.conf"
            ) from None
        except OSError:
            raise self._missing() from None
        self._check()
        if self._grab:
            self._take()
        return self._opened

    def pressed(self) -> bool:
        """As `Button.pressed`."""
        return any([self._is_press(*event) for event in self._events()])

    def close(self) -> None:
        """As `Button.close`."""
        opened, self._opened, self._rest = self._opened, -1, b""
        if opened >= 0:
            os.close(opened)

    def _check(self) -> None:
        try:
            keys = self._keys_at(self._opened)
        except OSError:
            raise ButtonTrouble(
                f"{self._path} is no keyboard: set path in [button] to one of those in /dev/input/by-id"
            ) from None
        if not keys or (self._code is not None and self._code not in keys):
            what = "keys" if self._code is None else f"key of the number {self._code}"
            raise ButtonTrouble(
                f"the keyboard {self._path} has no {what}: correct key or path in [button]; many a keypad has "
                "several files in /dev/input/by-id"
            )

    def _take(self) -> None:
        try:
            fcntl.ioctl(self._opened, _EVIOCGRAB, 1)
        except OSError:
            raise ButtonTrouble(
                f"another program has the keyboard {self._path} to itself: end that, or set grab = false in [button]"
            ) from None

    def _events(self) -> Iterator[tuple[int, int, int]]:
        """Type, code and value of each that has come."""
        came = self._rest + b"".join(self._reads())
        whole = len(came) - len(came) % _EVENT.size
        self._rest = came[whole:]
        return ((kind, code, value) for _, _, kind, code, value in _EVENT.iter_unpack(came[:whole]))

    def _reads(self) -> Iterator[bytes]:
        while True:
            try:
                read = os.read(self._opened, _AT_ONCE * _EVENT.size)
            except BlockingIOError:
                return
            except OSError:
                raise self._missing() from None
            if not read:
                raise self._missing()
            yield read

    def _is_press(self, kind: int, code: int, value: int) -> bool:
        return kind == _KEY and value == _DOWN and self._code in (None, code)

    def _missing(self) -> ButtonTrouble:
        return ButtonTrouble(
            f"there is no keyboard at {self._path}: plug it in; `ls /dev/input/by-id` lists those there are, for path "
            "in [button]"
        )
