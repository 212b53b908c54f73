"""The sender's side of a conversation with a Dobot Magician, from the first question to the last line."""

from __future__ import annotations

from collections.abc import Sequence

from firmware_protocol.dobot import sentences
from firmware_protocol.dobot.conversation import Conversation, Habits
from firmware_protocol.dobot.kinematics import Flat
from firmware_protocol.dobot.packet import PacketReader
from firmware_protocol.dobot.states import Signal, State
from firmware_protocol.dobot.steps import Turn
from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.session import Event, JobLine


class DobotSession:
    """`firmware_protocol.session.PausableSession` for a Dobot Magician on its serial line (or what carries the same).

    now: the time at which the port was opened. home: home the arm at start-up; before that it does not know where it
    is. up_mm: height of the lifted pen, in the arm's coordinates; the pen is lifted first of all, and whenever a job
    ends. sheet_origin_mm: where the sheet's lower left corner lies on the arm; positions are reported from there.
    answer_within_s: a reply that is later counts as lost. stands_s: an arm that stands still for so long although
    commands wait is stuck.

    Lines of a job are commands as text (`commands.parse`), all for the arm's queue. At most two places less than the
    arm states are filled; what is executed is what 246 says, by `>=`. A command without acknowledgement is sent again
    only when the index of a later one says that it was not taken (`count.Count`). An alarm ends the job, is named with
    its remedy, and is cleared only where the arm still knows its place, to lift the pen. After every end but FINISHED,
    STOPPED and REJECTED the session is over: open the port again. Nothing of this has been tried on an arm.
    """

    def __init__(
        self,
        *,
        now: float,
        home: bool,
        up_mm: float,
        silent_after_s: float = 5.0,
        answer_within_s: float = 0.3,
        home_within_s: float = 120.0,
        stands_s: float = 3.0,
        sheet_origin_mm: Flat = (0.0, 0.0),
    ) -> None:
        habits = Habits(home, up_mm, silent_after_s, answer_within_s, home_within_s, stands_s, sheet_origin_mm)
        self._reader = PacketReader()
        self._talk = Conversation(habits, now=now)

    @property
    def state(self) -> State:
        """Where the conversation stands."""
        return self._talk.state

    @property
    def firmware(self) -> str | None:
        """What the arm calls itself; None until it has answered."""
        return self._talk.firmware or None

    @property
    def queue_depth(self) -> int:
        """Places in the arm's queue, as it has stated."""
        return self._talk.queue.depth

    def receive(self, data: bytes, now: float) -> list[Event]:
        """See `Session.receive`. Never raises: what is no packet is passed over."""
        talk = self._talk
        talk.now = now
        talk.noise = talk.noise or bool(data)
        for packet in self._reader.feed(data):
            talk.hear(packet)
        return self._told()

    def expire(self, now: float) -> list[Event]:
        """See `Session.expire`."""
        talk = self._talk
        talk.now = now
        if talk.exchange.overdue(now):
            # A damaged length may make the reader wait for bytes that never come, with the reply inside them.
            for packet in self._reader.give_up():
                talk.hear(packet)
        talk.pass_time()
        return self._told()

    def deadline(self) -> float | None:
        """See `Session.deadline`."""
        return self._talk.deadline()

    def data_to_send(self, now: float) -> bytes:
        """See `Session.data_to_send`."""
        talk = self._talk
        talk.now = now
        data, talk.parting = talk.parting, b""
        return data + talk.exchange.take(now)

    def start(self, job: Sequence[JobLine], now: float) -> None:
        """See `Session.start`. Raises LocalProtocolError when none may start or a line is not for the queue."""
        self._talk.now = now
        self._talk.begin(job)

    def stop(self, now: float) -> None:
        """See `Session.stop`; without a job, and while one is already ending, it changes nothing."""
        self._talk.now = now
        self._talk.go(Turn(Signal.STOP, sentences.STOPPED))

    def pause(self, now: float, *, at_once: bool = False) -> None:
        """See `PausableSession.pause`. The stroke is the last one that is in the arm's queue, unless at_once."""
        talk = self._talk
        talk.now = now
        if talk.state is not State.DRAWING:
            return
        if at_once:
            talk.go(Turn(Signal.HOLD))
        else:
            talk.job.stop_at_stroke_end()

    def resume(self, now: float) -> None:
        """See `PausableSession.resume`. Raises LocalProtocolError when the job is not paused."""
        talk = self._talk
        talk.now = now
        if talk.state is not State.PAUSED:
            raise LocalProtocolError(f"the arm is not paused ({talk.state.value}): pause it first")
        talk.go(Turn(Signal.RESUME))

    def unplugged(self, now: float) -> list[Event]:
        """See `Session.unplugged`."""
        self._talk.now = now
        self._talk.go(Turn(Signal.UNPLUG, sentences.UNPLUGGED, position_known=False))
        return self._told()

    @property
    def strokes_touched(self) -> int:
        """See `Session.strokes_touched`: a line counts from the moment on in which it is the next to go."""
        return self._talk.on_paper[1]

    @property
    def strokes_certain(self) -> int:
        """See `Session.strokes_certain`."""
        return self._talk.on_paper[0]

    def _told(self) -> list[Event]:
        events, self._talk.events = self._talk.events, []
        return events
