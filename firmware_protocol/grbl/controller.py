"""What a GRBL controller has said of itself: firmware, buffers, settings, offset, lock."""

from __future__ import annotations

from firmware_protocol.grbl.replies import Banner, Message, Options, Reply, Setting, StatusReport, Triple, Version

MM_PER_INCH = 25.4
REPORTS_INCHES = 13
"""The setting that makes all reports inches."""


class Controller:
    """Filled by `learn`; before that it is a Grbl 1.1 on an Arduino Uno."""

    def __init__(self) -> None:
        self.firmware: str | None = None
        self.settings: dict[int, float] = {}
        self.buffer_bytes = 128
        self.planner_blocks = 15
        self.locked = False
        self._offset: Triple = (0.0, 0.0, 0.0)

    @property
    def outdated(self) -> bool:
        """It speaks GRBL 0.x, whose reports have another form."""
        return self.firmware is not None and self.firmware.split(" ")[-1].startswith("0.")

    @property
    def displaced_mm(self) -> tuple[float, float]:
        """Where a work offset (G54, G92) puts X0 Y0, in machine coordinates; (0, 0) where none is stored."""
        x, y, _ = self._offset
        unit_mm = MM_PER_INCH if self.settings.get(REPORTS_INCHES) == 1 else 1.0
        return x * unit_mm, y * unit_mm

    def learn(self, reply: Reply) -> None:
        """Keep what `reply` tells; other replies tell nothing lasting."""
        match reply:
            case Banner():
                self.firmware, self.locked = reply.firmware, False
            case Version():
                product = (self.firmware or "Grbl").split(" ")[0]
                self.firmware = f"{product} {reply.version}"
            case Options():
                self.planner_blocks = reply.planner_blocks
                self.buffer_bytes = reply.buffer_bytes or self.buffer_bytes
            case Setting():
                self.settings[reply.number] = reply.value
            case Message():
                self.locked = self.locked or reply.locked
            case StatusReport():
                self.locked = reply.state == "Alarm"
                self._offset = reply.offset or self._offset

    def position_mm(self, report: StatusReport) -> Triple | None:
        """Where the pen is, in the coordinates that G-code speaks; None when the report does not say."""
        unit_mm = MM_PER_INCH if self.settings.get(REPORTS_INCHES) == 1 else 1.0
        if report.work:
            x, y, z = report.work
        elif report.machine:
            x, y, z = (place - offset for place, offset in zip(report.machine, self._offset, strict=True))
        else:
            return None
        return x * unit_mm, y * unit_mm, z * unit_mm
