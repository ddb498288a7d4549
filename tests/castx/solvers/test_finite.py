"""States with NaN or infinity are refused on all ranks."""

from __future__ import annotations

import numpy as np
import pytest
from dolfinx import fem

from castx.errors import ConvergenceError
from castx.solvers.finite import require_finite
from tests.castx.fakes import cylinder_mesh


@pytest.mark.ranks
def test_a_state_that_is_not_a_number_is_named_on_all_ranks(comm):
    mesh = cylinder_mesh(comm)
    fields = {name: fem.Function(body.nodes) for name, body in mesh.bodies.items()}
    require_finite(comm, {"temperature": fields})
    points = mesh.bodies["mould"].points
    fields["mould"].x.array[np.linalg.norm(points - [0.03, 0.04], axis=1) < 1e-9] = np.inf
    wrong = r"temperature of body 'mould' is not a finite number at \(0\.03, 0\.04\) m"
    with pytest.raises(ConvergenceError, match=wrong):
        require_finite(comm, {"temperature": fields})
