"""The sender's side of a plain serial transfer to an EMCO control: XON and XOFF, obeyed here and not in the driver."""

from __future__ import annotations

from collections.abc import Sequence

from firmware_protocol.emco import sentences
from firmware_protocol.emco.block_session import BlockSession
from firmware_protocol.emco.conversation import UNKNOWN, Control, Conversation
from firmware_protocol.emco.job import Times
from firmware_protocol.emco.line_format import lower_seven, with_even_parity
from firmware_protocol.emco.states import SENDING, Signal, State
from firmware_protocol.emco.transfer import Transfer
from firmware_protocol.session import Event, JobLine

__all__ = ["XOFF", "XON", "BlockSession", "Control", "XonXoffSession"]

XON, XOFF = 0x11, 0x13

_SIGNALS = {XON: Signal.GO, XOFF: Signal.HOLD}
_IN_FLIGHT_CHUNKS = 2
"""What may be on the wire when a character of the control is heard."""


class XonXoffSession(Transfer):
    """`firmware_protocol.session.Session` for a control that reads a serial line and says nothing but XON and XOFF.

    bytes_per_s: of the line, see `line_format`; never more than chunk_bytes are written at once, and no faster, so
    that nothing waits in a driver when XOFF comes. wait_for_xon: send nothing before the control's first XON, which
    comes when a person presses START there. xoff_limit_s: after an XOFF that lasts this long the job is over.
    seven_bit: even parity is made and removed here, for a port that is set to 8 bits. times: the time model.

    The control never says what it has drawn: `Sent` tells that it has everything, and the end is an estimate, which
    claims no more strokes for certain than the control's XON and XOFF have proven. After an end with an unknown
    position the session is over: open the port again. Methods: XON/XOFF as in Fanuc, Siemens and Haas manuals; no
    document says that WinNC obeys it.
    """

    def __init__(
        self,
        *,
        now: float,
        bytes_per_s: float,
        times: Times,
        wait_for_xon: bool = True,
        chunk_bytes: int = 16,
        xoff_limit_s: float = 300.0,
        seven_bit: bool = False,
        control: Control = UNKNOWN,
    ) -> None:
        """Raises LocalProtocolError for lines that cannot be sent, ValueError for a speed or chunk of nothing."""
        if bytes_per_s <= 0 or chunk_bytes < 1:
            raise ValueError(f"bytes_per_s = {bytes_per_s} and chunk_bytes = {chunk_bytes} must be above 0")
        name = "control without a name (XON/XOFF)"
        super().__init__(Conversation(control, now=now, times=times, name=name), most_bytes=chunk_bytes)
        self._bytes_per_s = bytes_per_s
        self._wait_for_xon, self._xoff_limit_s = wait_for_xon, xoff_limit_s
        self._seven_bit, self._holds_bytes = seven_bit, control.holds_bytes
        self._asked_for = False
        """An XON came between jobs: somebody has pressed START."""
        self._free_at = now
        """When all that was written has left the wire."""

    def receive(self, data: bytes, now: float) -> list[Event]:
        """See `Session.receive`. Never raises: what is neither XON nor XOFF is passed over."""
        talk = self._talk
        talk.now = now
        for byte in lower_seven(data) if self._seven_bit else data:
            if (signal := _SIGNALS.get(byte)) is not None:
                self._heard(signal)
        return talk.told()

    def expire(self, now: float) -> list[Event]:
        """See `Session.expire`."""
        talk = self._talk
        talk.now = now
        if talk.state is State.HELD and now >= talk.since + self._xoff_limit_s:
            talk.go(Signal.LATE, sentences.held(self._xoff_limit_s))
        elif talk.state in SENDING and talk.job is not None:
            if talk.job.empty and now >= self._free_at:
                talk.go(Signal.EMPTY)
            elif talk.job.changes and now >= self._free_at:
                talk.go(Signal.CHANGE)
            else:
                self._check_ears(now)
        talk.expire(now)
        return talk.told()

    def deadline(self) -> float | None:
        """See `Session.deadline`."""
        talk = self._talk
        times = talk.deadline()
        if talk.state in SENDING:
            times.append(self._free_at)
        elif talk.state is State.HELD:
            times.append(talk.since + self._xoff_limit_s)
        return min(times, default=None)

    def data_to_send(self, now: float) -> bytes:
        """See `Session.data_to_send`: one chunk when the wire is free."""
        talk = self._talk
        talk.now = now
        if talk.state not in SENDING or talk.job is None or now < self._free_at:
            return b""
        data = talk.job.take(self._most_bytes)
        self._free_at = now + len(data) / self._bytes_per_s
        talk.job.arrived(self._free_at)
        return with_even_parity(data) if self._seven_bit else data

    def start(self, job: Sequence[JobLine], now: float) -> None:
        """See `Session.start`. Raises LocalProtocolError when the control takes no job or a line cannot be sent."""
        talk = self._talk
        talk.now = now
        talk.begin(job)
        if self._asked_for or not self._wait_for_xon:
            talk.go(Signal.GO)
        else:
            talk.wait_for_a_person()
        self._asked_for = False

    def _heard(self, signal: Signal) -> None:
        talk = self._talk
        if talk.state is State.READY:
            self._asked_for = signal is Signal.GO
        elif talk.job is not None and self._holds_bytes is not None:
            talk.job.prove(bytes_held=self._holds_bytes + self._in_flight_bytes)
        talk.go(signal)

    def _check_ears(self, now: float) -> None:
        """A control that reads and draws would have sent XOFF before it held more than it can."""
        if self._holds_bytes is None or self._talk.job is None:
            return
        held = self._talk.job.held_by_control(now)
        if held > self._holds_bytes + self._in_flight_bytes:
            self._talk.go(Signal.LATE, sentences.deaf(held, self._holds_bytes))

    @property
    def _in_flight_bytes(self) -> int:
        return _IN_FLIGHT_CHUNKS * self._most_bytes
