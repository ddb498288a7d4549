"""What castx export writes and says, on a body made by hand and on one that was run."""

import json

import numpy as np
import pytest
import pyvista

from castx.command.run import run
from castx.errors import CaseError
from castx.handover.body_state import BodyState
from castx.handover.calculix import elements_of
from castx.handover.export import Request, exported
from castx.handover.target import Target
from castx.results.reading import Results
from tests.castx.handover.made_results import box, made

pytestmark = pytest.mark.serial

CASE = """
[geometry]
generator = "slab"
model = "{model}"
cells = "{cells}"
length = "20 mm"
width = "10 mm"
{depth}
size = "5 mm"
[[bodies]]
name = "casting"
material = "AlSi7Mg"
temperature = 680
law = "{law}"
[[boundaries]]
on = "casting/wall"
heat = {{ type = "convection", coefficient = 5000, ambient = 20 }}
[[boundaries]]
on = "casting/bottom"
displacement = {{ normal = 0 }}
[time]
end = "60 s"
first_step = 1
largest_step = 20
temperature_change = 200
[solver]
linear = "direct"
mechanics_tolerance = 1e-10
[output]
fields = ["temperature", "displacement", "stress", "point_stress", "plastic_strain", "pressure",
  "passing_times", "gradient", "front_speed", "cooling_rate", "arm_spacing"]
"""


def folder_of(tmp_path, model="3d", cells="simplices", law="thermo-elasto-viscoplastic"):
    depth = 'depth = "10 mm"' if model == "3d" else ""
    (tmp_path / "bar.toml").write_text(CASE.format(model=model, cells=cells, depth=depth, law=law))
    return run(tmp_path / "bar.toml", output=tmp_path / "out")


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("model", "cells"),
    [("3d", "simplices"), ("3d", "quadrilaterals"), ("plane-strain", "simplices")],
)
def test_a_body_that_is_free_is_in_equilibrium_in_the_elements_of_calculix(tmp_path, model, cells):
    folder = folder_of(tmp_path, model, cells)
    state = BodyState(Results(folder), "casting")
    forces, sizes = elements_of(state).forces()
    held = np.abs(state.points[:, 1]) < 1e-9
    forces[held, 1] = 0.0
    assert np.abs(elements_of(state).stress).max() > 1e6
    assert np.linalg.norm(forces, axis=1).max() < 1e-7 * sizes.max()


def test_all_kinds_are_written_of_a_run(tmp_path):
    folder = folder_of(tmp_path)
    (first, *lines) = exported(Request(folder, Target("calculix"), tmp_path / "ccx"))
    assert first == f"casting at 60 s of {folder}"
    assert any("classes of arm_spacing, width" in line for line in lines)
    assert any("written as *CLOAD" in line for line in lines)
    lines = exported(Request(folder, Target("csv"), tmp_path / "nodes.csv"))
    said = lines[0].replace(str(tmp_path), "")
    assert "27" not in said and lines[-1].endswith("when f_s = 0.9 passes")
    table = np.genfromtxt(tmp_path / "nodes.csv", delimiter=",", names=True)
    known = np.isfinite(table["cooling_rate"])
    product = table["G"] * table["R"]
    np.testing.assert_allclose(product[known], table["cooling_rate"][known], rtol=1e-9)
    exported(Request(folder, Target("exaca"), tmp_path / "e.csv", spacing="5 mm"))
    exported(Request(folder, Target("stl"), tmp_path / "part.stl", fit=True))
    lines = exported(Request(folder, Target("mould"), tmp_path / "mould.stl"))
    assert "moves by at most" in lines[-1]
    record = json.loads((folder / "run.json").read_text())
    (folder / "run.json").write_text(json.dumps({**record, "castx": "99"}))
    lines = exported(Request(folder, Target("csv"), tmp_path / "nodes.csv"))
    assert lines[-1].startswith(f"warning: {folder / 'run.json'} was written by castx 99, this is")


@pytest.mark.parametrize("written", [True, False])
def test_the_surface_says_whether_the_pipe_is_cut_out(tmp_path, written):
    points, cells = box(4)
    fields = {"displacement": np.tile([0.0, 0.0, 1e-3], (len(points), 1))}
    if written:
        fields["emptied"] = points[:, 2] / 0.01
    made(tmp_path / "out", "3d", points, cells, fields)
    record = tmp_path / "out" / "run.json"
    about = {**json.loads(record.read_text()), "feeding": {"casting": {"pipe_volume": 3e-6}}}
    record.write_text(json.dumps(about))
    *_, said = exported(Request(tmp_path / "out", Target("stl"), tmp_path / "part.stl"))
    cut = "is cut out" if written else "is not cut out: it needs the field emptied"
    assert said.startswith("the pipe of 3 cm³") and cut in said
    surface = pyvista.read(tmp_path / "part.stl")
    assert surface.is_manifold
    assert surface.volume == pytest.approx(3000.0 if written else 6000.0, rel=1e-5)
    assert surface.bounds[4:] == pytest.approx((1.0, 6.0 if written else 11.0), rel=1e-5)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"to": "exaca"}, "ExaCA needs the spacing of its grid"),
        ({"to": "exaca", "spacing": "-1"}, "a positive length is needed"),
        ({"to": "csv", "spacing": "1 mm"}, "--spacing belongs to --to exaca"),
        ({"to": "stl", "release": True}, "--release belongs to --to calculix"),
        ({"to": "mould", "output": "m.msh"}, "a mesh is moved, not made"),
        ({"to": "mould", "output": "m.stl", "mesh": "p.msh"}, "--mesh makes a .msh"),
        ({"to": "stl", "time": "soon"}, "--time soon"),
    ],
)
def test_what_does_not_fit_is_refused(tmp_path, changed, message):
    from pathlib import Path

    points, cells = box(4)
    made(tmp_path / "out", "3d", points, cells, {"displacement": 0.0 * points})
    given = {"folder": tmp_path / "out", "output": "part.stl", **changed}
    given["to"] = Target(given["to"])
    given |= {key: Path(given[key]) for key in ("output", "mesh") if key in given}
    with pytest.raises(CaseError, match=message):
        exported(Request(**given))
