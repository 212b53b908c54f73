"""What can go wrong with a simulated arm, on request.

An acknowledgement is the reply to a command for the queue, an answer the reply to anything else; each of the two is
counted from 0 since the port was opened, whether it was lost or not.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from firmware_protocol.simulator import Moment


@dataclass(frozen=True, slots=True)
class _Reply:
    """index: of the acknowledgement, or with `answers` of the answer."""

    index: int
    answers: bool = False


@dataclass(frozen=True, slots=True)
class DropReply(_Reply):
    """It never arrives; what it replies to has been done."""


@dataclass(frozen=True, slots=True)
class DelayReply(_Reply):
    """It comes `by_s` later."""

    by_s: float = 0.0


@dataclass(frozen=True, slots=True)
class CorruptReply(_Reply):
    """One byte of it arrives with these bits turned over."""

    bits: int = 0x10


@dataclass(frozen=True, slots=True)
class StrayByte(_Reply):
    """An AA that belongs to nothing arrives right before it."""


@dataclass(frozen=True, slots=True)
class CorruptRequest:
    """The command for the queue with this number arrives damaged, so the arm drops it without a word."""

    index: int


@dataclass(frozen=True, slots=True)
class ClosePort(Moment):
    """The cable is pulled; the arm goes on with what is in its queue."""


@dataclass(frozen=True, slots=True)
class PowerCut(Moment):
    """The arm restarts by itself: queue and position are lost, alarm 0x00 stands, and for a while it is deaf."""


@dataclass(frozen=True, slots=True)
class Hang(Moment):
    """The arm stops and says nothing more, until it is switched off and on."""


@dataclass(frozen=True, slots=True)
class StopQueue(Moment):
    """The queue stands still after the running command, without an alarm."""


@dataclass(frozen=True, slots=True)
class RaiseAlarm(Moment):
    """An alarm comes up, 0x50 (lost step of joint 1) unless stated otherwise, and the motion stops."""

    code: int = 0x50


ReplyFault: TypeAlias = DropReply | DelayReply | CorruptReply | StrayByte
Timed: TypeAlias = ClosePort | PowerCut | Hang | StopQueue | RaiseAlarm
Fault: TypeAlias = ReplyFault | CorruptRequest | Timed
