"""What both sides of an interface face, in words."""

import numpy as np
import pytest

from castx.case.contact import Pairing
from castx.domain.pairs.areas import area_text, area_warning
from tests.castx.domain.interface_meshes import NAMES, box, pairs_by


@pytest.mark.ranks
def test_matching_surfaces_have_equal_areas(comm):
    mesh = box(comm, "plane-strain", "simplices")
    pairs = pairs_by(Pairing(kind="node-to-face"), mesh, *NAMES)
    area = comm.allreduce(pairs.areas.sum())
    np.testing.assert_allclose(pairs.primary_area, area, rtol=1e-9)
    assert area_warning(pairs, comm) == ""
    assert area_text(pairs, comm).startswith(f"{1e4 * area:.4g} cm² of casting face")
