"""The force that draws a body: friction times the normal forces of all its pairs."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from castx.process.ejection import ejection_forces, normal_force


def problem(comm):
    """Return pressures 1, 2, 4, … MPa at interfaces of three bodies; a pair pulls."""
    names = [("casting", "mould"), ("casting", "core"), ("core", "mould")]
    areas, pulled = np.array([1e-4, 2e-4, 3e-4]), np.array([1.0, 1.0, -1.0])
    described = [
        SimpleNamespace(pairs=SimpleNamespace(secondary=s, primary=p, areas=areas))
        for s, p in names
    ]
    states = [SimpleNamespace(pressure=2.0**k * 1e6 * pulled) for k in range(3)]
    return SimpleNamespace(
        comm=comm, interfaces=SimpleNamespace(described=described, states=states)
    )


@pytest.mark.ranks
@pytest.mark.parametrize(
    "body, megapascals", [("casting", 3.0), ("core", 6.0), ("mould", 5.0), ("lid", 0.0)]
)
def test_all_pairs_of_a_body_on_all_ranks_press(comm, body, megapascals):
    expected = comm.size * megapascals * 1e6 * 3e-4
    assert normal_force(problem(comm), body) == pytest.approx(expected, rel=1e-14)


@pytest.mark.ranks
def test_each_body_has_its_own_friction(comm):
    found = ejection_forces(problem(comm), {"core": 0.2, "mould": 0.5})
    assert list(found) == ["core", "mould"]
    for body, friction in (("core", 0.2), ("mould", 0.5)):
        normal = normal_force(problem(comm), body)
        assert found[body] == {
            "friction": friction, "normal": normal, "force": friction * normal
        }  # fmt: skip
