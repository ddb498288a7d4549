"""From a case to conditions, interfaces and their parts, temperatures and accounts."""

from __future__ import annotations

from pathlib import Path

from mpi4py import MPI

import gmsh
import numpy as np
import pytest

from castx.case.case import Case
from castx.case.geometry import Geometry
from castx.case.initial_temperature import read_initial_temperature
from castx.case.interfaces import Interface
from castx.case.reading.read import read_case
from castx.domain.mesh import build_mesh
from castx.domain.pairs.node_pairs import node_pairs
from castx.domain.source import gmsh_session
from castx.errors import CaseError
from castx.heat.building import (
    heat_exchange,
    heat_tolerance,
    initial_temperatures,
    run_accounts,
    surface_heats,
)
from castx.heat.problem import HeatProblem
from castx.transfer.conductance import Faces
from castx.transfer.keys import RADIATION
from castx.transfer.pair_state import PairState
from castx.transfer.registry import gap_heat_laws
from tests.castx import case_data
from tests.castx.heat.heat_cases import (
    SURROUNDINGS,
    advanced,
    cylinder,
    open_pairs,
    parts_under_law,
)

HEAT = {"law": "constant", "closed": 1000.0, "radiation": {"emissivities": [0.5, 0.5]}}


@pytest.fixture
def mesh(comm, shared_tmp_path):
    """Return two squares that touch at x = 0, above y = 0.5 by a curve with the name "coated"."""
    if comm.rank == 0:
        with gmsh_session():
            add = gmsh.model.geo
            points = [
                add.addPoint(x, y, 0.0, 0.1)
                for x, y in ((-1, 0), (0, 0), (1, 0), (1, 1), (0, 1), (-1, 1), (0, 0.5))
            ]
            ends = ((0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 0), (1, 6), (6, 4))
            lines = [add.addLine(points[a], points[b]) for a, b in ends]
            loops = ((1, 7, 8, 5, 6), (2, 3, 4, -8, -7))
            for name, loop in zip(("mould", "casting"), loops, strict=True):
                curves = [int(np.sign(k)) * lines[abs(k) - 1] for k in loop]
                face = add.addPlaneSurface([add.addCurveLoop(curves)])
                add.addPhysicalGroup(2, [face], name=name)
            add.addPhysicalGroup(1, [lines[7]], name="coated")
            add.addPhysicalGroup(1, [lines[2]], name="far")
            add.synchronize()
            gmsh.model.mesh.generate(2)
            gmsh.write(str(shared_tmp_path / "squares.msh"))
    comm.Barrier()
    geometry = Geometry.model_validate({"file": "squares.msh", "model": "plane-strain"})
    geometry = geometry.model_copy(update={"file": shared_tmp_path / "squares.msh"})
    return build_mesh(geometry, ["casting", "mould"], comm)  # fmt: skip


@pytest.mark.ranks
@pytest.mark.parametrize(
    ("description", "expected"),
    [
        ({"formula": "600 + 50*x*y"}, lambda x, y: 600.0 + 50.0 * x * y),
        (
            {"along": ["x", "y"], "table": [[-1, 0, 500], [1, 0, 600], [-1, 1, 520], [1, 1, 660]]},
            lambda x, y: 550.0 + 50.0 * x + y * (40.0 + 20.0 * x),
        ),
    ],
)
def test_a_temperature_that_varies_in_space_is_that_of_each_owned_node(
    description, expected, mesh, comm
):
    """By a formula or a table of two coordinates, on any number of ranks."""
    for name in ("casting", "mould"):
        body = mesh.bodies[name]
        found = initial_temperatures(read_initial_temperature(description), body, comm)
        points = body.points[: body.nodes.dofmap.index_map.size_local]
        np.testing.assert_allclose(found, expected(points[:, 0], points[:, 1]), rtol=1e-13)
        assert comm.allreduce(len(found)) == body.nodes.dofmap.index_map.size_global


@pytest.mark.ranks
def test_a_formula_without_a_temperature_somewhere_is_refused_by_all_ranks(mesh, comm):
    """One corner of the casting is below absolute zero: one rank has it, all raise."""
    corner = "600 - 900*max(0, 1 - 20*sqrt((x - 1)**2 + (y - 1)**2))"
    below = read_initial_temperature({"formula": corner})
    with pytest.raises(CaseError, match=r"temperature of 'casting': .* at 1 nodes"):
        initial_temperatures(below, mesh.bodies["casting"], comm)


def exchange(mesh, *patches):
    heat = {**HEAT, "patches": list(patches)} if patches else HEAT
    interface = Interface.read({"bodies": ["casting", "mould"], "heat": heat})
    return heat_exchange(interface, node_pairs(mesh, "casting", "mould"), mesh)


def coefficients(mesh, found) -> tuple[np.ndarray, np.ndarray]:
    """Return the height and the coefficient of all pairs of this rank."""
    count = len(found.pairs.areas)
    faces = Faces.at_temperatures(np.full(count, 500.0), np.full(count, 100.0), 0.0, 0.0)
    state = PairState.of(np.zeros(count), np.zeros(count))
    return found.pairs.points[:, 1], found.law(state, faces).coefficient.value


@pytest.mark.ranks
def test_faces_between_bodies_keep_the_name_of_the_mesh(mesh):
    assert list(mesh.marked) == ["coated"]  # far is an outer surface
    assert mesh.marked["coated"][:, 1].min() == 0.5
    found = exchange(mesh, {"on": "coated", "closed": 200.0})
    y, h = coefficients(mesh, found)
    np.testing.assert_array_equal(h, np.where(y >= 0.5, 200.0, 1000.0))
    assert found.radiation == pytest.approx(1 / 3)


@pytest.mark.ranks
def test_name_and_bounds_together_and_the_first_patch_counts(mesh):
    bare = {"law": "constant", "closed": 50.0, "radiation": {"emissivities": [1, 1]}}
    found = exchange(
        mesh,
        {"on": "coated", "within": {"y": [0.0, 0.75]}, "closed": 200.0},
        {"within": {"y": [0.65, 1.0]}, **bare},
    )
    y, h = coefficients(mesh, found)
    named, above = (y >= 0.5) & (y <= 0.75), y > 0.75
    np.testing.assert_array_equal(h, np.where(named, 200.0, np.where(above, 50.0, 1000.0)))
    assert found.radiation == pytest.approx(np.where(above, 1.0, 1 / 3))


@pytest.mark.parametrize(
    "patch, text",
    [
        ({"on": "coatd"}, "on = 'coatd': no faces between bodies with this name; the mesh names"),
        ({"on": "far"}, "on = 'far': no faces between bodies"),
        ({"within": {"y": [2, 3]}}, r"heat.patches\[0\] adds no node"),
    ],
)
def test_refused(mesh, patch, text):
    with pytest.raises(CaseError, match=text):
        exchange(mesh, {**patch, "closed": 5.0})


@pytest.mark.ranks
@pytest.mark.parametrize("name", gap_heat_laws())
def test_a_run_under_every_law_keeps_the_heat_on_any_number_of_ranks(comm, name):
    """With the keys a law needs and radiation where it may have it; none and perfect too."""
    law = gap_heat_laws()[name]
    heat = law.example(also=[RADIATION] if RADIATION in law.useful else [])
    ends = []
    for ranks in (comm, MPI.COMM_SELF):
        mesh = cylinder(ranks, size=8e-3)
        pairs = node_pairs(mesh, "casting", "mould")
        interface = Interface.read({"bodies": ["casting", "mould"], "heat": heat})
        bodies, _ = parts_under_law(mesh, {"law": "none"})
        found = HeatProblem(mesh, bodies, [heat_exchange(interface, pairs, mesh)], SURROUNDINGS)
        states = open_pairs(mesh) if law.exchange != "perfect" else None
        advanced(found, mesh, [0.5, 2.0], states)
        ends.append(found.totals())
        found.destroy()
    assert ends[0]["energy_error"] < 1e-9
    assert ends[0]["casting/mould.heat"] > 0.0
    for key, value in ends[1].items():
        if key != "energy_error":
            assert ends[0][key] == pytest.approx(value, rel=1e-7, abs=1e-6), key


def described(heat) -> Case:
    """Return the case of a cylinder with heat conditions on the outside of its mould."""
    data = case_data.cylinder()
    data["boundaries"][0]["heat"] = heat
    return read_case(data, Path("case.toml"))


@pytest.mark.serial
def test_conditions_of_a_case_and_surfaces_with_the_name_of_a_body():
    radiating = {"type": "radiation", "emissivity": 0.5, "ambient": 20}
    cooled = {"type": "convection", "coefficient": 10, "ambient": 20}
    case = described([cooled, radiating])
    first, second = surface_heats(case, ["casting", "mould"])
    assert first.condition == case.boundaries[0].heat[0]
    assert (first.place, second.condition.type) == ("mould/outside", "radiation")
    towards = surface_heats(case, ["casting", "mould", "outside"])
    assert [surface.place for surface in towards] == ["mould/outside.surface"] * 2


@pytest.mark.serial
def test_accounts_of_a_run_are_those_of_its_stages_each_once():
    insulated, cooled = (
        described(heat) for heat in ({"type": "insulated"}, {"type": "flux", "value": -5.0})
    )
    accounts = run_accounts(insulated, [insulated, cooled, insulated])
    assert accounts.bodies == ("casting", "mould")
    assert len(set(accounts.entries)) == len(accounts.entries)
    names = {name for account in accounts.entries for name in account.energy}
    expected = {"casting.source", "mould.dissipation", "casting/mould.heat.gas"}
    assert expected | {"mould/outside.heat"} <= names
    alone = run_accounts(insulated, [insulated])
    assert len(alone.entries) == len(accounts.entries) - 1


CONVECTION = {"type": "convection", "coefficient": 10, "ambient": 20}
RADIATION_TO_AIR = {"type": "radiation", "emissivity": 0.5, "ambient": 20}


@pytest.mark.serial
@pytest.mark.parametrize(
    ("stages", "types"),
    [
        ([[CONVECTION, RADIATION_TO_AIR], CONVECTION], ["convection", "radiation"]),
        ([CONVECTION, {"type": "insulated"}, RADIATION_TO_AIR], ["convection", "radiation"]),
        ([CONVECTION, [CONVECTION, CONVECTION]], ["convection"]),
        ([CONVECTION, {"type": "insulated"}, CONVECTION], []),
    ],
)
def test_all_stages_book_by_type_what_one_of_them_or_the_run_has_of_several(stages, types):
    cases = [described(heat) for heat in stages]
    found = run_accounts(cases[0], cases)
    names = [account.energy for account in found.entries if account.to == "mould"]
    outside = sorted(each for each in names if each[0] == "mould/outside.heat")
    whole = "mould/outside.heat"
    assert outside == ([(whole, f"{whole}.{one}") for one in types] or [(whole,)])


@pytest.mark.ranks
def test_initial_temperatures_of_the_owned_nodes(comm):
    mesh = cylinder(comm, size=8e-3)
    along = {"along": "z", "table": [[0.0, 100.0], [0.06, 160.0]]}
    body = mesh.bodies["mould"]
    found = initial_temperatures(read_initial_temperature(along), body, comm)
    owned = body.nodes.dofmap.index_map.size_local
    assert found == pytest.approx(100.0 + 1000.0 * body.points[:owned, 1])
    missing = read_initial_temperature({"file": "nowhere.vtu", "field": "T"})
    with pytest.raises(CaseError, match="initial temperature of 'mould'"):
        initial_temperatures(missing, body, comm)


@pytest.mark.serial
@pytest.mark.parametrize(
    "coupling, given, expected",
    [
        ({}, {}, 1e-6),
        ({"tolerance": 1e-4}, {}, 1e-7),
        ({"tolerance": 1e-9}, {}, 1e-8),
        ({"tolerance": 0.1}, {}, 1e-6),
        ({"scheme": "thermal"}, {}, 1e-8),
        ({"scheme": "staggered"}, {}, 1e-8),
        ({}, {"heat_tolerance": 3e-5}, 3e-5),
    ],
)
def test_heat_is_balanced_as_finely_as_the_passes_need(coupling, given, expected):
    data = case_data.cylinder()
    data["coupling"], data["solver"] = coupling, given
    assert heat_tolerance(read_case(data, Path("case.toml"))) == pytest.approx(expected)
