"""Which chains of ink are edges beside the straight ones."""

from __future__ import annotations

from daemon.graph.skeleton import Chain
from daemon.graph.trace import _needed, _once, _without_stubs


def chain(start: int, end: int, pixels: int) -> Chain:
    return Chain(start, end, list(range(pixels)))


def ends(chains: list[Chain]) -> list[tuple[int, int]]:
    return [(each.start, each.end) for each in chains]


def test_two_short_chains_between_the_same_vertices_are_one() -> None:
    both = [chain(0, 1, 2), chain(1, 0, 3), chain(0, 1, 40), chain(1, 0, 50)]
    assert [len(each.path) for each in _once(both, longest_px=6.0)] == [2, 40, 50]


def test_a_short_chain_is_needed_where_two_parts_would_fall_apart() -> None:
    chains = [chain(0, 1, 9), chain(1, 2, 3), chain(2, 3, 9), chain(3, 0, 4)]
    drawn = {(0, 1), (2, 3)}
    assert ends(_needed(chains, [], 4, drawn, longest_px=6.0)) == [(1, 2)]
    assert ends(_needed(chains, [], 4, {(0, 1), (1, 2), (2, 3)}, longest_px=6.0)) == []


def test_an_edge_that_stops_short_of_where_the_ink_goes_on_is_led_on() -> None:
    chains = [chain(0, 1, 9), chain(1, 2, 3), chain(2, 3, 9), chain(3, 0, 3)]
    assert ends(_needed(chains, [], 4, {(0, 1), (1, 2), (2, 3)}, longest_px=6.0)) == [(3, 0)]


def test_a_chain_to_a_vertex_that_nothing_else_needs_is_left_out() -> None:
    chains = [chain(0, 1, 9), chain(1, 2, 3)]
    assert _needed(chains, [], 3, {(0, 1)}, longest_px=6.0) == []


def test_a_stub_into_a_fork_whose_branches_are_drawn_is_left_out_and_an_end_of_ink_is_not() -> None:
    chains = [chain(0, 1, 2), chain(1, 2, 30), chain(1, 3, 30), chain(0, 4, 2)]
    kept, drawn = [chains[0], chains[3]], {(0, 2), (0, 3)}
    assert ends(_without_stubs(kept, chains, drawn, longest_px=3.0)) == [(0, 4)]
