"""What `castx check` tells before anything is solved, and what it refuses."""

from __future__ import annotations

import re
from types import SimpleNamespace

import numpy as np
import pytest
from rich.console import Console

from castx.case.boundaries import Boundary
from castx.case.contact import Pairing
from castx.case.heat_transfer import InterfaceHeat
from castx.case.interfaces import Interface
from castx.case.reading.read import load_case
from castx.command.check import (
    body_table,
    conditions_text,
    corner_text,
    faces_text,
    free_areas,
    free_text,
    heat_text,
    interface_text,
    size_text,
    surface_table,
)
from castx.command.cli import execute
from castx.command.watches.ranges import temperature_range
from castx.domain.summary import BodySummary, MeshSummary
from tests.castx.domain.interface_meshes import pairs_by
from tests.elastic_bodies import blocks
from tests.partitions import PARTITION, on_the_last


@pytest.mark.ranks
def test_check_names_what_the_mesh_has_and_warns(comm, case_file, said):
    assert execute(["check", str(case_file)], comm) == 0
    text = said()
    for name in ("casting/top", "mould/outside", "displacement normal", "9 pairs", "condensed"):
        assert name in text
    assert "steel-H13 (mould) has less data than the case has temperatures" in text
    assert "warning: steel-H13" not in text
    assert "young_modulus, poisson_ratio, expansion (20 to 600 °C)" in text


@pytest.mark.ranks
def test_check_refuses_a_mush_without_nodal_pressures_with_a_cure(comm, case_file, said):
    flows = ["bodies.0.material=AlSi7Mg", "bodies.0.feeding=darcy"]
    given = ["check", str(case_file), *(part for over in flows for part in ("--set", over))]
    assert execute(given, comm) == 0
    assert execute([*given, "--set", "geometry.cells=quadrilaterals"], comm) == 2
    text = said()
    assert "needs formulation 'mixed'" in text and "mesh it with triangles" in text
    assert 'casting: melt flows through its mush (feeding = "darcy"), fed by all free' in text


@pytest.mark.ranks
def test_check_counts_on_ranks_without_cells(comm, case_file, said, monkeypatch):
    monkeypatch.setattr(PARTITION, on_the_last)
    assert execute(["check", str(case_file)], comm) == 0
    assert "9 pairs" in said()


@pytest.mark.ranks
def test_gaps_of_facing_meshes_are_those_of_all_ranks(comm, monkeypatch):
    monkeypatch.setattr(PARTITION, on_the_last)
    mesh = blocks(comm, upper=(0.02, 0.01), base=(0.02, 0.01))
    pairs = pairs_by(Pairing(kind="node-to-face"), mesh, "upper", "base")
    described = Interface.read({"bodies": ["upper", "base"], "contact": {"method": "condensed"}})
    text = faces_text(described, pairs, comm)
    found = re.search(r": 3 nodes face facets, .* meshed gap (\S+) to (\S+) m, contact", text)
    assert found and np.abs([float(gap) for gap in found.groups()]).max() < 1e-12


@pytest.mark.ranks
def test_check_looks_at_patches_and_temperature_fields(comm, case_file, said):
    radiation = "interfaces.0.heat.radiation={ emissivities = [0.3, 0.8] }"
    patch = "interfaces.0.heat.patches=[{ within = { z = [%s, 1] }, closed = 500 }]"
    given = ["check", str(case_file), "--set", radiation, "--set", patch % 0.01]
    assert execute(given, comm) == 0
    assert "limited and radiation, other on 1 of its parts" in said()
    assert execute(["check", str(case_file), "--set", patch % 0.9], comm) == 2
    field = 'bodies.0.temperature={ file = "lost.vtu", field = "T" }'
    assert execute(["check", str(case_file), "--set", field], comm) == 2
    text = said()
    assert "heat.patches[0] adds no node" in text
    assert "initial temperature of 'casting': there is no file" in text


@pytest.mark.parametrize(
    "override, text",
    [
        ("bodies.0.material=Al-pur", "unknown material 'Al-pur'"),
        ("geometry.radius=-1", "must be positive"),
        ("time.ende=5", "unknown key"),
    ],
)
def test_a_refused_case_is_said_once_without_a_traceback(comm, case_file, said, override, text):
    assert execute(["check", str(case_file), "--set", override], comm) == 2
    output = said()
    assert output.count(text) == 1 and "Traceback" not in output and "castx: " in output


def test_a_missing_surface_and_a_missing_file_are_refused(comm, case_file, tmp_path, said):
    broken = case_file.with_name("broken.toml")
    if comm.rank == 0:
        broken.write_text(case_file.read_text().replace("mould/base", "mould/bottom"))
    comm.Barrier()
    assert execute(["check", str(broken)], comm) == 2
    assert "bottom" in said()
    assert execute(["check", "/nowhere/case.toml"], comm) == 2
    assert "/nowhere/case.toml" in said()


def test_temperatures_of_the_case_are_those_of_bodies_surroundings_and_stages():
    case = load_case("demos/stages.toml")
    assert temperature_range(case) == (25.0, 650.0)
    hotter = load_case("demos/stages.toml", ["stages.1.spray.ambient=[[0, 20], [5, 900]]"])
    assert temperature_range(hotter) == (20.0, 900.0)


def test_all_conditions_of_a_surface_are_told():
    """In whichever order the case has them."""
    given = [
        {"on": "casting/top", "heat": {"type": "convection", "coefficient": 9, "ambient": 20}},
        {"on": "casting/top", "displacement": {"normal": 0.0}},
    ]
    bodies = [SimpleNamespace(name="casting", surfaces={"top": 3e-4}, unnamed=0.0)]
    for order in (given, given[::-1]):
        case = SimpleNamespace(
            boundaries=[Boundary.read(each) for each in order],
            bodies=[SimpleNamespace(name="casting")],
        )
        (told,) = surface_table(case, SimpleNamespace(bodies=bodies)).columns[2].cells
        assert "convection" in told and "displacement normal" in told


def test_clamps_are_told_with_the_pressure_they_mean():
    def told(**clamp):
        boundary = Boundary.read({"on": "die/back", "pressure": 1e5, "clamp": clamp})
        return conditions_text(boundary, 0.02)

    both = told(force="200 kN", stiffness="1 MN/mm")
    assert both == "pressure, clamp 2e+05 N (10 MPa), 1e+09 N/m"
    assert told(stiffness=5.0) == "pressure, clamp 5 N/m"
    assert told(stiffness=5.0, direction="all") == "pressure, clamp in all directions 5 N/m"
    ramp = told(force=[[0, 0], [1, 4e4], [2, 1e4]], direction="z")
    assert ramp == "pressure, clamp along z at most 4e+04 N (2 MPa)"


@pytest.mark.parametrize(
    ("heat", "text"),
    [
        (None, "none"),
        ({"law": "constant", "closed": 100}, "constant"),
        ({"law": "none", "radiation": {"emissivities": [0.3, 0.8]}}, "none and radiation"),
        ({"law": "constant", "closed": 100, "patches": [{"on": "a", "closed": 1}] * 2},
         "constant, other on 2 of its parts"),
    ],
)  # fmt: skip
def test_heat_is_told_in_words(heat, text):
    assert heat_text(None if heat is None else InterfaceHeat.read(heat)) == text


def test_bodies_that_touch_without_an_interface_are_named():
    case = load_case("demos/stages.toml")
    sizes, pairs = {"nodes": 9, "area": 0.0251327}, {"casting/core": 12}
    known = SimpleNamespace(bodies=("core", "casting"), **sizes)
    assert interface_text(case, known, pairs) == (
        "interface casting/core: 12 pairs, 251.3 cm², contact condensed, heat limited"
    )
    unknown = SimpleNamespace(bodies=("core", "die"), **sizes)
    assert "no interface between core and die (9 nodes," in interface_text(case, unknown, pairs)


@pytest.mark.parametrize("width, short", [(80, {"mould"}), (64, set())])
def test_no_word_of_the_table_of_bodies_is_cut(width, short):
    case = load_case("demos/cylinder.toml", ["bodies.1.material=sand-silica"])
    sizes = [BodySummary(body.name, 1495, 495, 1e-4, {}, 0.0, {}) for body in case.bodies]
    summary = MeshSummary((0.0, 0.0), (1.0, 1.0), tuple(sizes), ())
    console = Console(width=width, record=True)
    console.print(body_table(case, summary, ["mixed", "mixed"]))
    words = console.export_text().split()
    assert {"sand-silica", "elasto-", "viscoplastic", "1495", "100"} | short <= set(words)


def test_faces_that_no_body_shares_are_those_not_named_like_one():
    case = load_case("demos/cylinder.toml")
    surfaces = {"top": 3e-4, "mould": 5e-4, "symmetry-x": 7e-4}
    bodies = [BodySummary(b.name, 1, 1, 1.0, surfaces, 1e-4, {}) for b in case.bodies]
    found = free_areas(case, MeshSummary((0.0, 0.0), (1.0, 1.0), tuple(bodies), ()))
    assert found == pytest.approx({"casting": 4e-4, "mould": 4e-4})


@pytest.mark.ranks
def test_check_warns_of_iron_that_rigid_walls_hold_on_all_sides(comm, case_file, said):
    iron = ["bodies.0.material=GJL-250", "bodies.0.temperature=1300", "bodies.1.law=rigid"]
    given = ["check", str(case_file), *(part for over in iron for part in ("--set", over))]
    assert execute(given, comm) == 0
    assert "swells as it freezes" not in said()  # its top is free


def test_sizes_and_surfaces_are_told_for_each_model():
    assert "full turn" in size_text("axisymmetric") and "meshed part" in size_text("3d")
    assert "metre of depth" in size_text("plane-strain")
    assert free_text("top") == "insulated, free" and "symmetry" in free_text("symmetry-x")
    assert corner_text((0.0, 0.05)) == "(0, 0.05)"


@pytest.mark.ranks
def test_cells_in_the_skin_and_coherency_are_told(comm, case_file, said):
    alloy = ["--set", "bodies.0.material=AlSi7Mg"]
    assert execute(["check", str(case_file), *alloy], comm) == 0
    text = said()
    assert "interface casting/mould: cells of 5 mm in the skin of casting" in text
    assert 'interface_size = "0.67 mm" would reduce this to' in text
    assert "casting: the mush of AlSi7Mg bears from a solid fraction (coherency) of 0.9" in text
    assert f"castx run {case_file} --sensitivity coherency" in text
    assert "too early" not in text  # steel takes the heat fast enough
    sand = ["--set", "bodies.1.material=sand-silica", "--set", "geometry.size=30 mm"]
    assert execute(["check", str(case_file), *alloy, *sand], comm) == 0
    assert "cells of 10 mm in mould, which takes up the heat of freezing" in said()
    finer = ["--set", "geometry.interface_size=auto"]
    assert execute(["check", str(case_file), *finer], comm) == 0
    text = said()
    assert "cells of 0.6" in text and "fine enough" in text and "coherency" not in text
