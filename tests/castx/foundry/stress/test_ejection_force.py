"""The force to draw a shaft out of a hub into which it is pressed: V9, μ p S."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.command.run import run
from castx.errors import CaseError
from castx.input.toml_text import parse_toml
from castx.results.reading import Results

FORCE = 1.619573e6
CASE = """
[geometry]
generator = "core_in_ring"
model = "plane-stress"
core_radius = 0.03
outer_radius = 0.06
size = 2e-3
[materials.shaft]
young_modulus = 68e9
poisson_ratio = 0.33
expansion = 1e-5
stress_free = 20
[materials.hub]
young_modulus = 205e9
poisson_ratio = 0.29
expansion = 1e-5
stress_free = 20
[[bodies]]
name = "core"
material = "shaft"
temperature = 20
[[bodies]]
name = "casting"
material = "hub"
temperature = 20
temperature_history = [[0, 20], [1, 20], [3, 60]]
[[interfaces]]
bodies = ["casting", "core"]
contact = { initial_gap = -25e-6 }
[[stages]]
at = 2
remove = ["core"]
[time]
end = 3
fixed_step = 1
first_step = 1
largest_step = 1
[coupling]
scheme = "mechanical"
[solver]
mechanics_tolerance = 1e-9
[foundry]
ejection_friction = 0.2
"""


@pytest.fixture(scope="module")
def folder(written_case):
    return written_case(CASE).parent


@pytest.mark.ranks
def test_the_force_of_a_shrink_fit(comm, folder):
    """A quarter is meshed; the hub expands in the second step, in the third the shaft is gone."""
    run(folder / "case.toml", output=folder / "whole", comm=comm)
    results = Results(folder / "whole")
    force = results.history["casting/core.ejection_force"]
    assert 4 * force[1] == pytest.approx(FORCE, rel=1e-2)
    assert 0.0 < force[2] < 0.9 * force[1] and force[3] == 0.0
    first, last = results.record["ejection"]
    assert first == {"stage": 0, "cycle": 1, "time": 2.0, "forces": {"casting/core": force[2]}}
    assert last == {"stage": 1, "cycle": 1, "time": 3.0, "forces": {"casting/core": 0.0}}


@pytest.mark.ranks
def test_the_ends_of_stages_are_kept_through_a_break(comm, folder):
    run(folder / "case.toml", ["time.end=2.5"], output=folder / "parts", comm=comm)
    first, _ = Results(folder / "parts").record["ejection"]
    run(folder / "case.toml", output=folder / "parts", comm=comm, restart=True)
    whole = Results(folder / "parts").record["ejection"]
    assert whole[0] == first and whole[1]["time"] == 3.0


@pytest.mark.ranks
def test_it_is_proportional_to_the_friction(comm, folder):
    friction = "foundry.ejection_friction=0.4"
    run(folder / "case.toml", ["time.end=2", "stages=[]"], output=folder / "once", comm=comm)
    run(folder / "case.toml", [friction], output=folder / "twice", comm=comm)
    once, twice = (Results(folder / name).history for name in ("once", "twice"))
    column = "casting/core.ejection_force"
    np.testing.assert_allclose(twice[column][:3], 2 * once[column], rtol=1e-12)


@pytest.mark.serial
def test_a_negative_friction_is_refused():
    content = parse_toml(CASE)
    content["foundry"]["ejection_friction"] = -0.1
    with pytest.raises(CaseError, match="ejection_friction"):
        read_case(content, Path("case.toml"))
