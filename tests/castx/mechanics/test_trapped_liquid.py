"""Trapped liquid of one body: its pressures, when pores open and close, what it leaves alone."""

from __future__ import annotations

import logging
from functools import partial

from mpi4py import MPI

import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.domain.mesh import BodyMesh, build_mesh
from castx.mechanics.trapped_liquid import FULL_SHARE, POROUS_SHARE, NoPockets, Pockets
from tests.castx.mechanics.lone_bodies import MELTING, alone, begin, inside, move

RADIUS, HEIGHT, SIZE = 0.03, 0.06, 0.004
WEIGHT = -2700 * 9.81


@pytest.fixture(scope="module")
def casting() -> BodyMesh:
    sizes = {"radius": RADIUS, "height": HEIGHT, "wall": 0.01, "size": SIZE}
    description = {"model": "axisymmetric", "generator": "cylinder_in_mould", **sizes}
    geometry = Geometry.model_validate(description)
    return build_mesh(geometry, ["casting", "mould"], MPI.COMM_WORLD).bodies["casting"]


def update(pockets: Pockets, liquid: np.ndarray, shrunk: float = 0.0) -> np.ndarray:
    """Begin a step in which all cells have shrunk by so much; return which cells are trapped."""
    pockets.update(liquid, np.full(len(liquid), shrunk), np.zeros(len(liquid)))
    return pockets.content.pocket >= 0


def core_of(casting: BodyMesh) -> np.ndarray:
    r, z = casting.points[casting.nodes.dofmap.list].mean(axis=1).T
    return (r < RADIUS / 2) & (np.abs(z - HEIGHT / 2) < HEIGHT / 4)


def test_the_pressure_of_a_pocket_begins_where_it_closed(casting) -> None:
    """That of its nodes then, as long as it is a pocket."""
    r, z = casting.points[casting.nodes.dofmap.list].mean(axis=1).T
    core = core_of(casting)
    column = core | ((r < RADIUS / 2) & (z > HEIGHT / 2))
    pockets = Pockets(casting, "axisymmetric", ["mould", "base"])
    nodes, cells = len(casting.points), len(r)
    assert not update(pockets, column).any()
    pockets.commit(partial(np.full, nodes, -5e4), np.full(cells, -5e4), np.zeros(cells))
    for pressure in (7e6, 9e6):
        assert np.array_equal(update(pockets, core), core)
        found = pockets.reference_pressures()
        assert np.allclose(found, np.where(core, -5e4, 0.0), rtol=1e-14)
        pockets.commit(partial(np.full, nodes, pressure), np.full(cells, pressure), np.zeros(cells))
        assert pockets.mean_pressure == pytest.approx(pressure, rel=1e-12)


def test_a_pocket_that_is_closed_from_the_start_carries_its_weight(casting) -> None:
    """Liquid that fills a closed box is at rest, with the pressure of its depth."""
    everywhere = np.ones(len(casting.nodes.dofmap.list), dtype=bool)
    shut = ["mould", "base", "top"]
    pockets = Pockets(casting, "axisymmetric", shut, WEIGHT * casting.points[:, 1])
    assert update(pockets, everywhere).all()
    depth = HEIGHT - casting.points[casting.nodes.dofmap.list].mean(axis=1)[:, 1]
    assert np.allclose(pockets.reference_pressures(), WEIGHT * depth, rtol=1e-12, atol=1e-9)
    weightless = Pockets(casting, "axisymmetric", shut)
    assert update(weightless, everywhere).all() and not weightless.reference_pressures().any()


def shut_slab(comm, properties, cells="simplices", **more):
    """Return a slab that is closed all around and carries its weight."""
    around = ("wall", "far", "bottom", "top")
    formulation = {"formulation": "q1p0"} if cells != "simplices" else {}
    return alone(
        comm, cells=cells, properties=properties, closed=around, body_force=(0.0, -26.5e3),
        **formulation, **more,
    )  # fmt: skip


def test_trapped_liquid_balances_its_weight_without_moving(comm):
    """Full, its pressure is an unknown; its volume hardly depends on it."""
    part = shut_slab(comm, MELTING, starts_liquid=True)
    begin(part, 640.0, 0.0)
    solid = part.material.conditions.solid_compressibility
    np.testing.assert_allclose(part.material.compressibility.x.array, FULL_SHARE * solid)
    depth = 0.01 - part.mesh.points[:, 1]
    values = part.solution.x.array.reshape(-1, part.block_size)
    values[:, 2] = -26.5e3 * depth / part.unknowns.pressure_scale
    residual = part.residual().reshape(-1, part.block_size)
    force = 26.5e3 * 0.01 * 0.005
    assert np.abs(residual[:, :2] * inside(part)[:, None]).max(initial=0.0) < 1e-10 * force
    assert np.abs(residual[:, 2]).max(initial=0.0) < 1e-10 * force
    assert not part.improve_pressures()  # it is at the verge of pores, and stays full


@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_a_pocket_that_is_drawn_apart_opens_and_one_pressed_together_closes(comm, cells, caplog):
    """Its pores open at the cavity pressure, which then acts however far it is drawn apart."""
    part = shut_slab(comm, {**MELTING, "cavitation": 2e5}, cells, starts_liquid=True)
    begin(part, 640.0, 0.0)
    top = 0.01
    stretched = 1e-3 * np.diag([1.0, 1.0, 0.0])
    for pressure in (1.9e5, 2.2e5):
        move(part, stretched if pressure > 2e5 else 0 * stretched, pressure)
        part.residual()
        assert not part.improve_pressures(settled=False)  # the shell may be far from balance
        changed = part.improve_pressures()
    assert changed
    part.residual()
    found = part.stress()[:, :3].mean(axis=1)
    depth = top - part.mesh.points[part.cell_nodes].mean(axis=1)[:, 1]
    if cells == "simplices":  # the nodal pressure is free, the one that acts is given
        found = part.formulation._pockets.cell_pressures()
        share = POROUS_SHARE * part.material.conditions.solid_compressibility
        np.testing.assert_allclose(part.material.compressibility.x.array, share)
    np.testing.assert_allclose(found, 2e5 - 26.5e3 * depth, rtol=1e-12)
    with caplog.at_level(logging.INFO, logger="castx"):
        part.commit()
    volume = 0.02 * 0.01
    totals = part.liquid_totals()
    assert totals["unfed_volume"] == pytest.approx(2e-3 * volume, rel=1e-9)
    assert totals["pocket_pressure"] == pytest.approx(2e5 - 26.5e3 * 0.005, rel=1e-9)
    assert "cannot be fed" in caplog.text and "pores open" in caplog.text
    begin(part, 640.0, 0.0)
    move(part, 0.1 * stretched, 2e5)
    part.residual()
    assert not part.improve_pressures() or cells != "simplices"
    assert part.liquid_totals()["unfed_volume"] == pytest.approx(2e-3 * volume, rel=1e-9)
    move(part, -0.1 * stretched, 2e5)
    part.residual()
    assert part.improve_pressures()
    caplog.clear()
    with caplog.at_level(logging.INFO, logger="castx"):
        part.commit()
    assert "pores have closed" in caplog.text
    assert part.liquid_totals()["unfed_volume"] == 0.0


@pytest.mark.parametrize("stabilisation", ["osgs", "gls"])
def test_the_pressure_given_in_porous_liquid_leaves_the_others_alone(comm, stabilisation):
    """Whatever the nodes there have for a pressure, it hardly enters the equations of a shell."""
    part = shut_slab(comm, MELTING, starts_liquid=True, stabilisation=stabilisation)
    begin(part, 640.0, 0.0)
    move(part, 1e-3 * np.diag([1.0, 1.0, 0.0]), 1e6)
    part.residual()
    assert part.improve_pressures()
    bend = 1e6 * (part.mesh.points[:, 0] / 0.02) ** 2
    values = part.solution.x.array.reshape(-1, part.block_size)
    values[:, 2] = bend / part.unknowns.pressure_scale
    rows = part.residual().reshape(-1, part.block_size)[:, 2] / part.unknowns.pressure_scale
    stiffness = part.material.conditions.solid_compressibility.max()
    everywhere = 0.02 * 0.01 * stiffness * 1e6  # what a solid's pressure enters them by
    assert 0.0 < np.abs(rows).sum() < 1e-5 * everywhere


@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
def test_a_step_taken_back_leaves_trapped_liquid_as_stiff_as_it_was(comm, cells):
    part = shut_slab(comm, MELTING, cells, starts_liquid=True)
    begin(part, 640.0, 0.0)
    move(part, np.zeros((3, 3)))
    part.residual()
    part.commit()
    accepted = part.material.compressibility.x.array.copy()
    begin(part, 500.0, 1.0)
    assert np.all(part.material.compressibility.x.array > 10 * accepted)
    part.rewind()
    np.testing.assert_array_equal(part.material.compressibility.x.array, accepted)


def test_the_state_of_pockets_comes_back(casting) -> None:
    core, cells = core_of(casting), len(casting.nodes.dofmap.list)
    nodes = len(casting.points)
    one, other = (Pockets(casting, "axisymmetric", ["mould", "base"]) for _ in range(2))
    for pockets in (one, other):
        update(pockets, core)
    one.commit(partial(np.full, nodes, 3e5), np.full(cells, 3e5), np.zeros(cells))
    for name, part in one.stateful_parts().items():
        saved = {key: each.values for key, each in part.saved().items()}
        other.stateful_parts()[name].restore(saved)
    for pockets in (one, other):
        update(pockets, core)
    np.testing.assert_array_equal(one.reference_pressures(), other.reference_pressures())
    assert other.mean_pressure == one.mean_pressure == pytest.approx(3e5)
    assert one.totals() == other.totals()


def test_a_body_that_never_is_a_liquid_traps_nothing(comm) -> None:
    part = shut_slab(comm, {})
    begin(part, 640.0, 0.0)
    assert part.liquid_totals() is None
    assert list(part.stateful_parts()) == ["points"]
    before = part.material.compressibility.x.array.copy()
    stands_for = NoPockets(len(part.cell_nodes))
    stands_for.begin(part.material, np.ones(len(part.mesh.parent_vertices)))
    np.testing.assert_array_equal(part.material.compressibility.x.array, before)
    assert np.isnan(stands_for.cell_pressures()).all()
    assert not stands_for.reference_pressures().any()
    assert not stands_for.turn(part.material, np.full(len(part.cell_nodes), 1e9))
