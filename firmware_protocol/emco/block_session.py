"""The sender's side of a transfer in which every block is acknowledged before the next one is sent."""

from __future__ import annotations

from collections.abc import Sequence

from firmware_protocol.emco import sentences
from firmware_protocol.emco.answers import Answer, AnswerReader
from firmware_protocol.emco.conversation import UNKNOWN, Control, Conversation
from firmware_protocol.emco.job import Times
from firmware_protocol.emco.states import SENDING, Signal
from firmware_protocol.emco.transfer import Transfer
from firmware_protocol.session import Accepted, Event, JobLine


class BlockSession(Transfer):
    """`firmware_protocol.session.Session` for controls and DNC boxes that acknowledge each block; also over TCP.

    ack, nak: the answers, as bytes anywhere in the stream or, where they are text such as `ok`, as a line of their
    own. A nak asks for the same block again, `retries` times at most. answer_within_s: how long an answer may take
    beside the motion of all blocks so far; nothing is ever sent twice without a nak, for it may have been drawn.
    times: the time model.

    An acknowledged block is not drawn yet, so `Sent` and the end, an estimate, are two things here too. That WinNC
    speaks this is said by no document. After an end with an unknown position the session is over.
    """

    def __init__(
        self,
        *,
        now: float,
        times: Times,
        ack: bytes = b"\x06",
        nak: bytes = b"\x15",
        answer_within_s: float = 10.0,
        retries: int = 3,
        control: Control = UNKNOWN,
    ) -> None:
        """Raises LocalProtocolError for lines that cannot be sent, ValueError for answers that cannot be told apart."""
        name = "control without a name (acknowledged blocks)"
        super().__init__(Conversation(control, now=now, times=times, name=name), most_bytes=1)
        self._reader = AnswerReader(ack=ack, nak=nak)
        self._answer_within_s, self._retries, self._holds_blocks = answer_within_s, retries, control.holds_blocks
        self._owed = self._again = False
        """A block is unanswered; it is to be sent again."""
        self._refusals = 0
        self._late_at = float("inf")

    def receive(self, data: bytes, now: float) -> list[Event]:
        """See `Session.receive`. Never raises: what is no answer is kept for the sentence of an error."""
        self._talk.now = now
        for answer in self._reader.feed(data):
            self._answered(answer)
        return self._talk.told()

    def expire(self, now: float) -> list[Event]:
        """See `Session.expire`."""
        talk = self._talk
        talk.now = now
        if talk.state in SENDING and self._owed and now >= self._late_at and talk.job is not None:
            block = talk.job.handed
            why = sentences.unanswered(self._answer_within_s, block + 1, talk.job.text(block), self._reader.other)
            talk.go(Signal.LATE, why)
        talk.expire(now)
        return talk.told()

    def deadline(self) -> float | None:
        """See `Session.deadline`."""
        times = self._talk.deadline()
        if self._talk.state in SENDING:
            times.append(self._late_at if self._owed and not self._again else self._talk.now)
        return min(times, default=None)

    def data_to_send(self, now: float) -> bytes:
        """See `Session.data_to_send`: one block when the one before has been answered."""
        talk = self._talk
        talk.now = now
        if talk.state not in SENDING or talk.job is None or (self._owed and not self._again):
            return b""
        job, again = talk.job, self._again
        self._owed, self._again = True, False
        data = job.blocks[job.handed] if again else job.take(len(job.blocks[job.handed]))
        self._late_at = max(now, job.drawn_at) + job.seconds(job.handed) + self._answer_within_s
        return data

    def start(self, job: Sequence[JobLine], now: float) -> None:
        """See `Session.start`. Raises LocalProtocolError when the control takes no job or a line cannot be sent."""
        self._talk.now = now
        self._talk.begin(job)
        self._owed = self._again = False
        self._refusals = 0
        self._talk.go(Signal.GO)
        self._finish_if_empty()

    def _answered(self, answer: Answer) -> None:
        if self._talk.state not in SENDING or not self._owed or self._again:
            return
        if answer is Answer.NAK:
            self._refused()
        else:
            self._accepted()

    def _accepted(self) -> None:
        talk = self._talk
        assert talk.job is not None
        block = talk.job.handed
        talk.job.arrived(talk.now)
        self._owed, self._refusals = False, 0
        if block < len(talk.job):
            talk.events.append(Accepted(block))
        if self._holds_blocks is not None:
            talk.job.proven = max(talk.job.proven, talk.job.handed - self._holds_blocks)
        self._finish_if_empty()

    def _finish_if_empty(self) -> None:
        if self._talk.job is not None and self._talk.job.empty:
            self._talk.go(Signal.EMPTY)
        elif self._talk.job is not None and self._talk.job.changes:
            self._talk.go(Signal.CHANGE)

    def _refused(self) -> None:
        self._refusals += 1
        if self._refusals <= self._retries:
            self._again = True
            return
        job = self._talk.job
        assert job is not None
        self._talk.go(Signal.REFUSED, sentences.refused(self._refusals, job.handed + 1, job.text(job.handed)))
