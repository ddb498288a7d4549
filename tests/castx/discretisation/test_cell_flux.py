"""Heat flux of a linear temperature, exact in every cell, and of all bodies of a case."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.discretisation.cell_flux import CellHeatFlux, potentials_of
from castx.input.toml_text import parse_toml
from tests.castx.fakes import slab_mesh
from tests.castx.many_runs import CASE

pytestmark = pytest.mark.serial


def test_a_linear_temperature_has_an_even_flux(comm):
    body = slab_mesh(comm, 2e-3).bodies["casting"]
    flux = CellHeatFlux(body, lambda temperature: 40.0 * temperature)
    found = flux(300.0 + body.points @ [1e4, -2e3])
    np.testing.assert_allclose(found, np.tile([-4e5, 8e4], (len(found), 1)), rtol=1e-9)


def test_each_body_has_the_potential_of_its_material():
    case = read_case(parse_toml(CASE), Path("case.toml"))
    found = potentials_of(case)
    assert list(found) == ["casting", "mould"]
    for name, conductivity in (("casting", 150.0), ("mould", 35.0)):
        low, high = found[name](np.array([100.0, 300.0]))
        assert high - low == pytest.approx(200.0 * conductivity)
