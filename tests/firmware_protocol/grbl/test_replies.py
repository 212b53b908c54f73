"""One line of a GRBL controller is one typed reply."""

from __future__ import annotations

from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_protocol.grbl import replies
from firmware_protocol.grbl.replies import (
    Alarm,
    Banner,
    Error,
    Feedback,
    Message,
    Ok,
    Options,
    Reply,
    Setting,
    StartupLine,
    StatusReport,
    Unknown,
    Version,
    parse,
)


@pytest.mark.parametrize(
    ("line", "reply"),
    [
        ("ok", Ok()),
        ("error:20", Error(20)),
        ("ALARM:3", Alarm(3)),
        ("Grbl 1.1h ['$' for help]", Banner("Grbl 1.1h")),
        ("GrblHAL 1.1f ['$' or '$HELP' for help]", Banner("GrblHAL 1.1f")),
        ("Grbl 0.9j ['$' for help]", Banner("Grbl 0.9j")),
        ("$110=500.000", Setting(110, 500.0)),
        ("$0=10 (step pulse, usec)", Setting(0, 10.0)),
        ("[VER:1.1h.20190825:PLOTTER7]", Version("1.1h.20190825")),
        ("[OPT:V,15,128]", Options("V", 15, 128)),
        ("[OPT:VNMGPS,35,1024,3,0]", Options("VNMGPS", 35, 1024)),
        ("[MSG:Caution: Unlocked]", Message("Caution: Unlocked")),
        ("[GC:G0 G54 G17]", Feedback("GC", "G0 G54 G17")),
        (">G20:ok", StartupLine("G20:ok")),
        ("<Idle>", StatusReport("Idle")),
        ("<Door:1|WPos:1.000,-2.500,0.000>", StatusReport("Door", 1, work=(1.0, -2.5, 0.0))),
        (
            "<Hold:0|MPos:8.800,0.000,0.000|Bf:15,128|Ln:104|FS:0,0|WCO:1.000,0.000,-3.000>",
            StatusReport("Hold", 0, (8.8, 0.0, 0.0), None, (1.0, 0.0, -3.0), 15, 128, 104),
        ),
    ],
)
def test_what_a_controller_says_is_read(line: str, reply: Reply) -> None:
    assert parse(line) == reply


@pytest.mark.parametrize(
    "line",
    [
        "",
        "OK",
        "oko",
        "error:",
        "error:-1",
        "ALARM:x",
        "Grbl",
        "a Grbl 1.1h",
        "$100=nan",
        "$100=1e9",
        "<idle>",
        "<Idle|MPos:1,2>",
        "<Idle|MPos:1,2,x>",
        "<Idle|Bf:15>",
        "<Idle|MPos:1.0,2.0,3.0",
        "[MSG:torn",
    ],
)
def test_a_torn_or_foreign_line_is_unknown(line: str) -> None:
    assert parse(line) == Unknown(line)


def test_the_unlock_message_means_locked() -> None:
    locked, unlocked = parse("[MSG:'$H'|'$X' to unlock]"), parse("[MSG:Caution: Unlocked]")
    assert isinstance(locked, Message)
    assert isinstance(unlocked, Message)
    assert (locked.locked, unlocked.locked) == (True, False)


def test_state_and_detail_are_one_word_for_people() -> None:
    assert (StatusReport("Hold", 0).word, StatusReport("Idle").word) == ("Hold:0", "Idle")


def test_every_reply_is_built_somewhere() -> None:
    said = [
        "ok",
        "error:1",
        "ALARM:1",
        "Grbl 1.1h",
        "<Run>",
        "$1=2",
        "[VER:a]",
        "[OPT:V,1,2]",
        "[MSG:a]",
        "[GC:]",
        ">",
        "?",
    ]
    assert {type(parse(line)) for line in said} == set(get_args(replies.Reply))


_PIECES = st.sampled_from(
    ["<", ">", "Idle", "|", "MPos:", "Bf:", "1.5", ",", "[", "]", "OPT:", "$", "=", "error:", "7"]
)


@given(st.one_of(st.text(max_size=80), st.lists(_PIECES, max_size=14).map("".join)))
def test_noise_is_a_reply_and_never_an_exception(line: str) -> None:
    assert isinstance(parse(line), get_args(replies.Reply))
