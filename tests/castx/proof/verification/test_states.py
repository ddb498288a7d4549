import numpy as np
import pytest

from castx.errors import CaseError
from castx.proof.verification.contact.shrink_fit import ShrinkFit, fitted_case
from castx.proof.verification.states import (
    cell_volumes,
    cellwise,
    centres,
    drawn_mesh,
    nodal,
    pair_areas,
    pair_places,
    paired,
    places,
    profile,
    states,
)


@pytest.fixture(scope="module")
def fit():
    return ShrinkFit()


@pytest.mark.ranks
def test_fields_of_all_ranks_belong_to_their_places(comm, fit):
    for state in states(comm, fitted_case(fit, fit.inner / 6)):
        volumes = cell_volumes(state, "casting")
        radius = np.linalg.norm(centres(state, "casting"), axis=1)
        stress = cellwise(state, "casting", "stress")
        points, moved = places(state, "core"), nodal(state, "core", "displacement")
        x, along = profile(state, "core", "displacement")
        pairs = pair_places(state, "casting/core")
        areas = pair_areas(state, "casting/core")
        pressures = paired(state, "casting/core", "contact_pressure")
    area = np.pi / 4 * (fit.outer**2 - fit.inner**2)
    assert volumes.sum() == pytest.approx(area, rel=0.02)
    assert len(volumes) == len(radius) == len(stress)
    assert radius.min() > fit.inner
    # The core is under one pressure: its points move towards the axis in proportion to their place.
    strain = -fit.pressure * (1 - fit.shaft[1]) / fit.shaft[0]
    np.testing.assert_allclose(moved, strain * points, atol=0.02 * abs(strain) * fit.inner)
    assert (np.diff(x) > 0).all() and x[0] == 0.0
    np.testing.assert_allclose(along[:, 0], strain * x, atol=0.02 * abs(strain) * fit.inner)
    np.testing.assert_allclose(np.linalg.norm(pairs, axis=1), fit.inner, rtol=1e-3)
    assert areas.sum() == pytest.approx(np.pi / 2 * fit.inner, rel=0.01)
    assert len(pressures) == len(areas) == len(pairs)


@pytest.mark.ranks
def test_what_cannot_be_drawn_is_refused_on_all_ranks(comm):
    def draw():
        raise CaseError("no such shape")

    with pytest.raises(CaseError, match="no such shape"), drawn_mesh(comm, draw):
        pass
