"""The shape of a casting that its feeder has fed: its pipe has the volume that it lacks.

An open rigid box of volume V whose metal shrinks by s and flows freely is fed βV of liquid,
β = s/(1 - s), by a surface of the area A, whose level as a prism falls by βV/A. What flows out
of it is sV, since what has gone freezes in the model too and asks for β of it; the shape that is
drawn and exported has (1 - s) V. With flow through a mush that freezes from its walls the same
holds up to what pores take: fed = (1 + β) pipe, for what froze while the surface was open.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import pyvista

from castx.case.reading.read import read_case
from castx.handover.export import Request, exported
from castx.handover.target import Target
from castx.process.simulation import Simulation
from castx.report.browser_scene import scene
from castx.report.reported import ReportedRun
from castx.results.reading import Results, cells_of
from castx.results.sunk_shape import measured, simplices, without_pipe
from castx.results.writing import ResultsWriter
from tests.castx.report.drawn_scenes import area, drawn, surface
from tests.coupled_cases import merged
from tests.verification.test_mush_flow import MUSH, SHRUNK
from tests.verification.test_rest_and_sealed_boxes import HEIGHT, SHRINKAGE, VOLUME, box, chilled

pytestmark = pytest.mark.serial

FREE = {"materials": {"alloy": {"arm_spacing": 0.01, "young_modulus": 7e14,
                                "liquid": {"viscosity": 1e12}}}}  # fmt: skip
TIGHT = {"solver": {"mechanics_tolerance": 1e-12, "linear": "direct"}}


def results_of(comm, data, folder: Path) -> Results:
    """Run a case whose metal flows, and return its results."""
    fields = ["solid_fraction", "displacement", "emptied"]
    data = merged(data, {"output": {"folder": str(folder), "fields": fields}})
    data["bodies"][0] |= {"feeding": "darcy"}
    case = read_case(data, Path("case.toml"))
    simulation = Simulation.from_case(case, comm)
    with ResultsWriter(case, simulation.mesh, simulation.pairs) as results:
        for state in simulation:
            results.write(state)
    return Results(folder)


def last(results: Results, name: str) -> float:
    """Return the last value of a column of the casting."""
    return float(results.history[f"casting.{name}"][-1])


def volume(grid: pyvista.UnstructuredGrid, model: str) -> float:
    """Return the volume of a body as it was meshed."""
    simple = simplices(grid)
    return float(measured(np.asarray(simple.points)[cells_of(simple)], model).sum())


@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_the_pipe_of_an_open_box(comm, tmp_path, model):
    results = results_of(comm, box({"geometry": {"lid": False}}, MUSH, FREE, TIGHT, model=model),
                         tmp_path / "out")  # fmt: skip
    whole = VOLUME[model]
    assert last(results, "fed_volume") == pytest.approx(SHRUNK * whole, rel=1e-8)
    # The one is summed over surfaces, the other over the balance: the last digit is of rounding.
    assert last(results, "fed_volume.free") == pytest.approx(last(results, "fed_volume"), rel=1e-14)
    assert last(results, "level_drop.free") == pytest.approx(SHRUNK * HEIGHT, rel=1e-8)
    assert last(results, "pipe_volume") == pytest.approx(SHRINKAGE * whole, rel=1e-6)
    casting = results.grids()["casting"]
    left = without_pipe(casting, model)
    assert volume(left, model) == pytest.approx((1 - SHRINKAGE) * whole, rel=1e-6)
    high = np.asarray(left.points)[:, 2 if model == "3d" else 1]
    assert high.max() == pytest.approx((1 - SHRINKAGE) * HEIGHT, rel=1e-6)  # it sinks evenly


@pytest.mark.parametrize("model", ["plane-strain", "3d"])
def test_the_view_to_turn_sinks_as_its_moments_pass(comm, tmp_path, model):
    data = box({"geometry": {"lid": False}}, MUSH, FREE, TIGHT, model=model)
    results_of(comm, data, tmp_path / "out")
    run = ReportedRun(tmp_path / "out")
    shown = scene(run)
    moments = [{"moment": m, "field": "solid_fraction"} for m in range(len(shown["times"]))]
    seen = drawn(shown, "casting", moments, tmp_path)
    left = [without_pipe(run.grids(time)["casting"], model) for time in shown["times"]]
    assert [area(one) for one in seen] == pytest.approx([surface(one) for one in left], rel=1e-4)
    high = [one[..., 2 if model == "3d" else 1].max() for one in seen]
    assert high == sorted(high, reverse=True)
    assert high[-1] == pytest.approx((1 - SHRINKAGE) * HEIGHT, rel=1e-4)


def test_the_exported_surface_has_the_pipe(comm, tmp_path):
    results = results_of(comm, box({"geometry": {"lid": False}}, MUSH, FREE, TIGHT, model="3d"),
                         tmp_path / "out")  # fmt: skip
    file = tmp_path / "part.stl"
    lines = exported(Request(tmp_path / "out", Target.STL, file, body="casting"))
    assert "is cut out" in lines[-1] and "not closed" not in " ".join(lines)
    surface = pyvista.read(file)
    moved = results.grids()["casting"]["displacement"]
    assert np.abs(moved).max() < 1e-6 * HEIGHT  # so that the volume is that of the mesh
    assert surface.is_manifold
    assert 1e-9 * surface.volume == pytest.approx((1 - SHRINKAGE) * VOLUME["3d"], rel=1e-5)


def test_the_pipe_of_metal_that_freezes_from_its_walls(comm, tmp_path):
    """Its surface shuts at last, and what then freezes where it is empty is never fed."""
    data = chilled({"geometry": {"lid": False}}, MUSH, FREE)
    data["bodies"][1]["temperature"] = 20.0
    results = results_of(comm, data, tmp_path / "out")
    assert last(results, "solid_fraction") == pytest.approx(1.0)
    fed, pipe = last(results, "fed_volume"), last(results, "pipe_volume")
    assert pipe == pytest.approx(fed / (1 + SHRUNK), rel=0.01)
    casting = results.grids()["casting"]
    left = without_pipe(casting, "plane-strain")
    assert volume(casting, "plane-strain") - volume(left, "plane-strain") == pytest.approx(
        pipe, rel=1e-6
    )
    bottom = np.asarray(left.points)[:, 1].min()
    assert bottom == pytest.approx(np.asarray(casting.points)[:, 1].min())
