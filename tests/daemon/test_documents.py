"""Documents in the inbox of a daemon: each page is drawn, and what cannot be read harms nothing else."""

from __future__ import annotations

import json
from pathlib import Path

from daemon.config import Settings
from daemon.jobs.states import State
from tests.daemon.intake.vector.pdfs import ENCRYPTED, pdf
from tests.daemon.test_service import ended, running, settings_of

FIRST, SECOND = "10 20 m 60 20 l S", "10 20 m 60 20 l S 10 60 m 60 60 l S"


def settings_for_documents(root: Path) -> Settings:
    given = settings_of(root)
    return given.model_copy(update={"planning": given.planning.model_copy(update={"memory_mb": 384})})


def test_the_pages_of_a_document_are_drawn_one_after_the_other(tmp_path: Path) -> None:
    with running(settings_for_documents(tmp_path), planner=None) as daemon:
        (daemon.settings.paths.inbox / "book.pdf").write_bytes(pdf([FIRST, SECOND]))
        jobs = daemon.wait_for(lambda jobs: len(jobs) == 2 and ended(jobs))
        inks = [json.loads((daemon.folder(job) / "ink.json").read_text())["strokes"] for job in jobs]
    assert [(job.name, job.state) for job in jobs] == [
        ("book.pdf page 1", State.DONE),
        ("book.pdf page 2", State.DONE),
    ]
    assert [sum(len(stroke) > 1 for stroke in ink) for ink in inks] == [1, 2]


def test_what_cannot_be_read_fails_with_a_sentence_and_the_next_one_is_drawn(tmp_path: Path) -> None:
    bad = {
        "corrupt.pdf": b"%PDF-1.7\nnothing of the kind",
        "encrypted.pdf": ENCRYPTED,
        "long.pdf": pdf([""] * 10_000),
    }
    with running(settings_for_documents(tmp_path), planner=None) as daemon:
        for name, data in (bad | {"zzz.pdf": pdf([FIRST])}).items():
            (daemon.settings.paths.inbox / name).write_bytes(data)
        jobs = daemon.wait_for(lambda jobs: len(jobs) == len(bad) + 1 and ended(jobs), within_s=120)
    words = {job.name: (job.state, job.words) for job in jobs}
    assert words.pop("zzz.pdf")[0] is State.DONE
    assert {state for state, _ in words.values()} == {State.FAILED}
    said = {name: sentence for name, (_, sentence) in words.items()}
    assert said["corrupt.pdf"].startswith("corrupt.pdf is a PDF that is damaged")
    assert said["encrypted.pdf"] == "encrypted.pdf is a PDF that is encrypted: save it anew without a password"
    assert said["long.pdf"] == "long.pdf is a PDF that has 10000 pages, at most 100 are drawn: split it"
