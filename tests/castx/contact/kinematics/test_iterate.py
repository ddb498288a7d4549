"""Constrained rows: which unknowns have a condition, and how far off they are."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.kinematics.iterate import ConstrainedRows

pytestmark = pytest.mark.serial


def test_constraints_add_up_and_leave_forces_alone():
    forces = np.array([1.0, 2.0, 3.0, 4.0])
    rows = ConstrainedRows(forces)
    rows.constrain(np.array([1], dtype=np.int32), np.array([0.5]))
    rows.constrain(np.array([3, 0], dtype=np.int32), np.array([-0.25, 0.0]))
    np.testing.assert_array_equal(rows.constrained, [True, True, False, True])
    np.testing.assert_array_equal(rows.violation, [0.0, 0.5, 0.0, -0.25])
    rows.forces += 1.0
    np.testing.assert_array_equal(forces, [2.0, 3.0, 4.0, 5.0])
