"""A moment within a step: what is linear in time is met exactly, what is not known stays so."""

import numpy as np
import pytest

from castx.results.field_copies import FieldCopies, between

pytestmark = pytest.mark.serial


def copies(time):
    nodal = {"casting": {"temperature": np.array([700.0 - 30.0 * time, np.nan])}}
    return FieldCopies(time, (1, 0), nodal, {"casting": {"stress": 1e6 * time * np.eye(2)}})


def test_linear_fields_are_met_exactly():
    found = between(copies(2.0), copies(4.0), 2.5)
    assert found.time == 2.5 and found.phase == (1, 0)
    temperature = found.nodal["casting"]["temperature"]
    assert temperature[0] == pytest.approx(625.0) and np.isnan(temperature[1])
    np.testing.assert_allclose(found.cellwise["casting"]["stress"], 2.5e6 * np.eye(2))


def test_the_end_of_a_step_is_taken_as_it_is():
    after = copies(4.0)
    assert between(copies(2.0), after, 4.0) is after


def test_a_body_that_is_gone_by_the_end_has_no_fields():
    after = FieldCopies(4.0, (1, 0), {}, {})
    assert between(copies(2.0), after, 3.0).nodal == {}
