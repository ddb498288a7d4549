"""Feeding distance on the chilled wall V3, where pores are known at each distance from the wall.

The dimensionless Niyama value is 2884.563 x^(2/3), so that pores fall below 0.05 % at
x = 10.63441 mm; the feeder is the far end.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.command.run import run
from castx.errors import CaseError
from castx.foundry.pools.feeding_path import FEEDING_PATH, feeding_distance, paths_to
from castx.input.toml_text import parse_toml
from castx.results.reading import Results
from tests.castx.fakes import cylinder_mesh

LENGTH, SOUND = 0.06, 10.63441e-3
CASE = f"""
[geometry]
generator = "slab"
model = "plane-strain"
length = {LENGTH}
width = 1e-3
size = 5e-4
[materials.alloy]
density = 1000
heat_capacity = {{ solid = 2.75e3, liquid = 2.70e3 }}
conductivity = {{ solid = 180, liquid = 85 }}
latent_heat = 9.8e5
solidus = 560
liquidus = 615
melt_viscosity = 1.2e-3
arm_spacing = {{ coefficient = 4e-5 }}
cavitation = 1.01e5
solidification_shrinkage = {0.0625 / 1.0625!r}
[[bodies]]
name = "casting"
material = "alloy"
temperature = 640
[[boundaries]]
on = "casting/wall"
heat = {{ type = "temperature", value = 300 }}
[time]
end = 3
fixed_step = 0.03
first_step = 0.03
largest_step = 0.03
[coupling]
scheme = "thermal"
[output]
fields = ["feeding_path", "pore_fraction"]
[foundry]
feeders = ["casting/far"]
"""


@pytest.fixture(scope="module")
def folder(written_case):
    return written_case(CASE).parent


@pytest.mark.ranks
def test_pores_end_where_they_are_known_to(comm, folder):
    run(folder / "case.toml", output=folder / "wall", comm=comm)
    results = Results(folder / "wall")
    found = results.record["feeding_distance"]["casting"]
    assert LENGTH - found == pytest.approx(SOUND, rel=0.02)
    path = results.field(FEEDING_PATH, "casting")
    np.testing.assert_allclose(path.values, LENGTH - path.points[:, 0], atol=1e-9)


@pytest.mark.ranks
def test_the_distance_follows_the_limit_between_nodes(comm):
    """Pores that fall linearly along the axis."""
    mesh = cylinder_mesh(comm, cells="quadrilaterals")
    body = mesh.bodies["casting"]
    z = body.points[:, 1]
    paths = paths_to(body, z > 0.04 - 1e-9)
    np.testing.assert_allclose(paths, 0.04 - z, atol=1e-9)
    for limit in (2e-4, 5e-4):
        pores = 1e-3 * (1.0 - z / 0.04)
        found = feeding_distance(body, paths, pores, limit)
        assert found == pytest.approx(0.04 * limit / 1e-3, rel=1e-9)
    assert feeding_distance(body, paths, np.full(len(z), np.nan), 5e-4) is None
    assert feeding_distance(body, paths, np.ones(len(z)), 5e-4) is None


@pytest.mark.serial
def test_it_needs_what_pores_need():
    content = parse_toml(CASE)
    del content["materials"]["alloy"]["melt_viscosity"]
    with pytest.raises(CaseError, match=r"has no melt_viscosity.*leave feeding_path out"):
        content["output"]["fields"] = ["feeding_path"]
        read_case(content, Path("case.toml"))
    content = parse_toml(CASE)
    with pytest.raises(CaseError, match="porosity_limit"):
        read_case({**content, "foundry": {"porosity_limit": 0}}, Path("case.toml"))
