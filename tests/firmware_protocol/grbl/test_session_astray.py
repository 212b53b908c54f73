"""A pen off its path is a verdict; a pen on it never is."""

from __future__ import annotations

from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from firmware_protocol.grbl.simulator.faults import FlipByte
from firmware_protocol.session import Accepted, Ended, Found, Verdict
from tests.firmware_protocol.grbl.driver import ALARM, BANNER, DONE, INFO, SETTINGS, UNLOCK, Line, Play, drawing
from tests.firmware_protocol.grbl.pair import FAST, Pair, plotter, stroke_lines

COMB = [[(2.0 * x, 0.0), (2.0 * x, 10.0)] for x in range(8)]
OFF = "<Run|MPos:1.000,4.000,0.000|FS:500,0>"
ON = "<Run|MPos:1.500,0.000,0.000|FS:500,0>"


def test_two_reports_off_the_path_stop_the_job() -> None:
    play = drawing()
    assert play.say(OFF) == b"?"
    assert play.say(OFF).startswith(b"!")
    play.say("<Hold:0|MPos:1.000,4.000,0.000|FS:0,0>")
    play.say("Grbl 1.1h ['$' for help]")
    for _ in range(3):
        play.say("ok")
    end = play.ended
    assert (end.verdict, end.position_known, end.pen_lifted) == (Verdict.ASTRAY, True, True)
    assert (end.strokes_certain, end.strokes_possible) == (0, 2)
    assert "the pen was seen at (1, 4, 0) mm" in end.why


def test_homing_leads_no_pen_off_the_path_of_a_job_that_begins_at_once() -> None:
    play = Play(home=True)
    play.say(BANNER, UNLOCK)
    play.say(ALARM)
    play.say(*INFO)
    play.say(*SETTINGS)
    play.say("ok")
    home = "<Idle|MPos:-99.000,-99.000,-1.000|FS:0,0>"
    play.say(home)
    play.start(Line("G21 G90"), Line("G0 Z-4"), Line("G0 X-77 Y-88", 0), Line("G1 Z-8 F900", 0))
    for _ in range(4):
        assert b"!" not in play.say(home)
        play.wait(0.3)


def test_an_answer_too_many_stops_the_job() -> None:
    play = drawing()
    play.say(*["ok"] * 7)
    assert play.say("ok").startswith(b"!")
    play.say("<Hold:0|MPos:4.000,0.000,5.000|FS:0,0>")
    play.say("Grbl 1.1h ['$' for help]")
    for _ in range(3):
        play.say("ok")
    assert (play.ended.verdict, play.ended.strokes_certain, play.ended.strokes_possible) == (Verdict.ASTRAY, 0, 2)
    assert "a line was torn" in play.ended.why


def test_one_report_between_good_ones_is_told_and_no_verdict() -> None:
    play = drawing()
    play.say(OFF, ON)
    (told,) = play.told
    assert isinstance(told, Found)
    assert "one report put the pen at (1, 4, 0) mm" in told.finding.why
    assert not told.finding.blocks


def test_a_drawing_that_ends_somewhere_else_is_not_finished() -> None:
    play = drawing()
    play.say(*["ok"] * 7)
    elsewhere = DONE.replace("4.000", "2.000")
    play.say(elsewhere)
    assert play.told[-1] == Accepted(3)
    assert play.say(elsewhere).startswith(b"!")


def test_a_digit_that_was_changed_on_the_way_is_seen_while_the_pen_goes_astray() -> None:
    probe = Pair(plotter()).ready()
    probe.draw(stroke_lines(COMB))
    at = probe.sent.index(b"X8.000 Y10.000") + 1
    pair = Pair(plotter(faults=[FlipByte(at, 0x01)])).ready()
    end = pair.draw(stroke_lines(COMB))
    assert end.verdict is Verdict.ASTRAY
    assert end.strokes_certain <= 4


NUMBERS = st.integers(-2000, 2000).map(lambda value: value / 100)
WORDS = {
    "travel": lambda x, y, r: f"G0 X{x} Y{y}",
    "draw": lambda x, y, r: f"G1 X{x} Y{y}",
    "bare": lambda x, y, r: f"X{x} Y{y}",
    "height": lambda x, y, r: f"G1 Z{abs(x) / 4:.2f}",
    "arc": lambda x, y, r: f"G1 X{x} Y{y}\nG{2 if x > 0 else 3} X{x + 2 * r:.2f} Y{y} I{r}\nG1",
    "circle": lambda x, y, r: f"G1 X{x} Y{y}\nG3 X{x} Y{y} J{r}\nG1",
    "dwell": lambda x, y, r: f"G4 P{abs(r) / 40:.2f}",
    "feed": lambda x, y, r: f"F{300 + 60 * abs(x):.0f}",
    "spindle": lambda x, y, r: f"M3 S{abs(x) * 10:.0f}",
    "relative": lambda x, y, r: f"G91 G1 X{r} Y{r}\nG90",
    "inches": lambda x, y, r: f"G20 G1 X{x / 50:.4f} Y{y / 50:.4f}\nG21",
}


@st.composite
def programs(draw: st.DrawFn) -> list[str]:
    lines = ["G21 G90 F900"]
    for kind in draw(st.lists(st.sampled_from(sorted(WORDS)), min_size=1, max_size=25)):
        x, y, r = draw(NUMBERS), draw(NUMBERS), draw(st.integers(1, 400)) / 100
        lines += WORDS[kind](x, y, r).split("\n")
    return lines


MACHINES = st.fixed_dictionaries(
    {
        10: st.sampled_from([0, 1, 2, 3]),
        13: st.sampled_from([0, 1]),
        11: st.sampled_from([0.01, 0.2]),
        100: st.sampled_from([40.0, 80.0, 250.0]),
        101: st.sampled_from([40.0, 250.0, 1600.0]),
    }
)


@settings(max_examples=100, deadline=None, phases=[Phase.explicit, Phase.reuse, Phase.generate])
@given(programs(), MACHINES)
def test_no_program_that_arrives_as_it_was_sent_goes_astray(texts: list[str], machine: dict[int, float]) -> None:
    pair = Pair(plotter(settings=FAST | machine)).ready()
    end = pair.draw([Line(text, None) for text in texts])
    assert end.verdict is Verdict.FINISHED, end.why


@settings(max_examples=30, deadline=None, phases=[Phase.explicit, Phase.reuse, Phase.generate])
@given(programs(), st.floats(0.0, 4.0))
def test_a_hold_in_between_is_no_reason_either(texts: list[str], after_s: float) -> None:
    pair = Pair(plotter()).ready()
    pair.session.start([Line(text, None) for text in texts], pair.now)
    pair.wait(after_s)
    if not any(isinstance(event, Ended) for event in pair.events):
        pair.sim.receive(b"!", pair.now)
        pair.wait(1.0)
        pair.sim.receive(b"~", pair.now)
    pair.wait_for(lambda: any(isinstance(event, Ended) for event in pair.events))
    (end,) = [event for event in pair.events if isinstance(event, Ended)]
    assert end.verdict is Verdict.FINISHED, end.why
