"""From a drawing in px to a toolpath in mm: placed in the box, inside the reach, nothing lost."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from daemon.errors import NothingToDraw, OutOfReach, SettingsError
from daemon.shapes import Drawing, Stroke
from daemon.toolpath.place import Layout, invert, place, placement
from daemon.toolpath.plan import Precision, plan_toolpath

sizes = st.integers(1, 2000)
lengths = st.floats(1, 500)
on_page = st.floats(-0.5, 100.5).map(lambda px: round(px, 3))


def drawing(*strokes: list[tuple[float, float]], width_px: int = 101, height_px: int = 101) -> Drawing:
    return Drawing(tuple(Stroke(np.array(points, float)) for points in strokes), width_px, height_px)


@given(sizes, sizes, lengths, lengths)
def test_the_picture_touches_the_box_on_two_sides_and_is_centred(
    width_px: int, height_px: int, width_mm: float, height_mm: float
) -> None:
    from_px = placement(width_px, height_px, Layout((width_mm, height_mm), (25, 30)))
    low, high = np.sort(place(np.array([[-0.5, -0.5], [width_px - 0.5, height_px - 0.5]]), from_px), axis=0)
    left, bottom = low - (25, 30)
    right, top = np.array([25 + width_mm, 30 + height_mm]) - high
    assert min(left, bottom) == pytest.approx(0, abs=1e-6)
    assert (left, bottom) == (pytest.approx(right, abs=1e-6), pytest.approx(top, abs=1e-6))


def test_y_points_up_and_proportions_are_kept() -> None:
    from_px = placement(200, 100, Layout((64, 64), (25, 25)))
    corners = place(np.array([[-0.5, -0.5], [199.5, 99.5]]), from_px)
    assert corners.tolist() == [[25, 73], [89, 41]]


def turned(**how: object) -> list[list[float]]:
    """Where the upper left corner and the upper right corner of a picture of 200 x 100 px come to lie, in mm."""
    from_px = placement(200, 100, Layout((200, 200), (0, 0), **how))  # type: ignore[arg-type]
    return place(np.array([[-0.5, -0.5], [199.5, -0.5]]), from_px).round(6).tolist()


def test_a_picture_is_turned_clockwise_and_mirrored_before() -> None:
    assert turned() == [[0, 150], [200, 150]]
    assert turned(rotate=90) == [[150, 200], [150, 0]]
    assert turned(rotate=180) == [[200, 50], [0, 50]]
    assert turned(rotate=270) == [[50, 0], [50, 200]]
    assert turned(mirror=True) == [[200, 150], [0, 150]]
    assert turned(mirror=True, rotate=90) == [[150, 0], [150, 200]]


def test_a_margin_is_left_free_all_round() -> None:
    assert turned(margin_mm=10.0) == [[10, 145], [190, 145]]


def test_true_size_is_what_the_resolution_says_in_the_middle_of_the_box() -> None:
    from_px = placement(200, 100, Layout((60, 60), (10, 10), true_size=True), px_per_mm=10.0)
    corners = place(np.array([[-0.5, -0.5], [199.5, 99.5]]), from_px)
    assert corners == pytest.approx(np.array([[30, 45], [50, 35]]))


def test_true_size_of_a_picture_without_resolution_is_refused() -> None:
    with pytest.raises(SettingsError, match=r"states no resolution: save it .* or set size = 'fit'"):
        plan_toolpath(drawing([(0, 0), (50, 0)]), layout=Layout(true_size=True))


def test_the_way_back_leads_to_the_same_pixel() -> None:
    from_px = placement(200, 100, Layout((64, 50), (25, 30)))
    pixels = np.array([[0.0, 0], [12.5, 99]])
    assert place(place(pixels, from_px), invert(from_px)) == pytest.approx(pixels)


@pytest.mark.parametrize(("width_px", "box_mm"), [(0, (64, 64)), (10, (0, 64))])
def test_an_empty_picture_or_box_is_refused(width_px: int, box_mm: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="give sizes"):
        placement(width_px, 10, Layout(box_mm, (0, 0)))


@settings(max_examples=50)
@given(
    st.lists(
        # Sorted, so that no stroke runs back over its own line: what is drawn already is not drawn again.
        st.lists(st.tuples(on_page, on_page), min_size=1, max_size=8).map(sorted),
        min_size=1,
        max_size=6,
    )
)
def test_every_stroke_arrives_inside_the_box_with_its_length(strokes: list[list[tuple[float, float]]]) -> None:
    given_drawing = drawing(*strokes)
    toolpath = plan_toolpath(given_drawing, precision=Precision(error_mm=0.0), rejoin=False)
    points = np.concatenate([stroke.points for stroke in toolpath.strokes])
    assert len(toolpath.strokes) == len(strokes)
    assert points.min() >= 25 - 1e-9
    assert points.max() <= 89 + 1e-9
    given_px = sum(stroke.length for stroke in given_drawing.strokes)
    assert toolpath.drawn_mm == pytest.approx(given_px * 64 / 101, abs=1e-6)


def test_lines_that_cross_are_joined_for_less_travel_unless_they_are_to_stay() -> None:
    crossing = drawing([(0, 50), (50, 50), (100, 50)], [(50, 40), (50, 50), (50, 60)])
    joined, kept = (
        plan_toolpath(crossing, start_mm=(25, 57), park_mm=(89, 57), rejoin=rejoin) for rejoin in (True, False)
    )
    assert len(joined.strokes) == len(kept.strokes) == 2
    assert joined.travelled_mm < kept.travelled_mm - 1
    assert joined.drawn_mm == pytest.approx(kept.drawn_mm)


def test_the_first_stroke_and_point_out_of_reach_is_named() -> None:
    leaves_below = drawing([(0, 0), (50, 0)], [(0, 0), (10, 10), (50, 100)])
    with pytest.raises(OutOfReach, match=r"stroke 1, point 2 lies at \(57\.0, 25\.3\) mm.*y 30 to 130 mm: make"):
        plan_toolpath(leaves_below, reach_mm=(100, 100), reach_low_mm=(0, 30), park_mm=(0, 30))


def test_a_park_position_out_of_reach_is_named() -> None:
    with pytest.raises(OutOfReach, match="the park position lies at"):
        plan_toolpath(drawing([(0, 0), (50, 0)]), reach_mm=(100, 100), park_mm=(150, 0))


def test_a_drawing_that_just_fits_is_drawn() -> None:
    edge = drawing([(-0.5, -0.5), (100.5, 100.5)])
    for side_mm in (64, 64.1, 33.3, 0.7):
        toolpath = plan_toolpath(edge, layout=Layout((side_mm, side_mm)), reach_mm=(25 + side_mm, 25 + side_mm))
        assert toolpath.strokes[0].points.max() == pytest.approx(25 + side_mm)


def test_a_drawing_without_strokes_is_refused() -> None:
    with pytest.raises(NothingToDraw, match="holds no line"):
        plan_toolpath(drawing())


def test_points_closer_to_a_line_than_the_error_are_left_out() -> None:
    wavy = [(float(x), 50 + 0.03 * (x % 2)) for x in range(101)]
    assert len(plan_toolpath(drawing(wavy), precision=Precision(error_mm=0.05)).strokes[0].points) == 2


def test_the_error_is_never_more_than_its_share_of_a_pixel() -> None:
    wavy = [(float(x), 50 + 0.03 * (x % 2)) for x in range(101)]
    assert len(plan_toolpath(drawing(wavy), precision=Precision(error_px=0.02)).strokes[0].points) > 50


def test_a_crossing_stays_exactly_on_both_strokes() -> None:
    bent, across = [(0.0, 0.0), (50.0, 0.05), (100.0, 0.0)], [(50.0, -20.0), (50.0, 0.05), (50.0, 20.0)]
    toolpath = plan_toolpath(drawing(bent, across))
    one, other = ({tuple(point) for point in stroke.points.tolist()} for stroke in toolpath.strokes)
    assert len(one & other) == 1
    assert len(plan_toolpath(drawing(bent)).strokes[0].points) == 2


def test_start_and_park_position_are_told_on() -> None:
    toolpath = plan_toolpath(drawing([(0, 0), (50, 0)]), start_mm=(1, 2), park_mm=(3, 4))
    assert (toolpath.start_mm, toolpath.park_mm) == ((1, 2), (3, 4))


def test_one_pen_is_done_before_the_next_begins_and_each_by_a_short_way() -> None:
    across = [Stroke(np.array([[10.0 * x, 10.0], [10.0 * x, 20.0]]), pen=x % 2) for x in (3, 0, 5, 2, 1, 4)]
    tour = plan_toolpath(Drawing(tuple(across), 60, 60)).strokes
    assert [stroke.pen for stroke in tour] == [0, 0, 0, 1, 1, 1]
    assert sorted({stroke.points[0][0] for stroke in tour[:3]}) == [stroke.points[0][0] for stroke in tour[:3]]
