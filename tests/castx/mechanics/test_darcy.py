"""Formulation with flow through the mush: Jacobian, pores, ledger, restart of one body."""

from __future__ import annotations

from dataclasses import replace

from mpi4py import MPI

import numpy as np
import pytest

from castx.mechanics.body import BodyMechanics
from castx.mechanics.mush.metal import MushMetal
from tests.castx.mechanics.lone_bodies import (
    LENGTH,
    MELTING,
    alone,
    jacobian_times,
    random_field,
)
from tests.elastic_bodies import pushed

pytestmark = pytest.mark.sampled

MODELS = ("plane-stress", "plane-strain", "axisymmetric", "generalised-plane-strain", "3d")
METAL = MushMetal(0.06, 1e-3, 1e5, 0.98, 4e-5, 1 / 3, 650.0, ("far",))


def mushy(comm, model: str = "plane-strain", **description) -> BodyMechanics:
    """Return a slab whose solid fraction falls from the wall, 1, to the far end, fed."""
    metal = description.pop("mush", METAL)
    part = alone(comm, model, properties=MELTING, mush=metal, **description)
    freeze(part, 0.0)
    part.commit()
    freeze(part, 0.1)
    return part


def freeze(part: BodyMechanics, more: float) -> None:
    """Begin a step of 2 s that ends with solid fractions higher by a part."""
    x = part.mesh.points[:, 0] / LENGTH
    fraction = np.clip(1.2 - 1.3 * x + more, 0.0, 1.0)
    part.update_state(650.0 - 50.0 * fraction - 5.0 * x, fraction, 2.0)
    part.set_time(0.0)


def differs(comm, part: BodyMechanics) -> float:
    """Return the largest difference of Jacobian and differences over the largest entry.

    Rows of pressures count by themselves: volumes are small beside forces.
    """
    here, direction = 1e-3 * random_field(part, 1.1), random_field(part, 2.3)
    part.solution.x.array[:] = here + 1e-3 * direction
    after = part.residual()
    part.solution.x.array[:] = here - 1e-3 * direction
    difference = (after - part.residual()) / 2e-3
    product = jacobian_times(part, direction)
    worst, size = 0.0, part.block_size
    for k in range(size):
        scale = comm.allreduce(float(np.abs(product[k::size]).max(initial=0.0)), MPI.MAX)
        error = np.abs(difference - product)[k::size].max(initial=0.0)
        worst = max(worst, float(error) / scale)
    return comm.allreduce(worst, MPI.MAX)


@pytest.mark.ranks
@pytest.mark.parametrize("stabilisation", ["osgs", "gls"])
@pytest.mark.parametrize("model", MODELS)
def test_jacobian_is_the_derivative_of_the_residual(comm, model, stabilisation):
    """With levels that sink."""
    sinks = replace(METAL, feeders=("far", "top"))
    part = mushy(comm, model, stabilisation=stabilisation, body_force=(1e4, -3e4), mush=sinks,
                 loads=(pushed("far", 2e4),))  # fmt: skip
    assert differs(comm, part) < 1e-6


@pytest.mark.ranks
def test_jacobian_with_open_pores(comm):
    """Where the trial pressure exceeds Δp_c nodes open, and their rows hold it."""
    part = mushy(comm, body_force=(1e4, -3e4))
    part.solution.x.array[:] = 1e-3 * random_field(part, 0.7)
    opened = part.improve_pressures()
    assert comm.allreduce(opened, MPI.LOR)
    assert part.formulation.pores_changed == opened
    assert differs(comm, part) < 1e-6


def test_a_node_that_is_fed_has_the_pressure_of_the_gas(comm):
    part = mushy(comm, loads=(pushed("far", 2e4),))
    held, given = part.formulation._held(), part.formulation._given(np.zeros(1))
    far = np.isclose(part.mesh.points[: len(held), 0], LENGTH)
    assert (held == far).all()
    np.testing.assert_array_equal(given[held], -2e4)


@pytest.mark.ranks
def test_steps_are_rewound_and_restored(comm):
    """What a rewound step leaves, and a restored body, have the residual of the first try."""
    part, other = mushy(comm), mushy(comm)
    part.solution.x.array[:] = 1e-7 * random_field(part, 1.3)
    part.residual()
    part.commit()
    saved = {
        name: {key: state.values for key, state in item.saved().items()}
        for name, item in part.formulation.stateful_parts().items()
    }
    freeze(part, 0.15)
    first = part.residual()
    part.rewind()
    freeze(part, 0.12)
    part.residual()
    part.rewind()
    freeze(part, 0.15)
    np.testing.assert_array_equal(part.residual(), first)
    for name, item in other.formulation.stateful_parts().items():
        item.restore(saved[name])
    other.solution.x.array[:] = part.solution.x.array
    freeze(other, 0.15)
    np.testing.assert_array_equal(other.residual(), first)


def test_solid_that_melts_keeps_its_pores_and_its_melt_bears_no_more(comm):
    """A fifth of the slab freezes with pores, and melts again under a pull: p is Δp_c there."""
    part = mushy(comm)
    part.solution.x.array[:] = 1e-3 * random_field(part, 0.7)
    part.improve_pressures()
    part.residual()
    part.commit()
    freeze(part, 0.3)
    part.residual()
    part.commit()
    content = part.formulation._content
    own, before = slice(content.owned), content.start
    freeze(part, 0.1)
    again = (before.solid >= 1.0)[own] & (content.solid < 1.0)[own]
    assert comm.allreduce(bool((again & (before.pores[own] > 0.0)).any()), MPI.LOR)
    part.solution.x.array[part.formulation._rows] = 1e9
    part.solution.x.scatter_forward()
    part.improve_pressures()
    opened = part.formulation._pores.open
    assert opened[again].all()
    missing = part.formulation._balance()[2] / content.volumes
    part.commit()
    np.testing.assert_allclose(
        content.start.pores[own][again], (before.pores[own] + missing)[again], rtol=1e-12
    )


def test_totals_of_the_ledger(comm):
    part = mushy(comm)
    part.solution.x.array[:] = 0.0
    part.commit()
    found = part.liquid_totals()
    volumes = part.formulation._content.volumes
    x = part.mesh.points[: len(volumes), 0] / LENGTH
    fractions = [np.clip(1.2 - 1.3 * x + more, 0.0, 1.0) for more in (0.0, 0.1)]
    demand = comm.allreduce(0.06 * float(volumes @ (fractions[1] - fractions[0])), MPI.SUM)
    assert found["feeding_demand"] == pytest.approx(demand, rel=1e-12)
    assert found["yielded_volume"] == pytest.approx(0.0, abs=1e-12 * demand)
    assert found["unfed_volume"] == found["opened_volume"] == 0.0
