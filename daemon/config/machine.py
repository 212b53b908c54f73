"""One machine: which device it is, how to reach it, and how it draws."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Discriminator, Field, Tag, field_validator, model_validator

from daemon.config.pen import PenSettings, ZPenSettings
from daemon.config.section import PairMm, Positive, Section
from daemon.config.sheet import Corner
from daemon.errors import SettingsError

SIMULATED_GRBL = "sim://grbl"
_PAPER_UP_MM = -5.0
_WAYS = {
    "grbl": (
        ("serial:///", "usb://", "tcp://"),
        "auto, serial:///dev/NAME, usb://PLACE, tcp://HOST:PORT or sim://grbl",
    ),
    "emco": (
        ("file:///", "serial:///", "usb://", "tcp://"),
        "file:///FOLDER, serial:///dev/NAME, usb://PLACE, tcp://HOST:PORT or sim://emco",
    ),
    "dobot": (
        ("serial:///", "usb://", "tcp://"),
        "auto, serial:///dev/NAME, usb://PLACE, tcp://HOST:PORT or sim://dobot",
    ),
}
"""How the url of each device may begin, and how that is said."""
_NOT_OF_PROGRAMS = {"url", "may_reset_usb", "pen_life_m", "sheet", "inbox"}
"""Two machines that differ in these alone draw each other's programs."""


class Machine(Section):
    """What every machine has. Positions are in mm of the sheet, or of the machine where it has been homed."""

    device: str
    """The kind of the machine."""
    url: str = "auto"
    """auto (found on the USB), serial:///dev/NAME, usb://PLACE, tcp://HOST:PORT, or file:///FOLDER for an EMCO."""
    may_reset_usb: bool = False
    """A USB adapter behind which the machine is mute is reset, once: some wedge. It loses its power for a moment."""
    home: Literal["never", "start", "job"] = "never"
    """When the machine finds its home: never, when it is opened, or before each job as well."""
    park_mm: PairMm = (0.0, 0.0)
    """Where the pen waits."""
    draw_mm_s: Annotated[float, Field(gt=0, le=1000)] = 20.0
    """How fast the lowered pen is moved."""
    resolution_mm: Annotated[float, Field(ge=0, le=1)] = 0.02
    """Shorter moves are not sent: the length of a few steps of the motors."""
    pen: PenSettings = ZPenSettings()
    """How the pen is lowered and lifted: a section of its own."""
    pen_life_m: Positive | None = None
    """After so many metres of line the pen is worn, which is said; a file PEN in the inbox tells that it is new."""
    scale_x: Annotated[float, Field(ge=0.5, le=2)] = 1.0
    """So many mm the pen really goes to the right for one mm; `linedrawd calibrate` measures it and the next three."""
    scale_y: Annotated[float, Field(ge=0.5, le=2)] = 1.0
    """So many mm it really goes up for one mm."""
    skew_deg: Annotated[float, Field(ge=-10, le=10)] = 0.0
    """So far its Y axis leans to the right, where it should stand at a right angle to X."""
    backlash_mm: tuple[Annotated[float, Field(ge=0, le=5)], Annotated[float, Field(ge=0, le=5)]] = (0.0, 0.0)
    """So far X and Y run before the pen follows, whenever they turn round."""
    sheet: Literal["ask", "feed", "auto"] = "auto"
    """"ask": wait for a person after each drawing; "feed": draw on; "auto": feed on a simulated machine, else ask."""
    inbox: Annotated[str, Field(pattern=r"^[^\x00]{0,255}$")] = ""
    """A folder of its own: what is dropped there is drawn by this machine, and nothing else. Beside the inbox, or with
    its whole path; "": the inbox of all."""
    box_mm: tuple[Positive, Positive] | None = None
    """Where its sheets are of another size: in place of box_mm in [sheet]."""
    box_origin_mm: PairMm | None = None
    """In place of box_origin_mm in [sheet]."""
    corner: Corner | None = None
    """In place of corner in [sheet]."""

    @model_validator(mode="after")
    def _way_to_this_device(self) -> Machine:
        begins, ways = _WAYS[self.device]
        if self.url != "auto" and not self.url.startswith((*begins, "sim://")):
            raise ValueError(f"'{self.url}' is no way to a machine of device '{self.device}': use {ways}")
        if self.simulated and self.url.partition("?")[0].rstrip("/") != f"sim://{self.device}":
            raise ValueError(f"'{self.url}' is not simulated for device '{self.device}': use sim://{self.device}")
        return self

    @field_validator("url")
    @classmethod
    def _bare_path(cls, url: str) -> str:
        return f"serial://{url}" if url.startswith("/") else url

    def check_streamable(self) -> None:
        """Raises SettingsError when nothing can be sent to it by these settings, though programs can be written."""

    def draws_like(self, other: Machine) -> bool:
        """A program for the other one is one for this machine, too."""
        return self.model_dump(exclude=_NOT_OF_PROGRAMS) == other.model_dump(exclude=_NOT_OF_PROGRAMS)

    @property
    def simulated(self) -> bool:
        return self.url.startswith("sim://")

    @property
    def asks_for_sheets(self) -> bool:
        return self.sheet == "ask" or (self.sheet == "auto" and not self.simulated)


class GrblMachine(Machine):
    """A controller with GRBL 1.1 or one that speaks like it."""

    device: Literal["grbl"] = "grbl"
    baud: Annotated[int, Field(gt=0)] = 115200
    """Of the serial line."""
    flow: Literal["count", "line"] = "count"
    """"count" fills the controller's buffer, "line" waits for each answer: for clones that lose bytes."""
    reach_mm: tuple[Positive, Positive] = (200.0, 200.0)
    """How far the machine gets from its origin in X and Y."""
    origin: Literal["here", "homed"] = "here"
    """"here": the sheet's corner lies where the pen stands when the port is opened; "homed": at origin_mm."""
    origin_mm: PairMm = (0.0, 0.0)
    """Where the sheet's corner lies on a homed machine."""
    dialect: Literal["grbl", "paper"] = "grbl"
    """"paper" writes programs as the paper's own machine reads them."""
    units: Literal["mm", "cm", "inch"] = "mm"
    """Of a program in the paper's dialect, which does not say its units itself."""
    lift_after_restart: bool = True
    """A pen that a restarted controller may have left down is lifted, by the settings of the pen."""
    may_set: bool = False
    """Settings of the controller that would spoil a drawing are corrected, not only named."""
    dry_run: bool = False
    """Each program is first read by the controller in its check mode, in which nothing moves."""
    motors_off_after_min: Positive | None = None
    """Motors lose their current after so long without a job; the position is then unknown."""

    @model_validator(mode="before")
    @classmethod
    def _homing_and_origin_go_together(cls, given: Any) -> Any:
        if not isinstance(given, Mapping):
            return given
        if given.get("origin") == "homed":
            return {"home": "start", **given}
        return (
            {**given, "origin": "homed"} if given.get("home") in ("start", "job") and "origin" not in given else given
        )

    @model_validator(mode="after")
    def _home_is_found_where_positions_are_counted_from_it(self) -> GrblMachine:
        if (self.origin == "homed") != (self.home != "never"):
            raise ValueError(
                f"origin = '{self.origin}' and home = '{self.home}' contradict each other: homed, positions are "
                "counted from the machine's home; say origin = 'homed' with home = 'start' or 'job', or neither"
            )
        return self

    @model_validator(mode="after")
    def _up_is_above_down(self) -> GrblMachine:
        if isinstance(self.pen, ZPenSettings) and self.dialect != "paper":
            self.pen.check_lifts()
        return self

    def check_streamable(self) -> None:
        """Raises SettingsError when its programs are files for another machine: they press the pen down or shrink."""
        paper, pen = self.dialect == "paper", self.pen
        if paper and not (isinstance(pen, ZPenSettings) and pen.up_mm == _PAPER_UP_MM):
            raise SettingsError("dialect = 'paper' lifts to Z-5: say pen.up_mm = -5 if that is up, or dialect = 'grbl'")
        if paper and self.units != "mm":
            raise SettingsError(f"units = '{self.units}' is for files, a GRBL counts in mm: say units = 'mm'")


class EmcoMachine(Machine):
    """An EMCO Concept Mill 250. X0 Y0 is set at the control (G54); its programs are started by the operator."""

    device: Literal["emco"]
    link: Literal["file", "xonxoff", "blocks"] = "xonxoff"
    """A file in a folder that WinNC reads, serial text, or a block a line that the other side acknowledges."""
    dialect: Literal["siemens", "fanuc"] = "siemens"
    """Which WinNC is started at the control."""
    preset: Literal["7E1", "7E2", "8N1"] = "7E1"
    """Data bits, parity, stop bits."""
    baud: Annotated[int, Field(ge=110, le=115200)] = 9600
    """As set at the control."""
    xoff_limit_s: Positive = 300.0
    """A control that holds the transfer for longer has stopped."""
    wait_for_xon: bool = True
    """The transfer begins when the control asks for it, not when the job does."""
    ack: Annotated[str, Field(min_length=1, max_length=16)] = "\x06"
    """What acknowledges a block: a control character or a text such as "ok"."""
    nak: Annotated[str, Field(min_length=1, max_length=16)] = "\x15"
    """What asks for it again."""
    answer_within_s: Positive = 10.0
    """A block that is not acknowledged for longer is sent again."""
    retries: Annotated[int, Field(ge=0, le=100)] = 3
    """So often; then the transfer ends."""
    chunk_bytes: Annotated[int, Field(ge=1, le=64)] = 16
    """On a serial line no more is written at once: what has been written still arrives after the control's XOFF."""
    holds_bytes: Annotated[int, Field(ge=1, le=1 << 20)] | None = None
    """What the control can hold on a serial line without having drawn it. Only for one that draws while it reads: what
    was sent before is then certainly drawn, and a control that takes more is known to throw it away."""
    holds_blocks: Annotated[int, Field(ge=1, le=10000)] | None = None
    """The same in blocks, where each is acknowledged."""
    reach_mm: tuple[Positive, Positive] = (350.0, 250.0)
    """How far the machine gets from X0 Y0."""
    pen: ZPenSettings = ZPenSettings()

    @model_validator(mode="before")
    @classmethod
    def _a_folder_takes_files(cls, given: Any) -> Any:
        if isinstance(given, Mapping) and str(given.get("url", "")).startswith("file://"):
            return {"link": "file", **given}
        return given

    @model_validator(mode="after")
    def _link_and_url_go_together(self) -> EmcoMachine:
        self.pen.check_lifts()
        if self.url != "auto" and (self.link == "file") != self.url.startswith("file://"):
            raise ValueError(f"link = '{self.link}' does not go with url = '{self.url}': a folder is file:///FOLDER")
        if self.home != "never":
            raise ValueError("an EMCO is homed at its control, by the operator: say home = 'never'")
        return self

    def check_streamable(self) -> None:
        """Raises SettingsError while nobody has said how the machine is reached: no port can be found by itself."""
        if self.url == "auto":
            raise SettingsError(f"device emco is not found by itself: say its url (or --port), {_WAYS['emco'][1]}")


class DobotMachine(Machine):
    """A Dobot Magician. The sheet lies where `sheet_origin_mm` says, in the arm's own coordinates."""

    device: Literal["dobot"]
    home: Literal["never", "start", "job"] = "start"
    baud: Annotated[int, Field(gt=0)] = 115200
    """Of the serial line."""
    sheet_origin_mm: PairMm = (190.0, -57.0)
    """The sheet's lower left corner, seen from the middle of the base."""
    straight: Literal["CP", "PTP"] = "CP"
    """"PTP" stops at every point: for an arm that takes no continuous path."""
    park_mm: PairMm = (25.0, 57.0)
    pen: ZPenSettings = ZPenSettings(up_mm=10.0)

    @model_validator(mode="after")
    def _up_is_above_down(self) -> DobotMachine:
        self.pen.check_lifts()
        return self


def _device_of(machine: Any) -> Any:
    return machine.get("device", "grbl") if isinstance(machine, Mapping) else getattr(machine, "device", None)


AnyMachine: TypeAlias = Annotated[
    Annotated[GrblMachine, Tag("grbl")] | Annotated[EmcoMachine, Tag("emco")] | Annotated[DobotMachine, Tag("dobot")],
    Discriminator(
        _device_of,
        custom_error_type="device",
        custom_error_message="a machine is a section with device = 'grbl', 'emco' or 'dobot': write one of these",
    ),
]
"""By its device."""
