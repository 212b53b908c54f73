"""The way to a simulated machine, with a clock of its own: minutes of drawing pass in seconds."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping, Sequence
from urllib.parse import parse_qsl, urlsplit

from daemon.errors import MachineFault, SettingsError, Unplugged
from firmware_protocol.crooked import Crooked
from firmware_protocol.grbl.simulator.faults import (
    BrownOut,
    DropByte,
    Fault,
    FlipByte,
    Hang,
    HardLimit,
    LoseOk,
    SlowUsb,
    Timed,
    Unplug,
)
from firmware_protocol.grbl.simulator.simulator import GrblSimulator
from firmware_protocol.ink import PenRule, Polyline
from firmware_protocol.simulator import Simulator

_AT: Mapping[str, type[Timed]] = {"hang": Hang, "brownout": BrownOut, "limit": HardLimit, "unplug": Unplug}
_NUMBERED: Mapping[str, type[DropByte | FlipByte | LoseOk]] = {"drop": DropByte, "flip": FlipByte, "lose_ok": LoseOk}
_OTHER = ("speed", "boot_s", "pen_z", "pen_s", "switches", "scale", "skew", "backlash")
_EXAMPLE = "sim://grbl?speed=1&pen_z=0&110=3000&hang=2.5"


class SimulatedTransport:
    """A `Transport` on a simulator. Opening it resets the machine, as opening a serial port does.

    speed: 0 lets the clock jump to the next event, 1 keeps it at real time, 10 makes it ten times as fast.
    """

    def __init__(self, simulator: Simulator, *, speed: float = 0.0, name: str = "sim://grbl") -> None:
        self.simulator, self.speed, self._name = simulator, speed, name
        self._now = self._began_s = simulator.now
        self._started_s = time.monotonic()
        self._woken = threading.Event()
        self._closed = False
        simulator.open(self._now)

    @property
    def name(self) -> str:
        return self._name

    @property
    def ink(self) -> Sequence[Polyline]:
        """What is on the sheet: polylines of (x, y) in mm."""
        return self.simulator.ink

    def take_ink(self) -> Sequence[Polyline]:
        """What is on the sheet, and a new sheet for what follows: nobody remembers every sheet of a month."""
        ink = self.simulator.ink
        self.simulator.clear_sheet()
        return ink

    def now(self) -> float:
        if self.speed and not self._closed:
            self._now = max(self._now, self._began_s + (time.monotonic() - self._started_s) * self.speed)
        return self._now

    def read(self, until: float | None) -> bytes:
        """Let simulated time pass until bytes come, the time `until` has come, or `wake` was called.

        Raises MachineFault when the machine has been unplugged.
        """
        while True:
            data = self.simulator.advance(self.now())
            self._check_plugged()
            if data or self._woken.is_set() or (until is not None and self._now >= until):
                self._woken.clear()
                return data
            times = [moment for moment in (self.simulator.next_time(), until) if moment is not None]
            self._pass_until(min(times) if times else None)

    def write(self, data: bytes) -> None:
        self._check_plugged()
        self.simulator.receive(data, self.now())

    def wake(self) -> None:
        self._woken.set()

    def close(self) -> None:
        self._closed = True

    def _pass_until(self, moment: float | None) -> None:
        if moment is None:
            self._woken.wait()
        elif self.speed:
            self._woken.wait(max(0.0, (moment - self.now()) / self.speed))
        else:
            self._now = max(self._now, moment)

    def _check_plugged(self) -> None:
        if self._closed:
            raise MachineFault(f"{self._name} has been closed: open it again")
        if self.simulator.unplugged:
            raise Unplugged(f"{self._name} has been unplugged: plug the machine in again")


def open_simulated(
    url: str, *, settings: Mapping[int, float] | None = None, pen: PenRule | None = None, faults: Sequence[Fault] = ()
) -> SimulatedTransport:
    """Switch the machine that `simulator_of` describes on and open the way to it; `speed` in the query is its speed.

    Raises SettingsError for a URL that cannot be understood.
    """
    return way_to(simulator_of(url, settings=settings, pen=pen, faults=faults), url)


def way_to(simulator: Simulator, url: str) -> SimulatedTransport:
    """Open the way to a simulated machine; `speed` in the query of `url` is its speed. Raises SettingsError."""
    speed = dict(parse_qsl(urlsplit(url).query)).get("speed", "0")
    try:
        return SimulatedTransport(simulator, speed=float(speed), name=url)
    except ValueError as error:
        raise SettingsError(
            f"{url}: speed is {speed}: write a number such as 1, or 0 for as fast as possible"
        ) from error


def simulator_by(simulate: Callable[[Mapping[str, str]], Simulator], url: str) -> Simulator:
    """The simulated machine that `simulate` makes of the options in a URL. Raises SettingsError for a wrong one."""
    options = dict(parse_qsl(urlsplit(url).query, keep_blank_values=True))
    options.pop("speed", None)
    try:
        return simulate(options)
    except ValueError as error:
        raise SettingsError(f"{url}: {error}: correct what stands behind the question mark") from error


def simulator_of(
    url: str, *, settings: Mapping[int, float] | None = None, pen: PenRule | None = None, faults: Sequence[Fault] = ()
) -> GrblSimulator:
    """The simulated machine that a URL such as `sim://grbl?pen_z=0&110=3000&hang=2.5` describes.

    The query may hold `speed`, `boot_s`, the pen (`pen_z` height in mm, or `pen_s=DOWN:UP` values of S), the homing
    `switches=X:Y:Z` in mm from where the pen stands first, in what its axes are crooked (`scale=X:Y`, `skew` in
    degrees, `backlash=X:Y` in mm), `$` settings by number, and faults: `hang`, `brownout`, `limit` and `unplug` in
    seconds, or `@N` for behind the N-th ok; `drop`, `flip` and `lose_ok` by number from 0; `usb_ms` of a slow
    converter. What it says goes before the arguments.
    Raises SettingsError for anything else.
    """
    parts = urlsplit(url)
    if (parts.scheme, parts.netloc) != ("sim", "grbl") or parts.path not in ("", "/"):
        raise SettingsError(f"{url} is no simulated machine: write for example {_EXAMPLE}")
    pairs = parse_qsl(parts.query, keep_blank_values=True)
    try:
        options = {key: value for key, value in pairs if key in _OTHER}
        numbers = {int(key): float(value) for key, value in pairs if key.isdecimal()}
        asked = [_fault(key, value) for key, value in pairs if key not in _OTHER and not key.isdecimal()]
        return GrblSimulator(
            settings={**(settings or {}), **numbers},
            faults=(*faults, *asked),
            pen=_pen(options) or pen,
            boot_s=float(options.get("boot_s", 0)),
            switches_mm=_switches(options["switches"]) if "switches" in options else None,
            crooked=_crooked(options),
        )
    except ValueError as error:
        raise SettingsError(f"{url}: {error}: write for example {_EXAMPLE}") from error


def _fault(key: str, value: str) -> Fault:
    if key in _NUMBERED:
        return _NUMBERED[key](int(value))
    if key == "usb_ms":
        return SlowUsb(float(value) / 1000)
    if key not in _AT:
        raise ValueError(f"there is no option {key}")
    if value.startswith("@"):
        return _AT[key](after_acks=int(value[1:]))
    return _AT[key](at_s=float(value))


def _switches(text: str) -> tuple[float, float, float]:
    x_mm, y_mm, z_mm = map(float, text.split(":"))
    return x_mm, y_mm, z_mm


def _crooked(options: Mapping[str, str]) -> Crooked | None:
    if not {"scale", "skew", "backlash"} & options.keys():
        return None
    scale_x, scale_y = _pair(options.get("scale", "1:1"))
    return Crooked(scale_x, scale_y, float(options.get("skew", 0)), _pair(options.get("backlash", "0:0")))


def _pair(text: str) -> tuple[float, float]:
    x, y = map(float, text.split(":"))
    return x, y


def _pen(options: Mapping[str, str]) -> PenRule | None:
    if "pen_s" in options:
        down, _, up = options["pen_s"].partition(":")
        return PenRule(down_s=float(down), up_s=float(up or 0))
    return PenRule(down_at_mm=float(options["pen_z"])) if "pen_z" in options else None
