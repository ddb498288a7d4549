"""Content of the nodes of a slab, and its ledger, for changes that hang on the place alone."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest

from castx.domain.measures import nodal_volumes
from castx.mechanics.mush.content import MeltContent
from tests.castx.mechanics.lone_bodies import LENGTH, slab

pytestmark = pytest.mark.sampled

BETA = 0.06


def content(comm) -> tuple[MeltContent, np.ndarray]:
    """Return the content of a slab that begins with f = 0.3, and places of its nodes."""
    body = slab(comm)
    found = MeltContent(body, nodal_volumes(body, "plane-strain"), BETA)
    x = body.points[:, 0] / LENGTH
    found.begin(np.full(len(x), 0.3), np.zeros(len(body.nodes.dofmap.list)))
    return found, x


def begun(found: MeltContent, solid: np.ndarray) -> None:
    found.begin(solid, np.zeros(len(found.strain)))


@pytest.mark.ranks
def test_what_misses_is_what_nothing_has_filled(comm):
    """R = V (1 + θ) − (M + flow)/(1 + β f), M = (1 + β 0.3) V."""
    found, x = content(comm)
    begun(found, 0.3 + 0.4 * x)
    volume, own = found.volumes, slice(found.owned)
    stretched, flow = 1e-3 * x[own] * volume, 2e-3 * volume
    melt = 1.0 + BETA * 0.3 + 2e-3
    expected = volume * (1.0 + 1e-3 * x[own] - melt / (1.0 + BETA * (0.3 + 0.4 * x[own])))
    np.testing.assert_allclose(found.missing(stretched, flow), expected, rtol=1e-9, atol=1e-18)


@pytest.mark.ranks
def test_ledger_closes_where_every_row_holds(comm):
    """Two steps; what misses is supplied at one half of the nodes, pores in the other one."""
    found, x = content(comm)
    own = slice(found.owned)
    for step, solid in enumerate((0.3 + 0.4 * x, 0.5 + 0.5 * x)):
        begun(found, solid)
        stretched = -1e-4 * (1 + step) * x[own] * found.volumes
        flow = np.zeros(found.owned)
        fed = x[own] < 0.5
        missing = found.missing(stretched, flow)
        supply = np.where(fed, found.weight * missing, 0.0)
        pores = np.where(fed, found.frozen_pores, missing / found.volumes)
        found.commit(stretched, flow, supply, pores, np.zeros(found.owned))
    demand, *supplied = found.ledger
    assert demand == pytest.approx(sum(supplied), rel=1e-12)
    assert min(supplied) > 0.0
    pores = comm.allreduce(float(found.start.pores[own] @ found.volumes), MPI.SUM)
    assert found.porosity() == pytest.approx(pores)
    totals = found.totals(np.full(found.owned, 3e3))
    named = ("feeding_demand", "fed_volume", "opened_volume", "yielded_volume", "unfed_volume")
    assert [totals[name] for name in named] == [demand, *supplied, found.porosity()]
    assert totals["melt_suction"] == pytest.approx(3e3)
    assert totals["pocket_pressure"] == pytest.approx(3e3)
    assert (found.start.solid[x == 1.0] == 1.0).all()
    assert (found.frozen_pores[x[own] == 1.0] > 0.0).all()
    assert (found.frozen_pores[x[own] < 1.0] == 0.0).all()


def test_nodes_without_melt(comm):
    found, x = content(comm)
    begun(found, np.where(x < 0.3, 0.3, 0.95))
    none = np.zeros(found.owned)
    found.commit(none, none, none, np.full(found.owned, 0.06), none)
    np.testing.assert_array_equal(found.emptied, x >= 0.3)


def test_a_trial_step_is_rewound_and_restored(comm):
    found, x = content(comm)
    other, _ = content(comm)
    begun(found, 0.3 + 0.4 * x)
    none = np.zeros(found.owned)
    found.commit(none, none, none, 0.1 * found.volumes, none)
    begun(found, 0.6 + 0.4 * x)
    found.rewind()
    np.testing.assert_array_equal(found.solid, 0.3 + 0.4 * x)
    other.restore({name: saved.values for name, saved in found.saved().items()})
    assert other.ledger == found.ledger
    begun(other, 0.6 + 0.4 * x)
    begun(found, 0.6 + 0.4 * x)
    np.testing.assert_array_equal(other.missing(none, none), found.missing(none, none))


def test_solid_that_was_born_late_in_a_step_keeps_its_volume_behind_it(comm):
    found, x = content(comm)
    begun(found, 0.3 + 0.4 * x)
    none, born = np.zeros(found.owned), np.linspace(1e-4, 2e-4, len(found.strain))
    found.commit(none, none, none, none, none, born)
    np.testing.assert_array_equal(found.begin(0.3 + 0.5 * x, 0.5 * born), 1.5 * born)


@pytest.mark.ranks
def test_mean_pressure_of_what_is_left_melt(comm):
    found, x = content(comm)
    assert found.mean_pressure(np.full(found.owned, 3e3)) == pytest.approx(3e3)
    none = np.zeros(found.owned)
    begun(found, np.where(x < 0.6, 1.0, 0.5))
    found.commit(none, none, none, none, none)
    left = np.where(x[: found.owned] < 0.6, -1e9, 2e3)
    assert found.mean_pressure(left) == pytest.approx(2e3)
    begun(found, np.ones(len(x)))
    found.commit(none, none, none, none, none)
    assert found.mean_pressure(left) == 0.0


@pytest.mark.ranks
def test_largest_suction_of_what_is_left_melt(comm):
    found, x = content(comm)
    none, at = np.zeros(found.owned), x[: found.owned]
    begun(found, np.where(x < 0.6, 1.0, 0.5))
    found.commit(none, none, none, none, none)
    assert found.largest_suction(np.where(at < 0.6, 1e9, 2e3 * at)) == pytest.approx(2e3)
    assert found.largest_suction(np.full(found.owned, -1.0)) == 0.0
    begun(found, np.ones(len(x)))
    found.commit(none, none, none, none, none)
    assert found.largest_suction(np.full(found.owned, 2e3)) == 0.0
