"""A die plate held sideways, heated and cooled: αΔT/(1 - ν), and the life that follows.

Plane strain holds it in one direction, both ends in the other; it is free to grow upwards, so that
its stress is E α ΔT/(1 - ν) in both (Timoshenko and Goodier, section 149).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.command.run import run
from castx.errors import CaseError
from castx.foundry.die_life import Fatigue
from castx.foundry.stress.die_surfaces import LIFE, STRAIN_RANGE
from castx.input.toml_text import parse_toml
from castx.results.reading import Results

EXPANSION, RISE, POISSON, YOUNG = 12.5e-6, 300.0, 0.29, 205e9
CURVE = Fatigue(2000e6, -0.08, 0.4, -0.65)
CASE = f"""
[geometry]
generator = "slab"
model = "plane-strain"
length = 0.04
width = 0.02
size = 0.01
[materials.die-steel]
young_modulus = {YOUNG}
poisson_ratio = {POISSON}
expansion = {EXPANSION}
stress_free = 20
[materials.die-steel.fatigue]
strength = 2000e6
strength_exponent = -0.08
ductility = 0.4
ductility_exponent = -0.65
[[bodies]]
name = "casting"
material = "die-steel"
temperature = 20
temperature_history = [[0, 20], [1, {20 + RISE}], [2, 20]]
[[boundaries]]
on = "casting/wall"
displacement = {{ normal = 0 }}
[[boundaries]]
on = "casting/far"
displacement = {{ normal = 0 }}
[[boundaries]]
on = "casting/bottom"
displacement = {{ normal = 0 }}
[time]
end = 2
fixed_step = 0.25
first_step = 0.25
largest_step = 0.25
[coupling]
scheme = "mechanical"
[solver]
mechanics_tolerance = 1e-10
[output]
every = 0.5
fields = ["von_mises", "strain_range", "life"]
"""


@pytest.fixture(scope="module")
def folder(written_case):
    return written_case(CASE).parent


def fields(folder, comm, name, *overrides):
    """Return strain range and life at the end of a run."""
    run(folder / "case.toml", list(overrides), output=folder / name, comm=comm)
    results = Results(folder / name)
    return tuple(results.field(field, "casting").values for field in (STRAIN_RANGE, LIFE))


def test_full_restraint(comm, folder):
    """The range stays when the stress has gone again."""
    strain, life = fields(folder, comm, "whole")
    np.testing.assert_allclose(strain, 5.281690e-3, rtol=1e-6)
    np.testing.assert_allclose(life, CURVE.cycles(np.array([5.28169014e-3]), YOUNG)[0], rtol=1e-5)
    results = Results(folder / "whole")
    hot = results.field("von_mises", "casting", 1.0).values
    np.testing.assert_allclose(hot, 1082.746e6, rtol=1e-6)
    assert results.field("von_mises", "casting").values.max() < 1.0


@pytest.mark.ranks
def test_extremes_so_far_go_on_after_a_break(comm, folder):
    before, _ = fields(folder, comm, "parts", "time.end=0.5")
    np.testing.assert_allclose(before, 0.5 * 5.281690e-3, rtol=1e-6)
    run(folder / "case.toml", output=folder / "parts", comm=comm, restart=True)
    found = Results(folder / "parts").field(STRAIN_RANGE, "casting").values
    np.testing.assert_allclose(found, 5.281690e-3, rtol=1e-6)


@pytest.mark.ranks
def test_stress_of_each_moment_counts_with_its_own_stiffness(comm, folder):
    """E falls by half until it is hot; the range stays that of the strain."""
    weak = [[20.0, YOUNG], [20.0 + RISE, 0.5 * YOUNG]]
    strain, life = fields(folder, comm, "weak", f"materials.die-steel.young_modulus={weak}")
    np.testing.assert_allclose(strain, 5.281690e-3, rtol=1e-6)
    usual = CURVE.cycles(np.array([5.28169014e-3]), 0.75 * YOUNG)[0]
    np.testing.assert_allclose(life, usual, rtol=1e-5)


@pytest.mark.ranks
def test_each_coefficient_changes_the_life(comm, folder):
    usual = CURVE.cycles(np.array([5.28169014e-3]), YOUNG)
    fatigue = {"strength": 1800e6, "ductility": 0.5}
    changes = [f"materials.die-steel.fatigue.{key}={value}" for key, value in fatigue.items()]
    _, life = fields(folder, comm, "other", *changes)
    other = Fatigue(1800e6, -0.08, 0.5, -0.65).cycles(np.array([5.28169014e-3]), YOUNG)
    np.testing.assert_allclose(life, other[0], rtol=1e-5)
    assert abs(other[0] / usual[0] - 1.0) > 0.05


@pytest.mark.serial
def test_life_is_refused_without_coefficients():
    content = parse_toml(CASE)
    del content["materials"]["die-steel"]["fatigue"]
    with pytest.raises(CaseError, match="'die-steel' needs fatigue = "):
        read_case(content, Path("die.toml"))
    content["output"]["fields"] = ["strain_range"]
    read_case(content, Path("die.toml"))


@pytest.mark.parametrize("cold", [410e6, 1600e6], ids=["as soft", "harder"])
def test_what_flows_to_and_fro_counts_once(comm, folder, cold):
    """Heated, the plate yields at -σ_y by α ΔT - (1 - ν) σ_y/E in its plane; cooled, at a cold σ_y.

    What lies farthest apart is the start and the hot end: σ_y/E and the equivalent of the strain,
    twice that in the plane. From there the harder plate comes back elastically, and its end is no
    farther from the start, however much stress it has then against what has flowed.
    """
    flow = 410e6
    strain, _ = fields(
        folder, comm, f"yielding at {cold:g}",
        f"materials.die-steel.yield_stress=[[20, {cold}], [{20 + RISE}, {flow}]]",
        "bodies.0.law=thermo-elasto-plastic",
    )  # fmt: skip
    elastic = flow / YOUNG
    plastic = 2.0 * (EXPANSION * RISE - (1.0 - POISSON) * elastic)
    assert elastic + plastic == pytest.approx(6.66e-3, rel=1e-12)
    np.testing.assert_allclose(strain, elastic + plastic, rtol=1e-6)
