"""What is looked at, mended and tried before the first line of a job is drawn."""

from __future__ import annotations

from firmware_protocol.grbl.controller import Controller
from firmware_protocol.grbl.findings import findings, needs_of
from firmware_protocol.grbl.job import Job
from firmware_protocol.session import Finding, Found

CHECK_MODE = "$C"


class Preparation:
    """The findings about one job, and the lines that mend them or try the program.

    may_set: settings may be written. `$` lines of the program itself are not tried: they would act at once.
    """

    def __init__(self, controller: Controller, job: Job, *, may_set: bool) -> None:
        self._controller = controller
        self._needs = needs_of(
            job.leg.path,
            offset_mm=controller.offset_mm,
            firmware=controller.firmware or "Grbl 1.1",
            letters=controller.letters,
        )
        self._lines = [(number, text) for number, text in enumerate(job.texts) if not text.startswith("$")]
        found = self._findings()
        self._mending = [each for each in found if may_set and each.command.startswith("$")]
        self.left = [each for each in found if each not in self._mending]
        """What stays as it is."""

    @property
    def obstacles(self) -> list[Finding]:
        """What stays and keeps the job from being begun."""
        return [each for each in self.left if each.blocks]

    @property
    def commands(self) -> list[str]:
        """Settings lines, one for each setting that differs."""
        return list(dict.fromkeys(each.command for each in self._mending))

    @property
    def trial(self) -> list[str]:
        """The whole program in check mode, to be left by another `$C`."""
        return [CHECK_MODE, *(text for _, text in self._lines)]

    def tried(self, line: int) -> tuple[int, str]:
        """The number (from 1) and text of the job's line that the trial's `line` is."""
        return (0, CHECK_MODE) if line == 0 else (self._lines[line - 1][0] + 1, self._lines[line - 1][1])

    def mended(self) -> list[Found]:
        """The settings have been read back: what was mended; what was not is left."""
        still = {each.command for each in self._findings()}
        self.left = [each for each in self._mending if each.command in still]
        return [Found(each, mended=each not in self.left) for each in self._mending]

    def _findings(self) -> list[Finding]:
        return findings(self._controller.settings, self._needs)
