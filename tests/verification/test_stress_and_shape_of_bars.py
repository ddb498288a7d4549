"""Stress and shape that a run reports of a bar that cools, free and held at its ends.

Free, it contracts by e = α ΔT in all directions and has no stress, and its sides lie inward by e
times half the extent. Held along x it bears σ = E α ΔT there and nothing across, where it contracts
by (1 + ν) α ΔT. All is uniform, so that both are exact on any mesh.
"""

from __future__ import annotations

import numpy as np
import pytest

from castx.command.run import run
from castx.results.reading import Results

ALPHA, YOUNG, POISSON, DROP = 1.2e-5, 70e9, 0.33, 100.0
SIZES = (0.06, 0.02, 0.02)
CASE = f"""
[geometry]
generator = "slab"
model = "3d"
length = {SIZES[0]}
width = {SIZES[1]}
depth = {SIZES[2]}
size = 0.01
[[bodies]]
name = "casting"
material = "metal"
temperature_history = [[0, 120], [1, 20]]
[materials.metal]
density = 2700
heat_capacity = 1000
conductivity = 100
young_modulus = {YOUNG}
poisson_ratio = {POISSON}
expansion = {ALPHA}
[time]
end = 1
fixed_step = 0.5
first_step = 0.5
largest_step = 0.5
[coupling]
scheme = "mechanical"
[solver]
linear = "direct"
mechanics_tolerance = 1e-12
[output]
fields = ["largest_principal_stress", "smallest_principal_stress", "deviation", "von_mises"]
"""
HELD = """
[[boundaries]]
on = "casting/wall"
displacement = { x = 0 }
[[boundaries]]
on = "casting/far"
displacement = { x = 0 }
"""


def results(comm, folder, text):
    path = folder / "bar.toml"
    if comm.rank == 0:
        path.write_text(text)
    comm.Barrier()
    return Results(run(path, output=folder / "out", comm=comm))


def body_at_end(found):
    (end,) = found.record["stage_ends"]
    assert (end["stage"], end["cycle"], end["time"]) == (0, 1, 1.0)
    return end["bodies"]["casting"]


def test_a_free_bar_shrinks_without_stress(comm, shared_tmp_path):
    found = results(comm, shared_tmp_path, CASE)
    body, shrunk = body_at_end(found), ALPHA * DROP
    assert body["distortion"]["allowance"] == pytest.approx([shrunk] * 3, rel=1e-6)
    assert body["stress"]["von_mises"]["value"] < 1e-6 * YOUNG * shrunk
    field = found.field("deviation", "casting")
    assert np.nanmin(field.values) == pytest.approx(body["distortion"]["inward"]["value"])
    on_faces = np.isclose(field.points, 0.0) | np.isclose(field.points, SIZES)
    single = on_faces.sum(axis=1) == 1
    expected = -shrunk * (on_faces @ np.array(SIZES)) / 2.0
    np.testing.assert_allclose(field.values[single], expected[single], rtol=1e-6)
    assert np.isnan(field.values[~on_faces.any(axis=1)]).all() and single.any()


def test_a_bar_that_is_held_bears_what_it_may_not_shrink(comm, shared_tmp_path):
    found = results(comm, shared_tmp_path, CASE + HELD)
    body, shrunk = body_at_end(found), ALPHA * DROP
    stress = body["stress"]
    for name in ("largest_principal", "von_mises"):
        assert stress[name]["value"] == pytest.approx(YOUNG * shrunk, rel=1e-6), name
    assert stress["mean_von_mises"] == pytest.approx(YOUNG * shrunk, rel=1e-6)
    assert abs(stress["smallest_principal"]["value"]) < 1e-6 * YOUNG * shrunk
    across = (1.0 + POISSON) * shrunk
    shares = body["distortion"]["allowance"]
    assert shares[0] == pytest.approx(0.0, abs=1e-12)
    assert shares[1:] == pytest.approx([across] * 2, rel=1e-6)
    largest = found.field("largest_principal_stress", "casting")
    smallest = found.field("smallest_principal_stress", "casting")
    assert largest.in_cells
    np.testing.assert_allclose(largest.values, YOUNG * shrunk, rtol=1e-6)
    np.testing.assert_allclose(smallest.values, 0.0, atol=1e-6 * YOUNG * shrunk)
