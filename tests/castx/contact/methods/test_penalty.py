"""The penalty method: pressure by hand, and its key."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.methods.penalty import METHOD, LinearPairLaw, PenaltyKind, linear_pair_law
from castx.errors import CaseError

pytestmark = pytest.mark.serial


def test_force_by_hand():
    """Areas 2 and 3 cm², ε 1e10 Pa/m, λ 1 MPa, penetration 10 µm: 1.1 MPa, and 0.8 MPa apart."""
    areas = np.array([2e-4, 3e-4])
    law = linear_pair_law({})
    assert isinstance(law, LinearPairLaw)
    found = law.force(np.array([-1e-5, 2e-5]), areas, 1e10 * areas, 1e6 * areas)
    np.testing.assert_allclose(found, [220.0, 240.0], rtol=1e-14)


def test_penalties():
    assert PenaltyKind().read("auto") == "auto"
    assert PenaltyKind().read("2 GPa/mm") == 2e12
    for wrong in (0, -1.0, "1 GPa", "automatic"):
        with pytest.raises(CaseError, match='or "auto"'):
            PenaltyKind().read(wrong)


def test_each_interface_may_have_its_own_penalty():
    assert [key.common for key in METHOD.keys] == [False]
