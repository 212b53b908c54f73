"""Where a person may lead the machine between jobs: its park place, and the frame of what is drawn next."""

from __future__ import annotations

from collections.abc import Sequence

from daemon.jobs.moves import PointMm
from daemon.jobs.orders import Places, outline_mm, rectangle_mm
from daemon.jobs.pool import Pool
from daemon.jobs.sheet import box_origin_mm, counts_from_home, homes
from daemon.jobs.station import Station
from daemon.program.file import load_program
from daemon.shapes import Program


def places_of(pool: Pool, station: Station) -> Places:
    """A frame is that of the drawing, or of the box where no job has been planned."""
    desk, machine = station.desk, pool.settings.machines[station.name]

    def box() -> Sequence[PointMm]:
        sheet = pool.settings.sheet_of(station.name)
        left, bottom = box_origin_mm(sheet, machine)
        width, height = sheet.box_mm
        return rectangle_mm((left, bottom), (left + width, bottom + height))

    def frame_mm(job: str) -> Sequence[PointMm]:
        found = desk.find(job) if job else station.next_to_draw()
        return outline_mm(desk.folders.path(found.id)) if found else box()

    def next_program() -> Program:
        found = station.next_to_draw()
        return load_program(desk.folders.path(found.id) / "program.gcode") if found else Program((), 0)

    return Places(machine.park_mm, frame_mm, next_program, homes(machine), counts_from_home(machine))
