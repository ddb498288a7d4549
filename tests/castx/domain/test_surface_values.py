"""Pressures and tractions of a surface that vary with place and time."""

from __future__ import annotations

import numpy as np
import pytest

from castx.errors import CaseError
from castx.input.entries import Quantity
from castx.input.placed import Placing
from castx.input.units import STRESS
from castx.mechanics.description import SurfaceLoad
from castx.tables import Table
from tests.castx.mechanics.lone_bodies import alone


@pytest.mark.ranks
def test_a_load_may_vary_in_space_and_time(comm):
    """Of p = c t y on a side of height W the resultant is c t W²/2, the moment c t W³/3."""
    rising = Placing(Quantity(STRESS), moving=True)
    pressure = rising.read({"formula": "2e8*t*y"})
    pull = rising.read({"along": ["y", "t"], "table": [
        [0, 0, 0], [0.01, 0, 0], [0, 10, 0], ["1 cm", 10, "4 MPa"]]})  # fmt: skip
    loads = (
        SurfaceLoad("far", pressure=pressure),
        SurfaceLoad("far", traction=(Table.constant(3e6), pull)),
    )
    part = alone(comm, "plane-strain", loads=loads)
    for time in (2.0, 5.0):
        part.set_time(time)
        forces = part.formulation.forms.load.reshape(-1, part.block_size)[:, :2]
        y = part.mesh.points[: len(forces), 1]
        found = comm.allreduce(np.concatenate((forces.sum(axis=0), y @ forces)))
        p, t = 2e8 * time * 0.01, 4e5 * time
        exact = [3e4 - p * 0.01 / 2, t * 0.01 / 2, 150.0 - p * 1e-4 / 3, t * 1e-4 / 3]
        np.testing.assert_allclose(found, exact, rtol=1e-12)
    with pytest.raises(CaseError, match="load on far is not finite at 0 s: log"):
        wrong = SurfaceLoad("far", pressure=rising.read({"formula": "log(t - 1)"}))
        alone(comm, "plane-strain", loads=[wrong]).set_time(0.0)


@pytest.mark.ranks
def test_pressures_of_surfaces_are_known_at_their_nodes(comm):
    """Those that vary in space at each local node of their surface; several of one add up."""
    rising = Placing(Quantity(STRESS), moving=True).read({"formula": "2e8*t*y"})
    loads = [SurfaceLoad("far", pressure=rising), SurfaceLoad("far", pressure=Table.constant(1e6))]
    part = alone(comm, "plane-strain", loads=[*loads, SurfaceLoad("top", Table.constant(3.0))])
    part.set_time(2.0)
    found = part.loads.pressures()
    y = part.mesh.points[part.mesh.surface_nodes("far"), 1]
    np.testing.assert_allclose(found["far"], 4e8 * y + 1e6)
    assert found["top"] == 3.0
