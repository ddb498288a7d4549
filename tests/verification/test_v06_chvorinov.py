"""V6: the solidification time of plates in a sand mould grows with (V/A)².

Source: N. Chvorinov, Giesserei 27 (1940) 177. With perfect contact and sand that is thick enough,
plates of the same superheat have similar temperature fields, so the rule is exact.
The field `modulus` of a run is V/A in the middle of a plate, which freezes last.
"""

from __future__ import annotations

import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.command.run import RunSettings, run_case
from castx.heat.body import HeatBody
from castx.proof.verification.heat.chvorinov import (
    LATENT,
    MELTING,
    METAL,
    MOULD,
    SAND,
    START,
    THICKNESSES,
    rough_time,
    sand_depth,
)
from castx.results.reading import Results
from tests.verification.heat_strips import (
    casting_on_mould,
    material,
    profile,
    run,
    solid_thickness,
    strip,
)

SIZE = 0.5e-3


def solidification_time(comm, thickness: float) -> float:
    """Return when the middle of a plate is solid; half of the plate is meshed."""
    half = thickness / 2
    expected = rough_time(half)
    mesh = strip(comm, size=SIZE, length=half, mould_length=sand_depth(half, SIZE))
    metal, sand = material(**METAL), material(**MOULD)
    heat = casting_on_mould(
        mesh, [HeatBody("casting", metal, START), HeatBody("mould", sand, SAND)], "perfect"
    )
    solid = [(0.0, 0.0)]
    run(
        heat,
        expected / 100,
        2 * expected,
        [None],
        look=lambda time: solid.append((time, solid_thickness(mesh, heat, SIZE) / half)),
    )
    assert profile(mesh, heat, "mould")[1][0] == pytest.approx(SAND, abs=0.5)
    times, parts = np.array(solid).T
    return float(times[np.flatnonzero(parts > 1 - 1e-9)[0]])


@pytest.mark.serial
def test_time_grows_with_the_square_of_the_modulus(comm):
    thickness = np.array(THICKNESSES)
    times = np.array([solidification_time(comm, value) for value in thickness])
    constant = times / (thickness / 2) ** 2
    assert constant == pytest.approx(constant.mean(), rel=0.05)


@pytest.mark.parametrize("half", [5e-3, 20e-3])
def test_the_field_modulus_is_volume_over_surface(comm, shared_tmp_path, half):
    size = half / 10
    heat = LATENT + METAL["heat_capacity"]["liquid"] * (START - MELTING)
    expected = np.pi / 4 * (heat / (MELTING - SAND)) ** 2 / (0.6 * 1.76e6) * half**2
    depth = size * np.ceil(8 * np.sqrt(0.6 / 1.76e6 * expected) / size)
    step = expected / 60
    described = {
        "geometry": {"generator": "two_slabs", "model": "plane-strain", "length": half,
                     "mould_length": float(depth), "width": size, "size": size},
        "materials": {"metal": METAL, "sand": MOULD},
        "bodies": [{"name": "casting", "material": "metal", "temperature": START},
                   {"name": "mould", "material": "sand", "temperature": SAND}],
        "interfaces": [{"bodies": ["casting", "mould"], "contact": {"method": "none"},
                        "heat": {"law": "perfect"}}],
        "coupling": {"scheme": "thermal"},
        "time": {"end": 1.2 * expected, "first_step": step, "largest_step": step,
                 "fixed_step": step},
        "foundry": {"modulus_mould": {"material": "sand", "temperature": SAND}},
        "output": {"folder": str(shared_tmp_path / "out"), "fields": ["modulus"]},
    }  # fmt: skip
    case = read_case(described, shared_tmp_path / "v6.toml")
    field = Results(run_case(case, RunSettings(comm))).field("modulus", "casting")
    middle = np.isclose(field.points[:, 0], half)
    assert field.values[middle] == pytest.approx(half, rel=0.05)
    assert np.nanmax(field.values) == pytest.approx(field.values[middle].max(), rel=1e-6)
