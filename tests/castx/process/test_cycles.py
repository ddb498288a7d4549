"""Changes from cycle to cycle, and the distance from the state to which they tend."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from castx.process.cycles import CycleEnds, distance_from_periodic
from tests.castx.fakes import cylinder_mesh


def temperatures(mesh, **values) -> dict:
    return {
        name: SimpleNamespace(x=SimpleNamespace(array=value(mesh.bodies[name].points)))
        for name, value in values.items()
    }


def after_cycle(ends, mesh, **values) -> float | None:
    ends.note(temperatures(mesh, **values))
    return ends.change()


@pytest.mark.ranks
def test_the_largest_change_of_a_node_on_any_rank_counts(comm):
    mesh = cylinder_mesh(comm)
    ends = CycleEnds(mesh, ["casting", "mould"])
    first = {"casting": lambda x: 500.0 + x[:, 0], "mould": lambda x: 200.0 - x[:, 1]}
    assert after_cycle(ends, mesh, **first) is None
    assert after_cycle(ends, mesh, **first) == 0.0
    later = {"casting": lambda x: 501.0 + x[:, 0], "mould": lambda x: 200.0 - 101.0 * x[:, 1]}
    assert after_cycle(ends, mesh, **later) == pytest.approx(100.0 * 0.04, rel=1e-12)


@pytest.mark.ranks
def test_a_body_that_has_left_counts_with_its_last_temperature(comm):
    mesh = cylinder_mesh(comm)
    ends = CycleEnds(mesh, ["mould"])
    for value, expected in ((300.0, None), (310.0, 10.0)):
        ends.note(temperatures(mesh, mould=lambda x, value=value: np.full(len(x), value)))
        ends.note(temperatures(mesh, casting=lambda x: np.zeros(len(x))))
        assert ends.change() == expected


@pytest.mark.ranks
def test_ends_of_cycles_are_saved(comm):
    mesh = cylinder_mesh(comm)
    ends, other = (CycleEnds(mesh, ["mould"]) for _ in range(2))
    after_cycle(ends, mesh, mould=lambda x: x[:, 0])
    other.restore({name: saved.values for name, saved in ends.saved().items()})
    change = after_cycle(other, mesh, mould=lambda x: x[:, 0] + 2.5)
    assert change == pytest.approx(2.5, rel=1e-14)


@pytest.mark.serial
@pytest.mark.parametrize("ratio", [0.1, 0.5, 0.9])
def test_the_distance_is_the_sum_of_all_changes_to_come(ratio):
    changes = [8.0 * ratio**k for k in range(600)]
    found = distance_from_periodic(changes[:3])
    assert found == pytest.approx(sum(changes[3:]), rel=1e-10)


@pytest.mark.serial
@pytest.mark.parametrize(
    "changes, distance",
    [
        ([], None),
        ([None], None),
        ([None, 5.0], None),
        ([None, 0.0], 0.0),
        ([3.0, 5.0], None),  # it grows
        ([5.0, 5.0], None),
        ([5.0, 0.0], 0.0),
        ([9.0, None, 0.0], 0.0),
    ],
)
def test_the_distance_is_unknown_unless_changes_shrink(changes, distance):
    assert distance_from_periodic(changes) == distance
