"""Mending: a USB adapter that has wedged is reset, where the settings allow it."""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Sequence

from daemon import usb
from daemon.config import Machine
from daemon.errors import NoMachine
from daemon.jobs.open_machine import Open, OpenMachine
from daemon.machine.ports import RESETTABLE_IDS, USB_URL
from daemon.machine.serial_port import Adapter, adapters
from firmware_protocol.session import Event, NotReady, Ready


class Mending:
    """`opened` opens the way to the machine; after one that stayed mute it resets the adapter first, once.

    A CH340 or CP210x can stop passing bytes, and then only begins anew when it is unplugged or reset. Whether the
    adapter has wedged or the machine is off cannot be told apart, so one reset is tried, and none more until the
    machine has answered. ports, reset: the serial adapters, and how the device at a place is reset.
    """

    def __init__(
        self,
        machine: Machine,
        opened: Open,
        *,
        say: Callable[..., None],
        ports: Callable[[], Sequence[Adapter]] = adapters,
        reset: Callable[[str], None] = usb.reset,
    ) -> None:
        self._machine, self._opened, self._say, self._ports, self._reset = machine, opened, say, ports, reset
        self._mute = self._spoke = self._tried = False

    def opened(self, hear: Callable[[Event], None], still: bool) -> OpenMachine:
        """As the `opened` that was given. Raises NoMachine, also while the port is coming back."""
        if self._machine.may_reset_usb and self._mute and not self._tried:
            self._mend()
        self._mute = self._spoke = False

        def heard(event: Event) -> None:
            self._note(event)
            hear(event)

        return self._opened(heard, still)

    def _note(self, event: Event) -> None:
        if isinstance(event, Ready):
            self._tried = False
        self._mute = isinstance(event, NotReady) and not self._spoke
        self._spoke = self._spoke or not isinstance(event, NotReady)

    def _mend(self) -> None:
        adapter = self._adapter()
        if adapter is None:
            return
        self._tried = True
        try:
            self._reset(adapter.place.partition(":")[0])
        except NoMachine as error:
            self._say(str(error), level=logging.WARNING)
        else:
            self._say("the machine was mute, so its USB adapter has been reset", port=adapter.path)

    def _adapter(self) -> Adapter | None:
        """That of the machine, where it is one that wedges and no other can be meant."""
        url, found = self._machine.url, [port for port in self._ports() if (port.vid, port.pid) in RESETTABLE_IDS]
        if url.startswith(USB_URL):
            found = [port for port in found if port.place.partition(":")[0] == url.removeprefix(USB_URL)]
        elif url.startswith("serial://"):
            path = os.path.realpath(url.removeprefix("serial://"))
            found = [port for port in found if os.path.realpath(port.path) == path]
        elif url != "auto":
            return None
        return found[0] if len(found) == 1 else None
