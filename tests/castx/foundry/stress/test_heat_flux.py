"""Heat flux of V5, two plates with a given exchange, and of conductivities over temperature."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.command.run import run
from castx.errors import CaseError
from castx.foundry.stress.heat_flux import HEAT_FLUX, HeatFluxes
from castx.materials.conduction_potential import conduction_potential
from castx.results.reading import Results
from tests.castx.fakes import FakeSnapshot, cylinder_mesh
from tests.castx.materials.descriptions import alloy

pytestmark = pytest.mark.serial

PLATES = """
[geometry]
generator = "two_slabs"
model = "plane-strain"
length = 0.495
mould_length = 0.495
width = 0.11
size = 0.055
[materials.steel]
density = 8000
heat_capacity = 500
conductivity = 40
[[bodies]]
name = "casting"
material = "steel"
temperature = 20
[[bodies]]
name = "mould"
material = "steel"
temperature = 20
[[interfaces]]
bodies = ["casting", "mould"]
heat = { law = "constant", closed = 80 }
[[boundaries]]
on = "casting/far"
heat = { type = "temperature", value = 300 }
[[boundaries]]
on = "mould/far"
heat = { type = "temperature", value = 100 }
[time]
end = 3e9
fixed_step = 1e9
first_step = 1e9
largest_step = 1e9
[coupling]
scheme = "thermal"
[output]
fields = ["heat_flux"]
"""


def test_the_flux_through_two_plates_is_exact(comm, tmp_path):
    (tmp_path / "plates.toml").write_text(PLATES)
    run(tmp_path / "plates.toml", output=tmp_path / "out", comm=comm)
    results = Results(tmp_path / "out")
    for body in ("casting", "mould"):
        found = results.field(HEAT_FLUX, body)
        assert found.in_cells
        np.testing.assert_allclose(np.abs(found.values[:, 0]), 5369.13, rtol=1e-6)
        np.testing.assert_allclose(found.values[:, 1:], 0.0, atol=1e-4)


def test_it_goes_from_hot_to_cold_with_the_conductivity_of_each_place(comm):
    """θ is exact for k linear in T: -k(T) ∇T in the middle of cells is met to second order."""
    mesh = cylinder_mesh(comm, size=2e-3)
    steel = alloy(conductivity={"solid": [[0.0, 100.0], [500.0, 200.0]], "liquid": 90.0})
    fluxes = HeatFluxes(mesh, {"casting": conduction_potential(steel)})
    fluxes.update(FakeSnapshot(0.0, 0, mesh, {}, {"temperature": lambda x: 100.0 + 4e3 * x[:, 1]}))
    found = fluxes.field("casting", HEAT_FLUX)
    body = mesh.bodies["casting"]
    middle = body.points[body.nodes.dofmap.list].mean(axis=1)[:, 1]
    exact = -(100.0 + 0.2 * (100.0 + 4e3 * middle)) * 4e3
    np.testing.assert_allclose(found[:, 1], exact, rtol=3e-3)
    assert np.abs(found[:, 0]).max() < 5e-3 * np.abs(exact).max()
    assert fluxes.field("mould", HEAT_FLUX) is None


def test_without_the_heat_equation_it_is_refused():
    content = {
        "geometry": {"generator": "slab", "model": "plane-strain", "length": 1.0, "width": 1.0,
                     "size": 0.5},
        "materials": {"a": {"young_modulus": 1e9, "poisson_ratio": 0.3, "expansion": 1e-5,
                            "stress_free": 20}},
        "bodies": [{"name": "casting", "material": "a", "temperature": 20}],
        "time": {"end": 1}, "coupling": {"scheme": "mechanical"},
        "output": {"fields": ["heat_flux"]},
    }  # fmt: skip
    with pytest.raises(CaseError, match="there is no heat_flux"):
        read_case(content, Path("case.toml"))
