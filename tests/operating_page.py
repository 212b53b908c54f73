"""The tables and the state diagram of docs/operating.md, from the tables in the code.

python -m tests.operating_page
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from daemon.jobs.states import MEANINGS, OUTCOMES, STEPS, State

PAGE = Path(__file__).parents[1] / "docs" / "operating.md"
BEGIN, END = "<!-- made by python -m tests.operating_page -->", "<!-- end of what is made -->"


def made() -> str:
    """What stands between the two marks."""
    return "\n".join([BEGIN, "", *_diagram(), "", *_states(), "", *_outcomes(), "", END])


def page(text: str) -> str:
    """The page's text with its made part anew. Raises ValueError where a mark is missing."""
    before, rest = text.split(BEGIN)
    _, after = rest.split(END)
    return before + made() + after


def _diagram() -> Iterator[str]:
    yield "```mermaid"
    yield "stateDiagram-v2"
    yield f"    [*] --> {State.QUEUED.value}: a picture is dropped"
    for (before, after), why in STEPS.items():
        yield f"    {before.value} --> {after.value}: {why}"
    for state in (State.DONE, State.CANCELLED):
        yield f"    {state.value} --> [*]"
    yield "```"


def _states() -> Iterator[str]:
    yield "| state | what it means | what to do |"
    yield "|---|---|---|"
    for (state, reason), meaning in MEANINGS.items():
        name = f"{state.value}, {reason.value}" if reason.value else state.value
        yield f"| {name} | {meaning.means} | {meaning.remedy} |"


def _outcomes() -> Iterator[str]:
    yield "| how a drawing ends | why | the job is then | first |"
    yield "|---|---|---|---|"
    for verdict, outcome in OUTCOMES.items():
        state = f"{outcome.state.value}, {outcome.reason.value}" if outcome.reason.value else outcome.state.value
        yield f"| {verdict.value} | {outcome.cause} | {state} | {outcome.remedy or '-'} |"


if __name__ == "__main__":
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
