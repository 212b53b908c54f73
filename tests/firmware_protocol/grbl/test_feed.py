"""The feed override, step by step."""

from __future__ import annotations

import pytest

from firmware_protocol.grbl.feed import FeedOverride
from firmware_protocol.session import Ended, Verdict
from tests.firmware_protocol.grbl.pair import Pair, plotter, stroke_lines


def test_each_step_waits_for_the_report_that_shows_the_one_before() -> None:
    feed = FeedOverride()
    feed.want(121)
    assert (feed.step(0.0), feed.step(0.5)) == (b"\x91\x93", b"")
    feed.reported(None)
    assert feed.step(0.6) == b""
    feed.reported(111)
    assert feed.step(0.7) == b"\x91"
    feed.reported(121)
    assert feed.step(0.8) == b""


def test_a_step_that_does_not_show_is_tried_again() -> None:
    feed = FeedOverride()
    feed.want(95)
    assert (feed.step(0.0), feed.step(1.0)) == (b"\x94", b"\x94")


def test_back_to_normal_is_one_byte() -> None:
    feed = FeedOverride()
    feed.reported(55)
    assert feed.step(0.0) == b"\x90"


def test_a_reset_sets_the_override_back() -> None:
    feed = FeedOverride()
    feed.want(110)
    feed.reported(110)
    feed.restarted()
    assert feed.step(0.0) == b"\x91"


@pytest.mark.parametrize("percent", [9, 201])
def test_more_than_the_controller_offers_is_refused(percent: int) -> None:
    with pytest.raises(ValueError, match="10 to 200"):
        FeedOverride().want(percent)


@pytest.mark.parametrize(("percent", "seconds"), [(50, 20.0), (200, 5.0)])
def test_the_override_arrives_while_it_draws_and_the_next_job_forgets_it(percent: int, seconds: float) -> None:
    pair = Pair(plotter()).ready()
    for override, expected in ((percent, seconds), (None, 10.0)):
        begun = pair.now
        pair.session.start(stroke_lines([[(0, 0), (100, 0)]], feed=600), begun)
        if override is not None:
            pair.session.set_feed_percent(override, begun)
        assert pair.until(Ended).verdict is Verdict.FINISHED
        pair.events.clear()
        assert pair.now - begun == pytest.approx(expected + 3.0, abs=3.0)
