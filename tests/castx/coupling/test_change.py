"""Change of heat and solid fraction since the last accepted state, over all ranks."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from castx.coupling.change import ROUNDING, ThermalChange


def fields(values) -> dict[str, SimpleNamespace]:
    """Return nodal functions of bodies; the last node is a ghost."""
    return {
        name: SimpleNamespace(x=SimpleNamespace(array=np.array(array, dtype=np.float64)))
        for name, array in values.items()
    }


def problem(comm, size=1.0):
    heat = SimpleNamespace(
        enthalpy=fields({"casting": [10.0, 20.0, 99.0], "mould": [5.0, 99.0]}),
        solid_fraction=fields({"casting": [0.0, 0.0, 0.0], "mould": [1.0, 1.0]}),
    )
    volumes = {"casting": size * np.array([1.0, 2.0]), "mould": size * np.array([4.0])}
    return heat, ThermalChange(comm, heat, volumes)


def test_heat_is_compared_with_all_that_has_moved(comm):
    """Gained and lost heat both count, ghosts do not."""
    heat, change = problem(comm)
    heat.enthalpy["casting"].x.array[:] = [7.0, 20.0, 0.0]
    heat.enthalpy["mould"].x.array[:] = [6.0, 0.0]
    moved = comm.size * (3.0 * 1.0 + 1.0 * 4.0)
    assert change.share(0.5) == pytest.approx(0.5 / moved, rel=1e-14)
    change.commit()
    heat.enthalpy["casting"].x.array[:] = [7.0, 21.0, 0.0]
    assert change.share(1.0) == pytest.approx(1.0 / (2.0 * comm.size), rel=1e-14)


def test_more_heat_than_has_moved_is_all_of_it(comm):
    _, change = problem(comm)
    assert change.share(123.0) == 1.0
    assert change.share(0.0) == 0.0


def test_round_off_beside_the_stored_heat_is_no_change(comm):
    _, change = problem(comm)
    stored = comm.size * (10.0 + 40.0 + 20.0)
    assert change.share(1e-3 * ROUNDING * stored) == pytest.approx(1e-3, rel=1e-12)


def test_a_billionth_of_the_stored_heat_is_a_change(comm):
    """Hot bodies that hardly move any more: what moves counts, not what they hold."""
    heat, change = problem(comm)
    heat.enthalpy["casting"].x.array[0] += 7e-8
    moved = comm.size * 7e-8
    assert change.share(0.1 * moved) == pytest.approx(0.1, rel=1e-6)


@pytest.mark.ranks
def test_the_fastest_node_of_all_ranks_decides(comm):
    heat, change = problem(comm)
    heat.solid_fraction["casting"].x.array[1] = 0.1 * (comm.rank + 1)
    assert change.largest_of_solid_fraction() == pytest.approx(0.1 * comm.size)
    change.commit()
    assert change.largest_of_solid_fraction() == 0.0


@pytest.mark.ranks
@pytest.mark.parametrize("size", [1.0, 1e-6])
def test_a_body_freezes_by_volume(comm, size):
    """Nodes of 1 and 2 m³, or cm³, freeze to 0.3 and 0.6; ghosts do not count."""
    heat, change = problem(comm, size)
    heat.solid_fraction["casting"].x.array[:] = [0.3, 0.6, 1.0]
    heat.solid_fraction["mould"].x.array[:] = [0.9, 0.0]
    assert change.largest_of_mean_solid_fraction() == pytest.approx(1.5 / 3.0, rel=1e-14)
    change.commit()
    assert change.largest_of_mean_solid_fraction() == 0.0


@pytest.mark.ranks
@pytest.mark.parametrize(("first", "counted"), [(0.5, 0.4 * 0.1), (0.99, 0.4 * 0.05 / 0.02)])
def test_the_last_melt_of_a_mush_counts_for_more(comm, first, counted):
    """A tenth of what was melt, of half of the body, freezes like 0.04 of all of it."""
    heat, _ = problem(comm)
    heat.solid_fraction["casting"].x.array[:2] = first
    volumes = {"casting": np.array([1.0, 2.0]), "mould": np.array([4.0])}
    change = ThermalChange(comm, heat, volumes, {"casting"})
    still = ThermalChange(comm, heat, volumes)
    heat.solid_fraction["casting"].x.array[:2] += 0.05 if first == 0.5 else 0.0
    if first != 0.5:
        heat.solid_fraction["casting"].x.array[:2] -= 0.05  # it melts
    found = change.largest_of_mean_solid_fraction()
    assert found == pytest.approx(max(counted, 0.05), rel=1e-12)
    assert still.largest_of_mean_solid_fraction() == pytest.approx(0.05, rel=1e-12)


@pytest.mark.ranks
def test_without_the_heat_equation_nothing_moves(comm):
    heat = SimpleNamespace(enthalpy={}, solid_fraction=fields({"casting": [0.0]}))
    assert ThermalChange(comm, heat, {"casting": np.ones(1)}).share(0.0) == 0.0


@pytest.mark.ranks
def test_a_rank_without_nodes_sees_the_change_of_others(comm):
    last = comm.rank == comm.size - 1
    heat = SimpleNamespace(
        enthalpy=fields({"casting": [10.0] if last else []}),
        solid_fraction=fields({"casting": [0.0] if last else []}),
    )
    change = ThermalChange(comm, heat, {"casting": np.ones(int(last))})
    heat.solid_fraction["casting"].x.array[:] = 0.25
    assert change.largest_of_solid_fraction() == 0.25
    assert change.largest_of_mean_solid_fraction() == 0.25
