"""The largest residual and its place, in the same words on all ranks."""

from __future__ import annotations

import numpy as np
import pytest

from castx.solvers.worst_place import Part, worst_place


@pytest.mark.ranks
def test_the_worst_place_is_the_same_on_all_ranks(comm):
    values = np.array([1.0, 2.0 + comm.rank])
    points = np.array([[0.0, 0.0], [1.0, float(comm.rank)]])
    text = worst_place(comm, [Part("body 'a'", values, points)], "W")
    last = comm.size - 1
    assert text == f"largest residual {2.0 + last:.3e} W in body 'a' at (1, {last}) m"
    values[0] = np.nan if comm.rank == last else 0.0
    text = worst_place(comm, [Part("body 'a'", values, points)], "W")
    assert text == "a residual is not a number in body 'a' at (0, 0) m"
    assert worst_place(comm, [], "W") == ""


@pytest.mark.ranks
def test_the_largest_component_of_any_part_is_found(comm):
    """Parts without places, as on ranks without pairs, count for nothing."""
    points = np.array([[0.0, 0.0], [0.5, 0.25]])
    parts = [
        Part("body 'a' (forces)", np.array([[1.0, -2.0], [0.5, 0.5]]), points),
        Part("the gaps", np.zeros(0), np.zeros((0, 2))),
        Part("body 'b' (forces)", np.array([0.1, 0.1, 0.1, -7.5]), points),
    ]
    text = worst_place(comm, parts, "N")
    assert text == "largest residual 7.500e+00 N in body 'b' (forces) at (0.5, 0.25) m"
