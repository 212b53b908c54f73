"""What the journal remembers of each machine: why it is held, and whether its sheet is used."""

from __future__ import annotations

from dataclasses import dataclass, replace

SHEET, HELD, GO = "new sheet", "held", "go"
"""Stand in the place of a state in the rows of the journal that belong to no job."""


@dataclass(frozen=True, slots=True)
class Kept:
    """held: why it begins no job; empty when it may. sheet_used: from the first drawing after a new sheet came in."""

    held: str = ""
    sheet_used: bool = False
    sheet_before: bool = False
    """Whether the sheet was used when the present drawing began."""


class KeptOfMachines:
    """By the name of the machine. "" stands for the one machine of a journal that wrote down no names.

    A machine of which nothing has been written is as that one was left.
    """

    def __init__(self) -> None:
        self._of: dict[str, Kept] = {"": Kept()}

    def of(self, machine: str) -> Kept:
        return self._of.get(machine, self._of[""])

    def knows(self, machine: str) -> bool:
        """Something has been written of it, under its name."""
        return machine in self._of

    def held(self) -> dict[str, str]:
        """The machines that are held, by their names, and why."""
        return {machine: kept.held for machine, kept in self._of.items() if machine and kept.held}

    def note(self, machine: str, what: str, words: str) -> None:
        """A row that belongs to no job."""
        kept = self.of(machine)
        if what == SHEET:
            self._of[machine] = replace(kept, sheet_used=False)
        else:
            self._of[machine] = replace(kept, held=words if what == HELD else "")

    def began(self, machine: str) -> None:
        """A drawing began: its sheet is used."""
        kept = self.of(machine)
        self._of[machine] = replace(kept, sheet_used=True, sheet_before=kept.sheet_used)

    def undone(self, machine: str) -> None:
        """The drawing ended before its first stroke."""
        kept = self.of(machine)
        self._of[machine] = replace(kept, sheet_used=kept.sheet_before)
