"""A body that has lost its balance falls until it touches, and no farther."""

from __future__ import annotations

from petsc4py import PETSc

import numpy as np
import pytest

from castx.equilibrium.supports.first_contact import FirstContact, share_until_contact
from castx.equilibrium.supports.springs import SpringSupport
from tests.contact_methods import AT_ONCE, sharp
from tests.coupled_cases import final_state
from tests.elastic_bodies import normal_forces

WIDTH, HEIGHT, DENSITY, GRAVITY = 0.035, 0.02, 7000.0, 9.81
WEIGHT = DENSITY * GRAVITY * WIDTH * HEIGHT
NODES = np.linspace(-WIDTH / 2, WIDTH / 2, 9)
FOOT = NODES[6]
"""Where the block stands at first, far from below its middle."""


def rocker(method: str) -> dict:
    """Return a block that yields, on a floor that bends away from it on both sides of its foot."""
    data = {"density": DENSITY, "poisson_ratio": 0.3, "expansion": 0.0, "stress_free": 20.0}
    return {
        "geometry": {
            "generator": "stacked_blocks", "model": "plane-strain", "symmetry": False,
            "upper": [WIDTH, HEIGHT], "base": [3 * WIDTH, HEIGHT], "size": 0.005,
        },
        "materials": {
            "soft": data | {"young_modulus": 7e9, "yield_stress": 2e5, "hardening": 1e8},
            "stiff": data | {"young_modulus": 210e9},
        },
        "bodies": [
            {"name": "upper", "material": "soft", "temperature": 20.0,
             "law": "thermo-elasto-plastic"},
            {"name": "base", "material": "stiff", "temperature": 20.0},
        ],
        "interfaces": [
            {"bodies": ["upper", "base"],
             "contact": {"method": method, "initial_gap": {
                 "along": "x", "table": [[float(x), float((x - FOOT) ** 2)] for x in NODES]}}},
        ],
        "boundaries": [{"on": "base/bottom", "displacement": {"all": 0.0}}],
        "loads": {"gravity": [0.0, -GRAVITY]},
        "coupling": {"scheme": "mechanical"},
        "time": {"end": 1.0, "fixed_step": 1.0},
    }  # fmt: skip


@pytest.mark.parametrize("method", sharp(AT_ONCE))
def test_a_block_rocks_from_node_to_node_until_it_stands(comm, method):
    """It ends on the node below its middle, which bears its weight; none pulls."""
    state = final_state(comm, rocker(method))
    pairs, force = state.pairs["upper/base"], normal_forces(state.problem.mechanics)
    places = np.concatenate(comm.allgather(pairs.points[:, 0]))
    forces = np.concatenate(comm.allgather(force))
    expected = np.where(np.abs(places) < 1e-9, WEIGHT, 0.0)
    np.testing.assert_allclose(forces, expected, atol=1e-5 * WEIGHT)
    assert state.counters.cutbacks == 0
    assert state.counters.contact_changes <= 12


@pytest.mark.ranks
def test_the_first_of_all_ranks_ends_the_fall(comm):
    """Gaps of 2 fall to −2 on rank 0; on others the pair needs half as far, or may not close."""
    start, end = np.array([2.0, 2.0, 2.0]), np.array([-2.0, -6.0, 1.0])
    nowhere = np.zeros(3)
    may_close = np.array([True, comm.rank == 1, True])
    share = share_until_contact(comm, start, end, may_close, nowhere)
    assert share == pytest.approx(0.25 if comm.size > 1 else 0.5)
    assert share_until_contact(comm, start, end, may_close, nowhere + 8.0) == 1.0
    deeper = share_until_contact(comm, start, end, may_close, nowhere + 0.5)
    assert deeper == pytest.approx(0.3125 if comm.size > 1 else 0.625)
    assert share_until_contact(comm, start - 2.0, end - 2.0, may_close, nowhere) == 0.0


@pytest.mark.ranks
def test_ranks_without_pairs_fall_with_the_others(comm):
    none = np.zeros(0)
    assert share_until_contact(comm, none, none, none.astype(bool), none) == 1.0


class OneGap:
    """A contact whose only pair on each rank has its gap as first unknown, closing at 1 N."""

    follows_set = False

    @property
    def normal(self):
        return self

    @property
    def unknowns(self):
        return self

    def displacements(self, x, u):
        x.copy(u)

    def gaps(self, x, u):
        return x.array_r[:1].copy()

    def trial_forces(self, iterate):
        return -iterate.stiffness * iterate.gaps


@pytest.mark.ranks
@pytest.mark.parametrize("fall", [1e-3, 2.0, 30.0])
def test_a_pair_ends_behind_the_contact_however_long_the_fall(comm, fall):
    """The depth of 1e-20 m that its force asks for is far below the rounding of metres."""
    x = PETSc.Vec().createMPI((2, None), comm=comm)
    x.array[:] = 0.1, 0.0
    motions = np.array([[1.0, 1.0]]) / np.sqrt(2.0 * comm.size)
    support = SpringSupport(motions, motions, np.zeros(0, dtype=np.intp), 1.0, comm)
    for elastic in (1.5e-7, 3.7e-9, 2.8e-10):
        y = x.duplicate()
        y.array[:] = 0.1 - elastic + fall, fall
        falls = FirstContact(OneGap(), x)
        assert falls.stop(support, x, y, np.ones(1, dtype=bool), force=1e-9, stiffness=1e11)
        end = x.array_r[0] - y.array_r[0]
        assert -1e-14 * (0.1 + fall) < end < 0.0
        y.destroy()
    x.destroy()


@pytest.mark.ranks
@pytest.mark.parametrize(("gap", "share"), [(0.3, 0.35), (0.0, 0.05), (-0.2, 0.05), (2.0, 1.0)])
def test_a_step_ends_where_open_pairs_overlap_on_all_ranks(comm, gap, share):
    """Pairs approach by one; the last rank holds the one that is near, others are far apart."""
    x = PETSc.Vec().createMPI((2, None), comm=comm)
    last = comm.rank == comm.size - 1
    x.array[:] = gap if last else 9.0, 7.0
    y = x.duplicate()
    y.array[:] = 1.0, 3.0
    limit, may = FirstContact(OneGap(), x), np.ones(1, dtype=bool)
    assert limit.stop_overlap(x, y, may, 0.05) == (share < 1.0)
    np.testing.assert_allclose(y.array_r, [share, 3.0 * share])
    assert not limit.stop_overlap(x, y, ~may, 0.0)
    for vector in (x, y):
        vector.destroy()
