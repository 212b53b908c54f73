"""Who broke the rule: we, or the device."""

from __future__ import annotations


class ProtocolError(Exception):
    """A rule of the protocol was broken. Nothing else is raised by a parser or a session."""


class LocalProtocolError(ProtocolError):
    """We asked for something that the protocol does not allow in this state."""


class RemoteProtocolError(ProtocolError):
    """The device said something that the protocol does not allow."""
