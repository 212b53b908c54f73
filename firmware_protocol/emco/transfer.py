"""What a session does in the same way on every kind of link to a control."""

from __future__ import annotations

from firmware_protocol.emco import sentences
from firmware_protocol.emco.conversation import Conversation
from firmware_protocol.emco.states import Signal, State
from firmware_protocol.session import Event


class Transfer:
    """One conversation. most_bytes: that may leave at once, of which it is not known whether the control takes them."""

    def __init__(self, talk: Conversation, *, most_bytes: int) -> None:
        self._talk, self._most_bytes = talk, most_bytes

    @property
    def state(self) -> State:
        """Where the conversation stands."""
        return self._talk.state

    def stop(self, now: float) -> None:
        """See `Session.stop`; what the control already holds is drawn all the same."""
        self._talk.now = now
        self._talk.stop()

    def resume(self, now: float) -> None:
        """See `ResumableSession.resume`: after a pen change, the only pause that can be made from here."""
        self._talk.now = now
        self._talk.resume()

    def unplugged(self, now: float) -> list[Event]:
        """See `Session.unplugged`."""
        self._talk.now = now
        self._talk.go(Signal.UNPLUG, sentences.UNPLUGGED)
        return self._talk.told()

    @property
    def strokes_touched(self) -> int:
        """See `Session.strokes_touched`."""
        return 0 if self._talk.job is None else self._talk.job.touched(most=self._most_bytes)

    @property
    def strokes_certain(self) -> int:
        """See `Session.strokes_certain`."""
        return 0 if self._talk.job is None else self._talk.job.certain
