"""A button at a pin of the board. The only door to gpiod, version 2, which is an extra."""

from __future__ import annotations

import errno
import os
from collections.abc import Callable
from dataclasses import dataclass
from datetime import timedelta
from typing import Any, Literal

from daemon.intake.button import ButtonTrouble

_NO_LIBRARY = "a button at a pin needs the library gpiod, version 2: `pip install 'linedrawd[gpio]'`"


@dataclass(frozen=True, slots=True)
class Wiring:
    """chip: the file of the pins' chip. line: at the chip, by its number or name.

    pull: "up": the board pulls the pin up and the button connects it with ground; "down": the other way round;
    "none": a resistor outside pulls it up. Changes that last shorter than debounce_s are none.
    """

    chip: str
    line: int | str
    pull: Literal["up", "down", "none"] = "up"
    debounce_s: float = 0.03


def gpiod() -> Any:
    """The library. Raises ButtonTrouble where there is none, or an older one, as Debian 12's python3-libgpiod."""
    try:
        import gpiod  # noqa: PLC0415 - an extra
        import gpiod.line  # noqa: PLC0415
    except ImportError:
        raise ButtonTrouble(_NO_LIBRARY) from None
    if not hasattr(gpiod, "request_lines"):
        raise ButtonTrouble(f"the library gpiod that is installed here is too old: {_NO_LIBRARY.partition(': ')[2]}")
    return gpiod


class PinButton:
    """A `Button`. library: brings gpiod, or raises ButtonTrouble."""

    def __init__(self, wiring: Wiring, *, library: Callable[[], Any] = gpiod) -> None:
        self._wiring, self._library = wiring, library
        self._request: Any = None

    def open(self) -> int:
        """As `Button.open`."""
        self.close()
        library, wiring = self._library(), self._wiring
        try:
            self._request = library.request_lines(
                wiring.chip, consumer="linedrawd", config={wiring.line: _settings(library, wiring)}
            )
            return int(self._request.fd)
        except (OSError, ValueError) as error:
            raise ButtonTrouble(_why(error, wiring)) from None

    def pressed(self) -> bool:
        """As `Button.pressed`."""
        if self._request is None:
            return False
        pressed = False
        try:
            while self._request.wait_edge_events(0):
                pressed = bool(self._request.read_edge_events()) or pressed
        except OSError as error:
            raise ButtonTrouble(_why(error, self._wiring)) from None
        return pressed

    def close(self) -> None:
        """As `Button.close`."""
        request, self._request = self._request, None
        if request is not None:
            request.release()


def _settings(library: Any, wiring: Wiring) -> Any:
    """The edge at which it is pressed, and no other."""
    line = library.line
    pulls = {"up": line.Bias.PULL_UP, "down": line.Bias.PULL_DOWN, "none": line.Bias.AS_IS}
    return library.LineSettings(
        direction=line.Direction.INPUT,
        edge_detection=line.Edge.RISING,
        bias=pulls[wiring.pull],
        active_low=wiring.pull != "down",
        debounce_period=timedelta(seconds=wiring.debounce_s),
    )


def _why(error: Exception, wiring: Wiring) -> str:
    chip, line = wiring.chip, wiring.line
    if isinstance(error, PermissionError):
        return (
            f"the pins at {chip} may not be used: `sudo adduser USER gpio` and log in again; the service needs the "
            "drop-in gpio.conf"
        )
    number = getattr(error, "errno", None)
    if number == errno.EBUSY:
        return f"line {line} at {chip} is in use by another program: end that (`gpioinfo` names it), or take another"
    if isinstance(error, ValueError) or (number == errno.ENOENT and os.path.exists(chip)):
        return f"{chip} has no line {line}: `gpioinfo` lists those it has; correct line or path in [button]"
    if number in (errno.ENOENT, errno.ENODEV, errno.ENXIO, errno.ENOTTY):
        return f"there are no pins at {chip}: `ls /dev/gpiochip*` lists the chips; correct path in [button]"
    return f"line {line} at {chip} cannot be used ({error}): set another line, pull or path in [button]"
