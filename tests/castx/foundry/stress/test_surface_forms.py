"""Flatness of a bent plate and roundness of an oval hole, and both in the record of a run."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.case.reading.read import read_case
from castx.domain.mesh import build_mesh
from castx.errors import CaseError, MeshError
from castx.foundry.stress.surface_forms import SurfaceForms
from castx.process.simulation import Simulation
from castx.results.reading import Results
from castx.results.writing import ResultsWriter
from tests.castx.fakes import cylinder_mesh

LENGTH, CURVATURE, OVAL = 0.1, 0.02, 3e-5


@pytest.mark.ranks
def test_a_bent_plate(comm):
    """κ L²/8 of a parabola, whatever it is turned by."""
    sizes = {"length": LENGTH, "width": 0.02, "size": 5e-3}
    description = {"model": "plane-strain", "generator": "slab", **sizes}
    mesh = build_mesh(Geometry.model_validate(description), ["casting"], comm)
    points = mesh.bodies["casting"].points
    bent = np.zeros_like(points)
    bent[:, 1] = 0.5 * CURVATURE * (points[:, 0] - LENGTH / 2) ** 2 + 1e-3 * points[:, 0]
    found = SurfaceForms(mesh, ["casting/top", "other/top"], []).of("casting", bent)
    assert found == {"flatness": {"top": pytest.approx(CURVATURE * LENGTH**2 / 8, rel=1e-4)}}


@pytest.mark.ranks
def test_an_oval_ring(comm):
    """Of r = R + δ cos 2φ it is 2 δ, with the images of the quarter."""
    sizes = {"core_radius": 0.03, "outer_radius": 0.06, "size": 2e-3}
    description = {"model": "plane-stress", "generator": "core_in_ring", **sizes}
    mesh = build_mesh(Geometry.model_validate(description), ["core", "casting"], comm)
    points = mesh.bodies["casting"].points
    radius = np.linalg.norm(points, axis=1, keepdims=True)
    angle = np.arctan2(points[:, 1], points[:, 0])[:, None]
    found = SurfaceForms(mesh, [], ["casting/outside"]).of(
        "casting", OVAL * np.cos(2 * angle) * points / radius
    )
    assert found["roundness"]["outside"] == pytest.approx(2 * OVAL, rel=1e-3)


def test_the_end_of_a_ring_is_flat_across_its_axis(comm):
    mesh = cylinder_mesh(comm)
    points = mesh.bodies["casting"].points
    conical = np.column_stack([np.zeros(len(points)), 1e-2 * points[:, 0]])
    found = SurfaceForms(mesh, ["casting/top"], []).of("casting", conical)
    assert found["flatness"]["top"] == pytest.approx(1e-2 * 0.02, rel=1e-9)


CONTENT = {
    "geometry": {"generator": "core_in_ring", "model": "plane-stress", "core_radius": 0.03,
                 "outer_radius": 0.06, "size": 5e-3},
    "materials": {"a": {"young_modulus": 1e9, "poisson_ratio": 0.3, "expansion": 1e-5,
                        "stress_free": 20}},
    "bodies": [{"name": name, "material": "a", "temperature": 20} for name in ("core", "casting")],
    "interfaces": [{"bodies": ["casting", "core"]}],
    "time": {"end": 1, "fixed_step": 1},
    "coupling": {"scheme": "mechanical"},
    "foundry": {"round": ["casting/outside"], "flat": ["casting/symmetry-x"]},
}  # fmt: skip


def content(**foundry):
    return {**CONTENT, "foundry": foundry}


@pytest.mark.serial
def test_other_models_and_bodies_are_refused():
    with pytest.raises(CaseError, match="no body 'mold' that deforms"):
        read_case(content(flat=["mold/top"]), Path("case.toml"))
    axisymmetric = {"generator": "cylinder_in_mould", "model": "axisymmetric", "radius": 0.02,
                    "height": 0.04, "wall": 0.01, "size": 5e-3}  # fmt: skip
    bodies = [{"name": name, "material": "a", "temperature": 20} for name in ("casting", "mould")]
    other = {**content(round=["casting/top"]), "geometry": axisymmetric, "bodies": bodies,
             "interfaces": [{"bodies": ["casting", "mould"]}]}  # fmt: skip
    with pytest.raises(CaseError, match=r"foundry\.round.*in plane models"):
        read_case(other, Path("case.toml"))


@pytest.mark.ranks
def test_a_run_says_them_at_the_end_of_its_stages(comm, tmp_path):
    """A mesh of a circle that nothing deforms: round to rounding."""
    case = read_case(CONTENT, tmp_path / "case.toml")
    case = case.model_copy(
        update={"output": case.output.model_copy(update={"folder": Path(comm.bcast(tmp_path))})}
    )
    simulation = Simulation.from_case(case, comm)
    with ResultsWriter(case, simulation.mesh, simulation.pairs) as results:
        for state in simulation:
            results.write(state)
    (end,) = Results(case.output.folder).record["stage_ends"]
    found = end["bodies"]["casting"]
    assert found["roundness"] == {"outside": pytest.approx(0.0, abs=1e-9)}
    assert found["flatness"] == {"symmetry-x": pytest.approx(0.0, abs=1e-9)}


METAL = {"density": 2700, "heat_capacity": 1000, "conductivity": 100, "young_modulus": 70e9,
         "poisson_ratio": 0.33, "expansion": 2e-5, "stress_free": 20}  # fmt: skip
ONE_STEP = {"end": 1, "fixed_step": 1}
THICKNESS, DIFFERENCE = 0.02, 200.0


def bent_strip(size, model, depth):
    """Return a strip whose temperature rises across it, and stays so."""
    sizes = {"length": LENGTH, "width": THICKNESS, "size": size}
    sizes |= {"depth": depth} if depth else {}
    across = {"along": "y", "table": [[0.0, 20.0], [THICKNESS, 20.0 + DIFFERENCE]]}
    sides = ("bottom", 20.0), ("top", 20.0 + DIFFERENCE)
    return {
        "geometry": {"generator": "slab", "model": model, "cells": "quadrilaterals", **sizes},
        "materials": {"metal": METAL},
        "bodies": [{"name": "casting", "material": "metal", "temperature": across}],
        "boundaries": [{"on": f"casting/{side}", "heat": {"type": "temperature", "value": value}}
                       for side, value in sides],
        "time": ONE_STEP,
        "foundry": {"flat": ["casting/top"]},
    }  # fmt: skip


@pytest.mark.parametrize(("model", "depth"), [("plane-stress", 0.0), ("3d", 0.02)])
def test_a_strip_bends_that_is_warmer_on_one_side(comm, shared_tmp_path, model, depth):
    """Free of stress it takes the curvature κ = α ΔT/h in both directions: κ (L² + B²)/8."""
    size = 1.25e-3 if model == "plane-stress" else 2.5e-3
    expected = METAL["expansion"] * DIFFERENCE / THICKNESS * (LENGTH**2 + depth**2) / 8
    strips = (bent_strip(s, model, depth) for s in (2 * size, size))
    found = [form_after(comm, shared_tmp_path, strip)["flatness"]["top"] for strip in strips]
    coarse, fine = 1.0 - np.array(found) / expected
    assert abs(fine) < 0.01 and coarse == pytest.approx(4 * fine, rel=0.1)


OUTER, INNER, RISE = 0.06, 0.03, 300.0 / 0.06**2


def warm_ring(size):
    """Return a ring round a core that it leaves alone, with T = a x² and next to no conduction."""
    along = np.linspace(0.0, OUTER, 241)
    warm = {"along": "x", "table": [[x, 20.0 + RISE * x**2] for x in along.tolist()]}
    return {
        "geometry": {"generator": "core_in_ring", "model": "plane-stress", "core_radius": INNER,
                     "outer_radius": OUTER, "size": size},
        "materials": {"metal": {**METAL, "conductivity": 1e-6}},
        "bodies": [{"name": "core", "material": "metal", "temperature": 20, "law": "rigid"},
                   {"name": "casting", "material": "metal", "temperature": warm}],
        "interfaces": [{"bodies": ["casting", "core"], "contact": {"method": "none"},
                        "heat": {"law": "none"}}],
        "time": ONE_STEP,
        "foundry": {"round": ["casting/outside", "casting/core"]},
    }  # fmt: skip


@pytest.mark.ranks
def test_a_ring_becomes_oval_that_is_warmer_at_its_sides(comm, shared_tmp_path):
    """Of T = a x² in plane stress the part a r²/2 cos 2φ, harmonic, sets free δ = α a R³/6 cos 2φ.

    Harmonic temperatures strain a plane without stress where no displacement jumps round a hole:
    u + iv = α ∫ (a/2) z² dz. The rest of T, a r²/2, widens all radii alike.
    """
    found = [form_after(comm, shared_tmp_path, warm_ring(size)) for size in (3e-3, 1.5e-3)]
    for surface, radius, error in (("outside", OUTER, 0.005), ("core", INNER, 0.03)):
        expected = 2 * METAL["expansion"] * RISE * radius**3 / 6
        coarse, fine = (1.0 - form["roundness"][surface] / expected for form in found)
        assert abs(fine) < error and coarse == pytest.approx(4 * fine, rel=0.1), surface


def form_after(comm, folder, described):
    """Return the forms of the casting at the end of a run."""
    case = read_case({**described, "output": {"folder": str(folder / "out")}}, folder / "case.toml")
    simulation = Simulation.from_case(case, comm)
    with ResultsWriter(case, simulation.mesh, simulation.pairs) as results:
        for state in simulation:
            results.write(state)
    simulation.destroy()
    (end,) = Results(case.output.folder).record["stage_ends"]
    return end["bodies"]["casting"]


@pytest.mark.parametrize("key", ["flat", "round"])
def test_an_unknown_surface_is_refused_before_the_first_step(comm, key):
    case = read_case(content(**{key: ["casting/outsid"]}), Path("case.toml"))
    with pytest.raises(MeshError, match=rf"foundry\.{key}\[0\].*no surface 'outsid'.*\"outside\""):
        Simulation.from_case(case, comm)
