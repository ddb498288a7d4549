"""The law that conducts nothing."""

from __future__ import annotations

import numpy as np
import pytest

from castx.errors import CaseError
from tests.castx.transfer.law_samples import conductance

pytestmark = pytest.mark.serial


def test_nothing_is_conducted_at_any_gap_and_pressure():
    found = conductance({"law": "none"}, [-1e-6, 0.0, 1e-3], [1e6, 0.0, 0.0])
    np.testing.assert_array_equal(found.coefficient.value, [0.0] * 3)
    np.testing.assert_array_equal(found.coefficient.slopes, 0.0)


def test_radiation_is_the_only_key_it_takes():
    radiating = {"law": "none", "radiation": {"emissivities": [0.3, 0.8]}}
    np.testing.assert_array_equal(conductance(radiating).coefficient.value, 0.0)
    with pytest.raises(CaseError, match="closed: the law 'none' takes radiation"):
        conductance({"law": "none", "closed": 5})
