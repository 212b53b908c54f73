"""How pictures come in, are read, and are laid on the sheet."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

from pydantic import Field, model_validator

from daemon.config.section import PairMm, Positive, Section

Corner: TypeAlias = Literal["lower left", "lower right", "upper left", "upper right"]


class Intake(Section):
    settle_s: Annotated[float, Field(ge=0, le=600)] = 1.0
    """How long size and time of a file must stay the same; three times as long where nobody said it was closed."""
    max_megapixels: Positive = 100.0
    """Larger pictures are refused before they are decoded."""
    watch: Literal["events", "poll"] = "events"
    """"poll" looks every poll_s: for a folder of another computer, whose changes nobody tells us."""
    poll_s: Annotated[float, Field(ge=0.1, le=3600)] = 2.0
    """Seconds between two looks of "poll"."""
    order: Literal["arrival", "name", "priority"] = "arrival"
    """Which picture is drawn first; "priority": those whose names begin with a number and `-`, the lowest first."""
    duplicates: Literal["draw", "skip"] = "draw"
    """What becomes of a picture that is, byte for byte, that of another job."""
    approve: bool = False
    """Each drawing waits, planned, until somebody has looked at its preview.html and says `linedrawd approve JOB`."""


class Keep(Section):
    """How much is kept. Only jobs that are over are ever removed, the oldest first."""

    jobs_days: Positive = 90.0
    """Folders of jobs that have been over for longer are removed."""
    jobs_mb: Positive = 4000.0
    """As long as all jobs together take more, the oldest that is over is removed."""
    free_mb: Annotated[float, Field(ge=0)] = 200.0
    """With less free on the disk of the jobs no picture is taken any more."""
    log_mb: Annotated[float, Field(ge=0.01)] = 10.0
    """A log that has grown to this is set aside; a job's own log ends there."""
    log_files: Annotated[int, Field(ge=1, le=100)] = 4
    """How many that were set aside are kept."""


class Planning(Section):
    """Limits of the worker process, how it reads a page, and whether it says why in explain.json."""

    memory_mb: Annotated[int, Field(ge=128)] = 1024
    """A picture that needs more memory to be planned fails, alone."""
    time_limit_s: Positive = 300.0
    """A picture that needs longer to be planned fails, alone."""
    threads: Annotated[int, Field(ge=1, le=64)] = 1
    """Of the network, while a picture is planned."""
    ahead: Annotated[int, Field(ge=1)] = 2
    """Jobs that are planned before the machine is free for them."""
    graph: Literal["repaired", "paper"] = "repaired"
    """"paper" reads a page strictly by the equations of the paper; "repaired" lets the ink decide."""
    network: Literal["linedrawd", "paper"] = "linedrawd"
    """"paper" knows nothing but the paper's straight lines 2 px wide, and those better."""
    fill: Literal["outline", "hatch", "skip"] = "outline"
    """What becomes of filled areas more than twelve line widths across: "hatch" draws lines within the outline, "skip"
    leaves them out."""
    hatch_spacing_mm: Annotated[float, Field(ge=0.1, le=20)] = 0.5
    """From line to line of a hatch on paper; about the width of the pen fills an area."""
    hatch_angle_deg: Annotated[float, Field(ge=-180, le=180)] = 45.0
    """How its lines rise to the right, as the picture is seen."""
    hatch_cross: bool = False
    """Crosses it by a second one at a right angle."""
    merge: bool = True
    """A line that was drawn over itself is drawn once, in the middle of its passes."""
    explain: bool = False
    """Writes into explain.json why each line is drawn as it is."""


class Sheet(Section):
    """Where on the sheet a picture is drawn, in mm inwards from the corner where the origin lies, and how exactly."""

    box_mm: tuple[Positive, Positive] = (64.0, 64.0)
    """Width and height of the box that a drawing is fitted into."""
    box_origin_mm: PairMm = (25.0, 25.0)
    """The box's corner that is nearest to the origin."""
    corner: Corner = "lower left"
    """The sheet's corner where the origin lies; x still runs to the right and y up."""
    size: Literal["auto", "fit", "true"] = "auto"
    """"fit": as large as the box; "true": as large as the picture's resolution says, in the middle of the box; "auto":
    true for a page of the scanner, else fit."""
    margin_mm: Annotated[float, Field(ge=0)] = 0.0
    """Kept free on all four sides within the box."""
    rotate: Literal[0, 90, 180, 270] = 0
    """Degrees clockwise."""
    mirror: bool = False
    """Left and right exchanged, before it is turned."""
    error_mm: Positive = 0.05
    """So far a drawn line may lie from the one that was understood."""
    curve_tolerance_mm: Annotated[float, Field(ge=0, le=1)] = 0.05
    """So far, where curves are drawn as arcs; with 0 every line is drawn in straight pieces, by error_mm."""

    @model_validator(mode="after")
    def _room_inside_the_margin(self) -> Sheet:
        if 2 * self.margin_mm >= min(self.box_mm):
            raise ValueError(f"margin_mm = {self.margin_mm:g} leaves no room in box_mm: make it smaller")
        return self
