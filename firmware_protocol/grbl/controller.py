"""What a GRBL controller has said of itself: firmware, buffers, settings, offset, lock."""

from __future__ import annotations

from firmware_protocol.grbl.path import MM_PER_INCH
from firmware_protocol.grbl.replies import Banner, Message, Options, Reply, Setting, StatusReport, Triple, Version

ARC_TOLERANCE, REPORTS_INCHES, HOMES = 12, 13, 22
"""Settings: how far chords leave their arc in mm; all reports in inches; homing is switched on."""
STEPS_MM = (100, 101, 102)


class Controller:
    """Filled by `learn`; before that it is a Grbl 1.1 on an Arduino Uno."""

    def __init__(self) -> None:
        self.firmware: str | None = None
        self.settings: dict[int, float] = {}
        self.buffer_bytes = 128
        self.planner_blocks = 15
        self.letters = ""
        """The options it was built with: V (variable spindle), N (line numbers), Z (homing sets zero), ..."""
        self.locked = False
        self.place_mm: Triple | None = None
        """Where the pen was when the last report was made, in the coordinates that G-code speaks."""
        self._offset: Triple = (0.0, 0.0, 0.0)

    @property
    def outdated(self) -> bool:
        """It speaks GRBL 0.x, whose reports have another form."""
        return self.firmware is not None and self.firmware.split(" ")[-1].startswith("0.")

    @property
    def homes(self) -> bool:
        """It finds its home with switches, so machine coordinates mean the same after every start."""
        return self.settings.get(HOMES, 0.0) != 0

    @property
    def offset_mm(self) -> Triple:
        """Where a work offset (G54, G92) puts X0 Y0 Z0, in machine coordinates; zero where none is stored."""
        return self._in_mm(self._offset)

    @property
    def steps_mm(self) -> Triple:
        """Motor steps a mm of X, Y and Z; where it does not say, those of a stock GRBL."""
        x, y, z = (self.settings.get(number, 0.0) or 250.0 for number in STEPS_MM)
        return x, y, z

    def learn(self, reply: Reply) -> None:
        """Keep what `reply` tells; other replies tell nothing lasting."""
        match reply:
            case Banner():
                self.firmware, self.locked = reply.firmware, False
            case Version():
                product = (self.firmware or "Grbl").split(" ")[0]
                self.firmware = f"{product} {reply.version}"
            case Options():
                self.letters, self.planner_blocks = reply.letters, reply.planner_blocks
                self.buffer_bytes = reply.buffer_bytes or self.buffer_bytes
            case Setting():
                self.settings[reply.number] = reply.value
            case Message():
                self.locked = self.locked or reply.locked
            case StatusReport():
                self.locked = reply.state == "Alarm"
                self._offset = reply.offset or self._offset
                self.place_mm = self.position_mm(reply)

    def position_mm(self, report: StatusReport) -> Triple | None:
        """Where the pen is, in the coordinates that G-code speaks; None when the report does not say."""
        if report.work:
            return self._in_mm(report.work)
        if report.machine:
            x, y, z = (place - offset for place, offset in zip(report.machine, self._offset, strict=True))
            return self._in_mm((x, y, z))
        return None

    def _in_mm(self, place: Triple) -> Triple:
        unit_mm = MM_PER_INCH if self.settings.get(REPORTS_INCHES) == 1 else 1.0
        x, y, z = place
        return x * unit_mm, y * unit_mm, z * unit_mm
