"""Thin walls in words, and the table of their errors against cantilevers."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import gmsh
import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.coupling.thin_walls import thin_wall_records, thin_walls
from castx.domain.mesh import build_mesh
from castx.foundry.bending import bending_error
from castx.proof.verification.states import drawn_mesh, nodal, places, states

LENGTH, HEIGHT, POISSON, STRESS = 40.0, 2.0, 0.33, 1e-6


def draw(layers: int, kind: str) -> None:
    """Draw a beam of square cells, or cubes, and cut them."""
    geo = gmsh.model.geo
    corners = ((0, 0), (LENGTH, 0), (LENGTH, HEIGHT), (0, HEIGHT))
    points = [geo.addPoint(x, y, 0) for x, y in corners]
    edges = [geo.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
    beam = geo.addPlaneSurface([geo.addCurveLoop(edges)])
    along = round(LENGTH / HEIGHT) * layers
    for edge, count in zip(edges, (along, layers) * 2, strict=True):
        geo.mesh.setTransfiniteCurve(edge, count + 1)
    solid = kind in ("tetrahedron", "hexahedron")
    geo.mesh.setTransfiniteSurface(beam, "Left" if solid else "AlternateLeft")
    if kind in ("quadrilateral", "hexahedron"):
        geo.mesh.setRecombine(2, beam)
    ends = [edges[1], edges[3]]
    if solid:
        made = geo.extrude([(2, beam)], 0, 0, HEIGHT, [layers], recombine=kind == "hexahedron")
        beam, ends = made[1][1], [made[3][1], made[5][1]]
    geo.synchronize()
    dimension = 3 if solid else 2
    gmsh.model.addPhysicalGroup(dimension, [beam], name="beam")
    for end, name in zip(ends, ("tip", "foot"), strict=True):
        gmsh.model.addPhysicalGroup(dimension - 1, [end], name=name)
    gmsh.model.mesh.generate(dimension)


def beam_case(solid: bool, formulation: str) -> dict:
    elastic = {"young_modulus": 1.0, "poisson_ratio": POISSON, "expansion": 0.0}
    return {
        "geometry": {"file": "mesh.msh", "model": "3d" if solid else "plane-strain"},
        "materials": {"elastic": elastic},
        "bodies": [
            {"name": "beam", "material": "elastic", "temperature": 20.0, "formulation": formulation}
        ],
        "boundaries": [
            {"on": "beam/foot", "displacement": {"all": 0.0}},
            {"on": "beam/tip", "traction": [0.0, STRESS, 0.0] if solid else [0.0, STRESS]},
        ],
        "time": {"end": 1.0, "fixed_step": 1.0},
        "coupling": {"scheme": "mechanical"},
        "solver": {"linear": "direct"},
    }  # fmt: skip


def timoshenko(solid: bool) -> float:
    """Return the deflection of the tip, per width of the beam."""
    young = 1.0 if solid else 1.0 / (1.0 - POISSON**2)
    shear = 0.5 / (1.0 + POISSON)
    force, inertia = STRESS * HEIGHT, HEIGHT**3 / 12.0
    return force * LENGTH**3 / (3.0 * young * inertia) + force * LENGTH / (5 / 6 * shear * HEIGHT)


@pytest.mark.sampled
@pytest.mark.parametrize(
    "kind, formulation, layers",
    [
        ("triangle", "mixed", 2),
        ("tetrahedron", "mixed", 1),
        ("triangle", "mixed", 1),
        ("triangle", "displacement", 2),
        ("quadrilateral", "q1p0", 1),
        ("quadrilateral", "displacement", 2),
        ("tetrahedron", "displacement", 1),
        ("hexahedron", "q1p0", 1),
        ("hexahedron", "displacement", 2),
    ],
)
def test_the_table_says_how_far_a_cantilever_is_off(comm, kind, formulation, layers):
    solid = kind in ("tetrahedron", "hexahedron")
    with drawn_mesh(comm, partial(draw, layers, kind)) as folder:
        case = beam_case(solid, formulation)
        for state in states(comm, case, folder):
            tip = np.isclose(places(state, "beam")[:, 0], LENGTH)
            moved = nodal(state, "beam", "displacement")[tip, 1].mean()
        (walls,) = thin_walls(read_case(case, folder / "case.toml"), state.mesh)
    error = moved / timoshenko(solid) - 1.0
    assert bending_error(formulation, kind, layers) == pytest.approx(error, abs=0.02)
    assert walls.across == pytest.approx(layers, rel=1e-6)
    assert walls.error == pytest.approx(error, abs=0.02)


def slabs(formulation="mixed", **changes):
    """Return a case of two slabs, 2 and 20 mm high, with symmetry at the left."""
    return {
        "geometry": {
            "generator": "stacked_blocks", "model": "plane-strain",
            "upper": [0.06, 0.002], "base": [0.06, 0.02], "size": 1e-3,
        },
        "bodies": [
            {"name": name, "material": "steel-H13", "temperature": 20.0, "formulation": formulation}
            for name in ("upper", "base")
        ],
        "time": {"end": 1.0},
    } | changes  # fmt: skip


@pytest.mark.ranks
def test_walls_are_told_with_their_error_and_the_cure(comm):
    case = read_case(slabs(), Path("case.toml"))
    mesh = build_mesh(case.geometry, ["upper", "base"], comm)
    (found,) = thin_walls(case, mesh)
    assert found.body == "upper" and found.thinnest == pytest.approx(2e-3)
    assert found.size == pytest.approx(5e-4)
    assert "upper has walls of 2 mm with few cells across (of its surface 97 % with 2): tri" in (
        found.text
    )
    assert "triangles (mixed) bend there about 31 % too little" in found.text
    assert "cells of 0.5 mm there, 4 across, leave 10 %" in found.text
    assert thin_wall_records(case, mesh)["upper"]["error"] == found.error


@pytest.mark.serial
@pytest.mark.parametrize(
    "changes",
    [
        {"coupling": {"scheme": "thermal"}},
        {"boundaries": [{"on": "upper/top", "displacement": {"normal": 0.0}}]},
        {
            "interfaces": [
                {
                    "bodies": ["upper", "base"],
                    "contact": {"method": "tied"},
                    "heat": {"law": "perfect"},
                }
            ]
        },
    ],
    ids=["nothing moves", "held flat", "tied"],
)
def test_nothing_is_said_of_walls_that_cannot_bend(comm, changes):
    case = read_case(slabs(**changes), Path("case.toml"))
    mesh = build_mesh(case.geometry, ["upper", "base"], comm)
    assert list(thin_walls(case, mesh)) == []


@pytest.mark.serial
def test_nothing_is_said_of_sand(comm):
    data = slabs()
    data["bodies"][0] |= {"material": "sand-silica", "law": "drucker-prager"}
    del data["bodies"][0]["formulation"]
    case = read_case(data, Path("case.toml"))
    assert list(thin_walls(case, build_mesh(case.geometry, ["upper", "base"], comm))) == []


@pytest.mark.serial
def test_nothing_is_said_of_cells_that_bend_well(comm):
    geometry = slabs()["geometry"] | {"size": 5e-4}
    case = read_case(slabs(geometry=geometry), Path("case.toml"))
    assert list(thin_walls(case, build_mesh(case.geometry, ["upper", "base"], comm))) == []


def poured(formulation: str, **changes) -> dict:
    """Return the slabs with the upper one poured of an alloy."""
    case = slabs(**changes)
    upper, base = case["bodies"]
    alloy = {"material": "AlSi7Mg", "temperature": 650.0, "law": "thermo-elasto-viscoplastic"}
    case["bodies"] = [upper | alloy | {"formulation": formulation}, base]
    heat = {"law": "limited", "closed": 5000.0, "gas_conductivity": 0.05}
    return {"interfaces": [{"bodies": ["upper", "base"], "heat": heat}]} | case


@pytest.mark.serial
@pytest.mark.parametrize(
    ("formulation", "error", "freezing"),
    [("taylor-hood", None, (0.4, 0.2)), ("mixed", -0.31, (0.8, 0.5))],
)
def test_walls_that_freeze_are_told_what_freezing_leaves(comm, formulation, error, freezing):
    case = read_case(poured(formulation), Path("case.toml"))
    (found,) = thin_walls(case, build_mesh(case.geometry, ["upper", "base"], comm))
    assert found.freezing_error == pytest.approx(freezing, abs=0.01)
    assert found.error == (None if error is None else pytest.approx(error, abs=0.01))
    assert ("bend there" in found.text) == (error is not None)
    assert f"about {100 * freezing[0]:.0f} % of its root mean square off" in found.text


@pytest.mark.serial
def test_nothing_is_said_of_quadratic_cells_without_freezing(comm):
    case = read_case(slabs("taylor-hood"), Path("case.toml"))
    assert list(thin_walls(case, build_mesh(case.geometry, ["upper", "base"], comm))) == []


@pytest.mark.serial
def test_nothing_is_said_where_freezing_has_enough_cells(comm):
    fine = slabs()["geometry"] | {"size": 5e-4}
    case = read_case(poured("taylor-hood", geometry=fine), Path("case.toml"))
    assert list(thin_walls(case, build_mesh(case.geometry, ["upper", "base"], comm))) == []
