"""A program as a text file: readable comments on disk, and the same program when it is read back."""

from __future__ import annotations

import re
from pathlib import Path

from daemon.errors import DiskTrouble, LinedrawError
from daemon.shapes import Program, ProgramLine

_HEAD = "(linedrawd: {strokes} strokes)"
_STROKE = "(stroke {index})"
_NO_STROKE = "(no stroke)"
_PEN = "(pen {name})"
_COMMENT = re.compile(r"(?<!^M0 )(?:\([^)]*\)|;(?!\$PATH=).*)")
"""`;$PATH=` belongs to the head of a Siemens program: it looks like a comment and is none. What stands behind M0 is for
the screen of the control."""


def program_text(program: Program) -> str:
    """The file's text: a line a program line, before each change of stroke a comment that says which, from 0.

    Where a pen begins, another one says what it is called.
    """
    rows = [_HEAD.format(strokes=program.strokes)]
    before: int | None = None
    for line in program.lines:
        if line.stroke != before:
            if line.stroke is None:
                rows.append(_NO_STROKE)
            else:
                rows += [_PEN.format(name=name) for first, name in program.passes.items() if first == line.stroke]
                rows.append(_STROKE.format(index=line.stroke))
            before = line.stroke
        rows.append(line.text)
    return "\n".join(rows) + "\n"


def load_program(path: Path) -> Program:
    """The program whose text the file holds, comments removed: they must never be sent.

    Raises DiskTrouble when it cannot be read, LinedrawError when it is no `program_text`: without the comments nobody
    knows which line belongs to which stroke.
    """
    try:
        text = path.read_text(encoding="ascii")
    except OSError as error:
        raise DiskTrouble(f"cannot read {path}: {error.strerror}: mend the folder's rights") from error
    except UnicodeDecodeError as error:
        raise LinedrawError(f"{path}, byte {error.start}: not a program of ours: plan the picture again") from error
    return parse_program(text, name=str(path))


def parse_program(text: str, *, name: str = "program") -> Program:
    """The program of a file's text. Raises LinedrawError when the head comment is missing."""
    rows = text.splitlines()
    head = re.fullmatch(re.escape(_HEAD).replace(r"\{strokes\}", r"(\d+)"), rows[0] if rows else "")
    if head is None:
        raise LinedrawError(f"{name}, line 1: expected '{_HEAD.format(strokes='N')}': plan the picture again")
    lines: list[ProgramLine] = []
    stroke: int | None = None
    passes: dict[int, str] = {}
    pen = ""
    for row in rows[1:]:
        if (comment := re.fullmatch(r"\(stroke (\d+)\)", row)) is not None:
            stroke = int(comment[1])
            passes |= {stroke: pen} if pen else {}
            pen = ""
        elif (comment := re.fullmatch(r"\(pen ([\w-]+)\)", row)) is not None:
            pen = comment[1]
        elif row == _NO_STROKE:
            stroke = None
        elif command := _COMMENT.sub("", row).strip():
            lines.append(ProgramLine(command, stroke))
    return Program(tuple(lines), int(head[1]), passes)
