"""However a picture arrives, the watch finds it."""

from __future__ import annotations

import os
from pathlib import Path
from threading import Event

import pytest
from watchdog.observers import Observer

from daemon.errors import SettingsError
from daemon.intake.inbox import Inbox
from daemon.intake.watch import InboxWatch
from tests.daemon.intake.test_inbox import Desk
from tests.daemon.intake.watching import watching


@pytest.mark.parametrize("way", ["there before", "written", "renamed from .part", "moved in from outside"])
def test_the_watch_finds_a_picture_however_it_arrives(tmp_path: Path, way: str) -> None:
    desk = Desk(tmp_path)
    desk.inbox = Inbox(desk.inbox_dir, settle_s=0.02, claim=desk.claim, refuse=print, signs={})
    if way == "there before":
        desk.drop("a.png")
    with watching(InboxWatch(desk.inbox, desk.inbox_dir, trouble=print)):
        _arrive(desk, tmp_path, way)
        assert desk.took.wait(10)
    assert desk.taken == ["a.png"]


def _arrive(desk: Desk, outside: Path, way: str) -> None:
    if way == "written":
        desk.drop("a.png")
    elif way == "renamed from .part":
        desk.drop("a.png.part").rename(desk.inbox_dir / "a.png")
    elif way == "moved in from outside":
        (outside / "a.png").write_text("picture")
        (outside / "a.png").rename(desk.inbox_dir / "a.png")


@pytest.mark.parametrize("poll_s", [None, 0.05])
def test_a_name_of_any_bytes_is_claimed(tmp_path: Path, poll_s: float | None) -> None:
    desk = Desk(tmp_path)
    desk.inbox = Inbox(desk.inbox_dir, settle_s=0.02, claim=desk.claim, refuse=print, signs={})
    name = os.fsdecode("Häus chen \n😀".encode() + b"\xff\xfe.png")
    with watching(InboxWatch(desk.inbox, desk.inbox_dir, trouble=print, poll_s=poll_s)):
        desk.drop(name)
        assert desk.took.wait(10)
    assert desk.taken == [name]


def test_a_folder_that_tells_nothing_is_looked_at_by_itself(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    desk = Desk(tmp_path)
    desk.inbox = Inbox(desk.inbox_dir, settle_s=0.02, claim=desk.claim, refuse=print, signs={})
    looked = Event()
    monkeypatch.setattr(Observer, "start", lambda self: pytest.fail("polling waits for no events"))
    with watching(InboxWatch(desk.inbox, desk.inbox_dir, trouble=print, poll_s=0.05, tidy=looked.set)):
        assert looked.wait(10)
        desk.drop("a.png")
        assert desk.took.wait(10)


def test_the_right_wishes_reach_a_picture_that_was_refused_for_wrong_ones(tmp_path: Path) -> None:
    desk = Desk(tmp_path)
    refused = Event()

    def claim(picture: Path, beside: Path | None) -> None:
        if beside is not None and beside.read_text() != "right":
            raise SettingsError("house.toml: wrong")
        desk.claim(picture, beside)

    desk.inbox = Inbox(desk.inbox_dir, settle_s=0.02, claim=claim, refuse=lambda words: refused.set(), signs={})
    with watching(InboxWatch(desk.inbox, desk.inbox_dir, trouble=print)):
        desk.drop("house.toml", "wrong")
        desk.drop("house.png")
        assert refused.wait(10)
        desk.drop("house.toml", "right")
        assert desk.took.wait(10)
