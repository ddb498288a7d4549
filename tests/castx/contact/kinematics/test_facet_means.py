"""Means of the forces of pairs over the facets round them."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.contact.kinematics.facet_means import FacetMeans
from tests.elastic_bodies import blocks, body, elastic, everywhere, fixed, problem
from tests.partitions import PARTITION, scattered, thinly_scattered

pytestmark = pytest.mark.ranks

METAL = {
    "latent_heat": 4e5, "solidus": 560.0, "liquidus": 610.0, "stress_free": 560.0,
    "liquid": {"viscosity": 1e6, "coherency": 0.7},
}  # fmt: skip


def touching(comm, model="plane-strain", size=0.005):
    """Return a block that may be liquid on one that may not."""
    bodies = {"upper": body(elastic(7e9, 0.33, **METAL)), "base": body(elastic(70e9, 0.3))}
    conditions = {"upper": [fixed("top")], "base": [fixed("bottom")]}
    return problem(blocks(comm, model, size=size), bodies, conditions, [Contact("upper", "base")])


def means(comm, made, forces, counted):
    """Return what the means make of forces."""
    found = FacetMeans(comm, made.gaps)
    values = found.forces(forces, counted)
    found.destroy()
    return values


def all_pairs(made):
    return np.ones(len(made.gaps.areas), dtype=bool)


@pytest.mark.parametrize("cut", [None, scattered, thinly_scattered])
@pytest.mark.parametrize("model", ["plane-strain", "axisymmetric", "3d"])
def test_a_uniform_pressure_and_every_sum_stay(comm, model, cut, monkeypatch):
    if cut is not None:
        monkeypatch.setattr(PARTITION, cut)
    made = touching(comm, model)
    areas, points = made.gaps.areas, made.pairs[0].points
    np.testing.assert_allclose(means(comm, made, -areas, all_pairs(made)), -areas, rtol=1e-12)
    forces = areas * (1.0 + np.sin(400.0 * points[:, 0]))
    found = means(comm, made, forces, all_pairs(made))
    sums = comm.allreduce(np.array([forces.sum(), found.sum()]))
    assert sums[1] == pytest.approx(sums[0], rel=1e-12)
    assert comm.allreduce(float(np.abs(found - forces).max(initial=0.0))) > 0.01 * sums[0] / 5


def test_nothing_is_left_of_forces_that_alternate(comm):
    """On a line of equal facets, the ends of which have half of the area."""
    made = touching(comm)
    areas, places = made.gaps.areas, made.pairs[0].points[:, 0]
    sign = np.where(np.round(places / 0.005) % 2 == 0, 1.0, -1.0)
    found = means(comm, made, areas * (sign - 0.25), all_pairs(made))
    np.testing.assert_allclose(found, -0.25 * areas, atol=1e-12 * areas.max(initial=0.0))


def test_others_keep_their_forces_and_count_in_no_mean(comm):
    """Of the five pairs from the symmetry plane outwards the last two do not count."""
    made = touching(comm, size=0.0025)
    areas, place = made.gaps.areas, np.round(made.pairs[0].points[:, 0] / 0.0025).astype(int)
    tractions = np.array([2.0, 6.0, -4.0, 1e3, 2e3])
    found = means(comm, made, areas * tractions[place], place < 3)
    expected = np.array([4.0, 2.5, -1.5, 1e3, 2e3])
    order = np.argsort(everywhere(comm, place))
    got = everywhere(comm, np.divide(found, areas, out=np.zeros_like(found), where=areas > 0))
    np.testing.assert_allclose(got[order], expected, rtol=1e-12)


@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_pairs_amid_marked_ones_have_no_other_on_their_facets(comm, model):
    """Of those up to a distance from the symmetry plane all but the last ones."""
    made = touching(comm, model, size=0.0025)
    place = np.round(made.pairs[0].points[:, 0] / 0.0025).astype(int)
    found = FacetMeans(comm, made.gaps)
    np.testing.assert_array_equal(found.amid(place < 3), place < 2)
    assert found.amid(all_pairs(made)).all() and not found.amid(~all_pairs(made)).any()
    found.destroy()
