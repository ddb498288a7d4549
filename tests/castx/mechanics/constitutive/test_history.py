"""Histories of points: birth, remelting, which cells forget, checkpoints."""

from __future__ import annotations

import numpy as np
import pytest

from castx.materials.flow import PLASTIC, VISCOPLASTIC
from castx.mechanics.constitutive.history import PointHistory
from castx.mechanics.constitutive.law import Law
from castx.mechanics.constitutive.response import (
    respond,
)
from tests.castx.mechanics.constitutive.metals import (
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
    liquid, solid = at(points, law, 0.2), at(points, law, 1.0)
    history = PointHistory.initial(points, liquid=True).start(liquid.coherent, points)
    flowed = strains(points, 0.3, 1)
    history = after(points, liquid, history, flowed)
    born = history.start(solid.coherent, points)
    np.testing.assert_array_equal(born.birth, flowed)
    assert np.abs(respond(solid, born, flowed).stress).max() == 0.0
    change = strains(points, 1e-5, 2)
    np.testing.assert_allclose(
        respond(solid, born, flowed + change).stress, 2 * G * change, rtol=1e-8, atol=1.0
    )
    assert np.all(born.softening == 1.0)


def test_remelting_wipes_the_flow_of_the_solid(points):
    law = Law(metal(**NEWTONIAN), 560.0, PLASTIC)
    solid, liquid = at(points, law, 1.0), at(points, law, 0.0)
    history = PointHistory.initial(points, liquid=False).start(solid.coherent, points)
    history = after(points, solid, history, strains(points, 0.01, 1))
    assert history.equivalent.min() > 0 and np.abs(history.plastic).max() > 0
    same = history.start(solid.coherent, points)
    np.testing.assert_array_equal(same.plastic, history.plastic)
    melting = history.start(liquid.coherent, points)
    assert melting.equivalent.max() == np.abs(melting.plastic).max() == 0.0
    history = after(points, liquid, melting, strains(points, 0.02, 2))
    frozen = history.start(solid.coherent, points)
    np.testing.assert_array_equal(frozen.birth, strains(points, 0.02, 2))
    assert frozen.equivalent.max() == np.abs(frozen.plastic).max() == 0.0


def test_only_cells_that_change_forget(points):
    law = Law(metal(**NEWTONIAN), 560.0, PLASTIC)
    solid = at(points, law, 1.0)
    history = PointHistory.initial(points, liquid=False).start(solid.coherent, points)
    history = after(points, solid, history, strains(points, 0.01, 1))
    melts = np.arange(points.cells) % 3 == 0
    begun = history.start(~melts, points)
    np.testing.assert_array_equal(begun.plastic[~melts], history.plastic[~melts])
    np.testing.assert_array_equal(begun.birth[~melts], history.birth[~melts])
    assert np.abs(begun.plastic[melts]).max() == 0.0
    np.testing.assert_array_equal(begun.birth[melts], history.strain[melts])


def test_saved_arrays_give_the_history_back(points):
    law = Law(metal(), 560.0, PLASTIC)
    solid, history = at(points, law, 1.0), PointHistory.initial(points, liquid=False)
    history = after(points, solid, history, strains(points, 0.01, 1))
    saved = history.saved(points)
    assert set(saved) == set(PointHistory._fields)
    assert all(len(part.values) == points.cells for part in saved.values())
    arrays = {name: part.values for name, part in saved.items()}
    found = PointHistory.initial(points, liquid=True).restored(arrays)
    for name, values in found._asdict().items():
        np.testing.assert_array_equal(values, getattr(history, name), err_msg=name)
    assert history.equivalent.min() > 0.0


@pytest.mark.parametrize("liquid", [True, False])
def test_an_unstrained_body(points, liquid):
    history = PointHistory.initial(points, liquid)
    assert history.plastic.shape == history.birth.shape == (points.count, points.components)
    assert not history.plastic.any() and not history.strain.any() and not history.equivalent.any()
    assert np.all(history.softening == 1.0) and np.all(history.coherent == (not liquid))
