"""Nodes that face facets of a mesh that does not match: geometry, refusals, and the patch test."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import gmsh
import numpy as np
import pytest

from castx.case.contact import Pairing
from castx.contact.choice import Contact
from castx.errors import MeshError
from tests.castx.domain.interface_meshes import pairs_by
from tests.contact_methods import AT_ONCE, EXACT, sharp
from tests.coupled_cases import final_state, simulation
from tests.elastic_bodies import (
    blocks,
    body,
    drawn,
    elastic,
    everywhere,
    fixed,
    generated,
    motion,
    normal_forces,
    places,
    pressures,
    problem,
    pushed,
)
from tests.partitions import PARTITION, on_the_last

SURFACES = ("under", "over")
FACES = Pairing(kind="node-to-face", surfaces=SURFACES)
WIDTH, HEIGHT, PRESSURE = 0.02, 0.01, 25e6
YOUNG, POISSON = {"upper": 70e9, "base": 7e9}, 0.33


def draw_blocks(cells: dict[str, int], gap: float = 0.0, base_width: float = WIDTH) -> None:
    """Draw an upper block and a base with different numbers of cells along x."""
    geo, lines = gmsh.model.geo, {}
    for name, low, high, width in (
        ("upper", gap, gap + HEIGHT, WIDTH), ("base", -HEIGHT, 0.0, base_width)
    ):
        p = [geo.addPoint(x, y, 0.0) for x, y in ((0, low), (width, low), (width, high), (0, high))]
        sides = [geo.addLine(p[k], p[(k + 1) % 4]) for k in range(4)]
        surface = geo.addPlaneSurface([geo.addCurveLoop(sides)])
        for k in (0, 2):
            geo.mesh.setTransfiniteCurve(sides[k], cells[name] + 1)
        for k in (1, 3):
            geo.mesh.setTransfiniteCurve(sides[k], 4)
        geo.mesh.setTransfiniteSurface(surface)
        lines[name] = (sides, surface)
    geo.synchronize()
    names = {"upper": ("under", "right", "top", "symmetry-x"),
             "base": ("bottom", "side", "over", "symmetry-x")}  # fmt: skip
    left = []
    for name, (sides, surface) in lines.items():
        gmsh.model.addPhysicalGroup(2, [surface], name=name)
        for k, label in enumerate(names[name]):
            if label == "symmetry-x":
                left.append(sides[k])
            else:
                gmsh.model.addPhysicalGroup(1, [sides[k]], name=label)
    gmsh.model.addPhysicalGroup(1, left, name="symmetry-x")
    gmsh.model.mesh.generate(2)


def separate(comm, folder: Path, upper: int, base: int, **geometry):
    cells = {"upper": upper, "base": base}
    return drawn(
        comm, "plane-strain", ["upper", "base"], folder / f"blocks_{upper}_{base}.msh",
        lambda: draw_blocks(cells, **geometry),
    )  # fmt: skip


def squeezed(comm, mesh, method, pairing=FACES, **contact):
    bodies = {
        "upper": body(elastic(YOUNG["upper"], POISSON), loads=(pushed("top", PRESSURE),)),
        "base": body(elastic(YOUNG["base"], POISSON)),
    }
    contact = Contact("upper", "base", method, pairing=pairing, **contact)
    made = problem(mesh, bodies, {"base": [fixed("bottom")]}, [contact])
    made.equilibrium.solve(0.0)
    return made


def test_weights_gap_and_areas(comm, shared_tmp_path):
    mesh = separate(comm, shared_tmp_path, 7, 4, gap=1e-3)
    pairs = pairs_by(FACES, mesh, "upper", "base")
    assert comm.allreduce(len(pairs.areas)) == 8
    assert comm.allreduce(pairs.areas.sum()) == pytest.approx(WIDTH)
    np.testing.assert_allclose(pairs.gap, 1e-3, rtol=1e-12)
    np.testing.assert_allclose(pairs.normals, np.tile([0.0, 1.0], (len(pairs.gap), 1)), atol=1e-15)
    owned = mesh.bodies["base"].nodes.dofmap.index_map.size_local
    base = everywhere(comm, mesh.bodies["base"].points[:owned])
    nodes, weights = pairs.partners
    reached = np.einsum("na,nak->nk", weights, base[nodes])
    np.testing.assert_allclose(reached[:, 0], pairs.points[:, 0], atol=1e-15)
    np.testing.assert_allclose(reached[:, 1], 0.0, atol=1e-15)
    np.testing.assert_array_equal(pairs.primary_nodes, nodes[np.arange(len(nodes)),
                                                              weights.argmax(axis=1)])


@pytest.mark.ranks
def test_nodes_beside_the_other_surface_face_nothing(comm, shared_tmp_path):
    mesh = separate(comm, shared_tmp_path, 8, 6, base_width=0.6 * WIDTH)
    pairs = pairs_by(FACES, mesh, "upper", "base")
    assert everywhere(comm, pairs.points[:, 0]).max() < 0.6 * WIDTH + 1e-12
    assert comm.allreduce(len(pairs.areas)) == 5


@pytest.mark.ranks
def test_a_rank_without_nodes_that_face_leaves_them_to_others(comm, shared_tmp_path, monkeypatch):
    monkeypatch.setattr(PARTITION, on_the_last)
    mesh = separate(comm, shared_tmp_path, 7, 4)
    pairs = pairs_by(FACES, mesh, "upper", "base")
    assert comm.allgather(len(pairs.areas)) == [0] * (comm.size - 1) + [8]


@pytest.mark.parametrize("method", AT_ONCE)
def test_matching_meshes_pass_the_patch_test(comm, method):
    """Each node faces a corner: the same as node to node."""
    rule = Pairing(kind="node-to-face")
    made = squeezed(comm, blocks(comm, upper=(0.02, 0.01), base=(0.02, 0.01)), method, rule)
    np.testing.assert_allclose(pressures(comm, made), PRESSURE, rtol=1e-8)


@pytest.mark.parametrize("method", sharp(AT_ONCE))
def test_a_straight_finer_surface_passes_the_resultant_but_not_the_patch_test(
    comm, shared_tmp_path, method
):
    """Nodes pass their forces to facets by weights that are not those of a uniform pressure.

    The resultant is exact; the pressure and the sinking of the base are uniform to some per cent
    only, and do not improve with the mesh: that takes matching meshes, or a mortar method.
    """
    mesh = separate(comm, shared_tmp_path, 12, 8)
    made = squeezed(comm, mesh, method)
    forces = everywhere(comm, made.contact_states()[0].force)
    assert forces[:, 1].sum() == pytest.approx(PRESSURE * WIDTH, rel=1e-9)
    found = pressures(comm, made)
    worst = np.abs(found / PRESSURE - 1).max()
    assert 0.1 < worst < 0.25
    exact = -PRESSURE * HEIGHT * (1 - POISSON**2) / YOUNG["base"]
    top = np.abs(places(made, "base")[:, 1]) < 1e-9
    moved = everywhere(comm, motion(made, "base")[top, 1])
    np.testing.assert_allclose(moved, exact, rtol=0.01)
    assert moved.mean() == pytest.approx(exact, rel=2e-3)


@pytest.mark.parametrize("method", AT_ONCE)
def test_evenly_divided_facets_pass_the_patch_test(comm, shared_tmp_path, method):
    made = squeezed(comm, separate(comm, shared_tmp_path, 12, 6), method)
    np.testing.assert_allclose(pressures(comm, made), PRESSURE, rtol=1e-8)


@pytest.mark.ranks
def test_an_ignored_gap_of_the_meshes_is_none(comm, shared_tmp_path):
    mesh = separate(comm, shared_tmp_path, 7, 4, gap=1e-3)
    pairs = pairs_by(replace(FACES, meshed_gap=False), mesh, "upper", "base")
    assert np.all(pairs.gap == 0.0)


@pytest.mark.ranks
def test_methods_agree(comm, shared_tmp_path):
    mesh = separate(comm, shared_tmp_path, 12, 8)
    condensed, multipliers = (squeezed(comm, mesh, method) for method in EXACT)
    p = pressures(comm, condensed)
    np.testing.assert_allclose(pressures(comm, multipliers), p, atol=1e-9 * p.max())


@pytest.mark.parametrize("linear", ["direct", "iterative"])
@pytest.mark.parametrize("method", sharp(AT_ONCE))
def test_a_meshed_gap_closes_under_load(comm, shared_tmp_path, method, linear):
    mesh = separate(comm, shared_tmp_path, 6, 4, gap=1e-5)
    bodies = {n: body(elastic(E, POISSON)) for n, E in YOUNG.items()}
    held = {"base": [fixed("bottom")], "upper": [fixed("top", value=-3e-5)]}
    contact = Contact(
        "upper", "base", method, lambda x: np.full(len(x), 5e-6), pairing=FACES,
        settings={"penalty": 1e16} if method == "penalty" else {},
    )  # fmt: skip
    made = problem(mesh, bodies, held, [contact], linear=linear, tolerance=1e-9)
    made.equilibrium.solve(0.0)
    compliance = (1 - POISSON**2) * sum(HEIGHT / E for E in YOUNG.values())
    total = comm.allreduce(normal_forces(made).sum())
    assert total == pytest.approx(1.5e-5 / compliance * WIDTH, rel=0.01)


def curved(comm, normals):
    """Return the pairs of a ring on a core whose meshes match, by its facets."""
    mesh = generated(
        comm, "plane-strain", "core_in_ring", ["core", "casting"],
        core_radius=0.03, outer_radius=0.05, size=0.008,
    )  # fmt: skip
    return pairs_by(Pairing(normals, kind="node-to-face"), mesh, "casting", "core")


def test_normals_of_the_facets_or_of_both_sides(comm):
    """At nodes the mean of the facets round them is the radius on both sides."""
    for normals in ("primary", "averaged"):
        pairs = curved(comm, normals)
        radial = pairs.points / np.linalg.norm(pairs.points, axis=1, keepdims=True)
        inside = np.all(pairs.points > 1e-9, axis=1)
        np.testing.assert_allclose(pairs.normals[inside], radial[inside], atol=1e-3)


def test_the_choice_of_normals_acts_where_a_node_faces_the_inside_of_a_facet(comm, shared_tmp_path):
    def draw():
        geo, arcs = gmsh.model.geo, []
        centre = geo.addPoint(0, 0, 0)
        for name, inner, outer, cells in (("ring", 0.03, 0.04, 7), ("core", 0.02, 0.03, 4)):
            a = [geo.addPoint(r, 0, 0) for r in (inner, outer)]
            b = [geo.addPoint(0, r, 0) for r in (inner, outer)]
            low = geo.addLine(a[0], a[1])
            out = geo.addCircleArc(a[1], centre, b[1])
            left = geo.addLine(b[1], b[0])
            back = geo.addCircleArc(b[0], centre, a[0])
            surface = geo.addPlaneSurface([geo.addCurveLoop([low, out, left, back])])
            for arc in (out, back):
                geo.mesh.setTransfiniteCurve(arc, cells + 1)
            arcs.append((name, surface, back if name == "ring" else out))
        geo.synchronize()
        for name, surface, arc in arcs:
            gmsh.model.addPhysicalGroup(2, [surface], name=name)
            gmsh.model.addPhysicalGroup(1, [arc], name="hole" if name == "ring" else "skin")
        gmsh.model.mesh.setSize(gmsh.model.getEntities(0), 0.005)
        gmsh.model.mesh.generate(2)

    mesh = drawn(comm, "plane-strain", ["ring", "core"], shared_tmp_path / "arcs.msh", draw)
    rules = {n: replace(FACES, normals=n, surfaces=("hole", "skin"))
             for n in ("primary", "averaged")}  # fmt: skip
    pairs = {n: pairs_by(rule, mesh, "ring", "core") for n, rule in rules.items()}
    difference = everywhere(comm, pairs["primary"].normals - pairs["averaged"].normals)
    assert np.abs(difference).max() > 0.02
    for found in pairs.values():
        np.testing.assert_allclose(np.linalg.norm(found.normals, axis=1), 1.0)


def test_refusals(comm, shared_tmp_path):
    mesh = separate(comm, shared_tmp_path, 4, 4)
    with pytest.raises(MeshError, match="'upper' and 'base' share no surface: name those"):
        pairs_by(Pairing(kind="node-to-face"), mesh, "upper", "base")
    with pytest.raises(MeshError, match="body 'base' has no surface 'ovr'"):
        pairs_by(replace(FACES, surfaces=("under", "ovr")), mesh, "upper", "base")
    with pytest.raises(MeshError, match="no node of upper/top faces base/over"):
        pairs_by(replace(FACES, surfaces=("top", "over")), mesh, "upper", "base")


def case(folder: Path, **interface):
    return {
        "geometry": {"file": folder / "blocks_6_4.msh", "model": "plane-strain"},
        "materials": {"metal": {"young_modulus": 70e9, "poisson_ratio": 0.33, "stress_free": 20.0,
                                "density": 1.0, "heat_capacity": 1.0, "conductivity": 1.0,
                                "expansion": 0.0}},
        "bodies": [{"name": name, "material": "metal", "temperature": 20.0}
                   for name in ("upper", "base")],
        "interfaces": [{
            "bodies": ["upper", "base"],
            "contact": {"pairing": "node-to-face", "surfaces": list(SURFACES)}, **interface,
        }],
        "boundaries": [
            {"on": "base/bottom", "displacement": {"normal": 0.0}},
            {"on": "upper/top", "pressure": PRESSURE},
        ],
        "coupling": {"scheme": "mechanical"},
        "time": {"end": 1.0, "fixed_step": 1.0},
    }  # fmt: skip


@pytest.mark.ranks
def test_the_keys_of_a_case(comm, shared_tmp_path):
    separate(comm, shared_tmp_path, 6, 4)
    state = final_state(comm, case(shared_tmp_path))
    assert state.totals["upper/base.force.y"] == pytest.approx(PRESSURE * WIDTH, rel=1e-6)


def test_the_search_distance_of_a_case_acts(comm, shared_tmp_path):
    """A block at 1 mm faces the base by default, and not within half of that."""
    separate(comm, shared_tmp_path, 6, 4, gap=1e-3)
    data = case(shared_tmp_path)
    contact = data["interfaces"][0]["contact"]
    assert len(simulation(comm, data).pairs) == 1
    contact["search_distance"] = "0.5 mm"
    with pytest.raises(MeshError, match=r"contact.search_distance \(0.0005 m\)"):
        simulation(comm, data)


def test_the_log_names_the_areas_of_both_sides(comm, shared_tmp_path, caplog):
    separate(comm, shared_tmp_path, 6, 4)
    with caplog.at_level("INFO", logger="castx"):
        simulation(comm, case(shared_tmp_path)).destroy()
    assert "interface upper/base: 200 cm² of upper face 200 cm² of base" in caplog.text
    assert "areas of both sides differ" not in caplog.text
