"""Histories of points: birth, growth, remelting, checkpoints."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from castx.materials.flow import PLASTIC, VISCOPLASTIC
from castx.mechanics.constitutive.history import PointHistory
from castx.mechanics.constitutive.law import ELASTIC, Law
from castx.mechanics.constitutive.response import respond
from tests.castx.mechanics.constitutive.metals import (
    COHERENCY,
    FLOWING,
    NEWTONIAN,
    POISSON,
    YOUNG,
    G,
    after,
    at,
    metal,
    strains,
)
from tests.elastic_bodies import elastic


@pytest.mark.parametrize("name", [PLASTIC, VISCOPLASTIC])
def test_a_solid_is_born_without_a_past(points, name):
    material = elastic(YOUNG, POISSON, 0.0, solidus=560.0, liquidus=610.0, latent_heat=4e5,
                       liquid=NEWTONIAN, viscosity=1e7, **FLOWING)  # fmt: skip
    law = Law(material, 560.0, name)
    flowed, change = strains(points, 0.3, 1), strains(points, 1e-5, 2)
    history = after(points, at(points, law, 0.2), PointHistory.initial(points), flowed)
    born = at(points, law, 1.0, start=0.2)
    assert np.abs(respond(born, history, flowed).stress).max() == 0.0
    # It grows during the step, so that it is strained by half of what the step brings.
    found = respond(born, history, flowed + change)
    np.testing.assert_allclose(found.stress, G * change, rtol=1e-8, atol=1.0)
    np.testing.assert_allclose(found.isotropic, G, rtol=1e-12)
    history = after(points, born, history, flowed)
    found = respond(at(points, law, 1.0), history, flowed + change)
    np.testing.assert_allclose(found.stress, 2 * G * change, rtol=1e-8, atol=1.0)


def share(w: float) -> float:
    """Return the solid fraction at which a share of the alloy bears."""
    return COHERENCY + w * (1.0 - COHERENCY)


def test_growth_adds_the_stress_of_increments(points):
    """Stress s = Σ w_m 2G de while solid grows, whatever the size of the steps."""
    law = Law(metal(viscosity=1e-3, coherency=COHERENCY), 560.0, ELASTIC)
    shares, history = np.array([0.0, 0.3, 0.35, 0.8, 1.0]), PointHistory.initial(points)
    total, expected = np.zeros((points.count, points.components)), 0.0
    for number, (before, now) in enumerate(pairwise(shares)):
        change = strains(points, 1e-4, number)
        total = total + change
        c = at(points, law, share(now), start=share(before))
        found = respond(c, history, total)
        expected = expected + 0.5 * (before + now) * 2 * G * change
        np.testing.assert_allclose(found.stress, expected, rtol=1e-6, atol=1.0)
        np.testing.assert_allclose(found.isotropic, (before + now) * G, rtol=1e-6)
        history = after(points, c, history, total)


def test_what_melts_takes_its_stress_away(points):
    """What is left keeps its strain, and freezing again brings nothing back."""
    law = Law(metal(viscosity=1e-3, coherency=COHERENCY), 560.0, ELASTIC)
    strain = strains(points, 1e-4, 1)
    history = after(points, at(points, law, 1.0), PointHistory.initial(points), strain)
    half = at(points, law, share(0.5), start=1.0)
    np.testing.assert_allclose(
        respond(half, history, strain).stress, 0.5 * 2 * G * strain, rtol=1e-9, atol=1.0
    )
    history = after(points, half, history, strain)
    again = at(points, law, 1.0, start=share(0.5))
    np.testing.assert_allclose(
        respond(again, history, strain).stress, 0.5 * 2 * G * strain, rtol=1e-9, atol=1.0
    )


def test_remelting_wipes_the_flow_of_the_solid(points):
    law = Law(metal(**NEWTONIAN), 560.0, PLASTIC)
    solid, melting = at(points, law, 1.0), at(points, law, 0.0, start=1.0)
    history = after(points, solid, PointHistory.initial(points), strains(points, 0.01, 1))
    assert history.equivalent.min() > 0 and np.abs(history.plastic).max() > 0
    history = after(points, melting, history, strains(points, 0.02, 2))
    assert history.equivalent.max() == np.abs(history.plastic).max() == 0.0
    frozen = respond(at(points, law, 1.0, start=0.0), history, strains(points, 0.02, 2))
    assert np.abs(frozen.stress).max() == 0.0


def test_new_solid_dilutes_the_flow_of_the_old(points):
    """Half as much is there, without any flow: mean flow is half of what it was."""
    law = Law(metal(**NEWTONIAN), 560.0, PLASTIC)
    strain = strains(points, 0.01, 1)
    history = PointHistory.initial(points)
    history = after(points, at(points, law, share(0.5)), history, strain)
    assert history.equivalent.min() > 0
    grown = after(points, at(points, law, 1.0, start=share(0.5)), history, strain)
    np.testing.assert_allclose(grown.equivalent, 0.5 * history.equivalent, rtol=1e-12)
    np.testing.assert_allclose(grown.plastic, 0.5 * history.plastic, rtol=1e-12)
    np.testing.assert_allclose(grown.elastic, 0.5 * history.elastic, rtol=1e-12)


def test_saved_arrays_give_the_history_back(points):
    law = Law(metal(), 560.0, PLASTIC)
    solid, history = at(points, law, 1.0), PointHistory.initial(points)
    history = after(points, solid, history, strains(points, 0.01, 1))
    saved = history.saved(points)
    assert set(saved) == set(PointHistory._fields) - {"mush"}
    assert all(len(part.values) == points.cells for part in saved.values())
    arrays = {name: part.values for name, part in saved.items()}
    found = PointHistory.initial(points).restored(arrays)
    for name, values in found.arrays().items():
        np.testing.assert_array_equal(values, getattr(history, name), err_msg=name)
    assert history.equivalent.min() > 0.0


def test_an_unstrained_body(points):
    history = PointHistory.initial(points)
    assert history.plastic.shape == history.elastic.shape == (points.count, points.components)
    assert not history.plastic.any() and not history.strain.any() and not history.equivalent.any()
    assert not history.elastic.any() and np.all(history.softening == 1.0)
