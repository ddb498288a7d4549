"""Trapped liquid of one body: its pressures, when pores open and close, what it leaves alone."""

from __future__ import annotations

import logging
from functools import partial
from types import SimpleNamespace
from typing import Any

from mpi4py import MPI

import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.domain.mesh import BodyMesh, build_mesh
from castx.mechanics.constitutive.growth import CellVolume
from castx.mechanics.constitutive.law import Law
from castx.mechanics.trapped_liquid import (
    FULL_SHARE,
    LARGEST_PRESS,
    NODAL_SHARE,
    PASSES_TO_FIND,
    NoPockets,
    Pockets,
)
from tests.castx.mechanics.lone_bodies import (
    LENGTH,
    MELTING,
    POISSON,
    SHUT,
    WIDTH,
    YOUNG,
    alone,
    begin,
    inside,
    molten_ends,
    move,
)
from tests.elastic_bodies import STRESS_FREE, elastic

RADIUS, HEIGHT, SIZE = 0.03, 0.06, 0.004
WEIGHT = -2700 * 9.81
COMPRESSIBILITY = 3 * (1 - 2 * POISSON) / YOUNG
STIFFNESS = 1 / (FULL_SHARE * COMPRESSIBILITY)
UNIFORM = np.diag([0.5, 0.5, 0.0])
"""Displacement gradient of a volumetric strain of one."""


@pytest.fixture(scope="module")
def casting() -> BodyMesh:
    sizes = {"radius": RADIUS, "height": HEIGHT, "wall": 0.01, "size": SIZE}
    description = {"model": "axisymmetric", "generator": "cylinder_in_mould", **sizes}
    geometry = Geometry.model_validate(description)
    return build_mesh(geometry, ["casting", "mould"], MPI.COMM_WORLD).bodies["casting"]


def update(pockets: Pockets, liquid: np.ndarray) -> np.ndarray:
    """Begin a step in which no metal shrinks, at no strain; return which cells are trapped."""
    metal = elastic(YOUNG, POISSON, **MELTING)
    cells = np.full(len(liquid), COMPRESSIBILITY)
    material: Any = SimpleNamespace(
        law=Law(metal, STRESS_FREE),
        coherent=~liquid,
        conditions=SimpleNamespace(solid_compressibility=cells, start_share=cells, share=cells),
        points=SimpleNamespace(volumes_to_cells=np.asarray, cells_to_volumes=np.asarray),
        compressibility=SimpleNamespace(x=SimpleNamespace(array=cells.copy())),
        start_volume=CellVolume(*np.zeros((4, len(liquid)))),
        swell=lambda strain: None,
    )
    space = pockets.pressure.function_space
    fraction = np.ones(len(pockets.pressure.x.array))
    fraction[space.dofmap.list[liquid].ravel()] = 0.0
    pockets.begin(material, fraction)
    pockets.evaluate(np.zeros(len(liquid)))
    return pockets.content.pocket >= 0


def core_of(casting: BodyMesh) -> np.ndarray:
    r, z = casting.points[casting.nodes.dofmap.list].mean(axis=1).T
    return (r < RADIUS / 2) & (np.abs(z - HEIGHT / 2) < HEIGHT / 4)


def test_the_pressure_of_a_pocket_begins_where_it_closed(casting) -> None:
    """That of its nodes then, as long as it is a pocket; from there it has that of its volume."""
    r, z = casting.points[casting.nodes.dofmap.list].mean(axis=1).T
    core = core_of(casting)
    column = core | ((r < RADIUS / 2) & (z > HEIGHT / 2))
    pockets = Pockets(casting, "axisymmetric", ["mould", "base"])
    nodes, cells = len(casting.points), len(r)
    assert not update(pockets, column).any()
    pockets.commit(partial(np.full, nodes, -5e4), np.zeros(cells))
    assert pockets.mean_pressure == 0.0
    for pressure in (7e6, 9e6):
        assert np.array_equal(update(pockets, core), core)
        found = pockets.cell_pressures()
        np.testing.assert_allclose(found, np.where(core, -5e4, np.nan), rtol=1e-12)
        pockets.evaluate(np.where(core, -1e-6, 3.0))
        expected = -5e4 - 1e-6 * STIFFNESS
        np.testing.assert_allclose(pockets.cell_pressures()[core], expected, rtol=1e-12)
        pockets.evaluate(np.zeros(cells))
        pockets.commit(partial(np.full, nodes, pressure), np.zeros(cells))
        assert pockets.mean_pressure == pytest.approx(-5e4, rel=1e-12)


@pytest.mark.ranks
def test_a_pocket_that_has_not_moved_keeps_its_pressure(casting) -> None:
    """From step to step, however its liquid has been spread over its cells."""
    core, cells = core_of(casting), len(casting.nodes.dofmap.list)
    pockets = Pockets(casting, "axisymmetric", ["mould", "base"])
    dilatation = -1e-6 * (1 + casting.points[casting.nodes.dofmap.list].mean(axis=1)[:, 0] / RADIUS)
    found = []
    for _ in range(3):
        update(pockets, core)
        pockets.evaluate(dilatation)
        found.append(pockets.cell_pressures()[core])
        assert np.all(found[-1] < -1e-6 * STIFFNESS)
        pockets.commit(partial(np.full, len(casting.points), 7e6), dilatation)
        np.testing.assert_allclose(found[-1], found[0], rtol=1e-9)
    assert cells > len(found[0])


@pytest.mark.ranks
def test_later_passes_of_a_step_keep_the_liquid_that_is_trapped(casting) -> None:
    """A pool that opens and closes from one pass to the next one comes to rest; each try anew."""
    core, cells = core_of(casting), len(casting.nodes.dofmap.list)
    smaller = core & (casting.points[casting.nodes.dofmap.list].mean(axis=1)[:, 1] > HEIGHT / 2)
    pockets = Pockets(casting, "axisymmetric", ["mould", "base"])
    nodal = np.zeros(len(casting.points)).copy
    for end in (pockets.rewind, partial(pockets.commit, nodal, np.zeros(cells))):
        for liquid in (core, smaller, core)[:PASSES_TO_FIND]:
            np.testing.assert_array_equal(update(pockets, liquid), liquid)
        for liquid in (smaller, core, smaller):
            np.testing.assert_array_equal(update(pockets, liquid), core)
        end()
    np.testing.assert_array_equal(update(pockets, smaller), smaller)


@pytest.mark.ranks
def test_a_pocket_that_is_closed_from_the_start_carries_its_weight(casting) -> None:
    """Liquid that fills a closed box is at rest, with the pressure of its depth."""
    everywhere = np.ones(len(casting.nodes.dofmap.list), dtype=bool)
    shut = ["mould", "base", "top"]
    pockets = Pockets(casting, "axisymmetric", shut, WEIGHT * casting.points[:, 1])
    assert update(pockets, everywhere).all()
    depth = HEIGHT - casting.points[casting.nodes.dofmap.list].mean(axis=1)[:, 1]
    np.testing.assert_allclose(pockets.cell_pressures(), WEIGHT * depth, rtol=1e-12, atol=1e-9)
    weightless = Pockets(casting, "axisymmetric", shut)
    assert update(weightless, everywhere).all() and not weightless.cell_pressures().any()


kinds = pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])


def shut_slab(comm, properties, cells="simplices", **more):
    """Return a slab that is closed all around and carries its weight."""
    formulation = {"formulation": "q1p0"} if cells != "simplices" else {}
    return alone(
        comm, cells=cells, properties=properties, closed=SHUT, body_force=(0.0, -26.5e3),
        **formulation, **more,
    )  # fmt: skip


def test_trapped_liquid_balances_its_weight_without_moving(comm):
    """Its pressure is given, and that of the nodes has an equation that hardly weighs."""
    part = shut_slab(comm, MELTING, starts_liquid=True)
    begin(part, 640.0, 0.0)
    solid = part.material.conditions.solid_compressibility
    np.testing.assert_allclose(part.material.compressibility.x.array, NODAL_SHARE * solid)
    depth = 0.01 - part.mesh.points[:, 1]
    values = part.solution.x.array.reshape(-1, part.block_size)
    values[:, 2] = -26.5e3 * depth / part.unknowns.pressure_scale
    residual = part.residual().reshape(-1, part.block_size)
    force = 26.5e3 * 0.01 * 0.005
    assert np.abs(residual[:, :2] * inside(part)[:, None]).max(initial=0.0) < 1e-10 * force
    assert np.abs(residual[:, 2]).max(initial=0.0) < 1e-10 * force
    assert part.formulation._pockets.stiffness.exists  # at the verge of pores it is full


def bulge(part) -> np.ndarray:
    """Return a displacement that stays on the surfaces, so that no volume changes in all."""
    x, y = part.mesh.points[:, :2].T
    values = np.zeros((len(x), part.block_size))
    values[:, 0] = np.sin(np.pi * x / LENGTH) * np.sin(np.pi * y / WIDTH)
    values[:, 1] = 2 * values[:, 0]
    values[(x < 1e-9) | (x > LENGTH - 1e-9) | (y < 1e-9) | (y > WIDTH - 1e-9)] = 0.0
    return values.ravel()


@kinds
def test_all_of_a_full_pocket_has_one_pressure_by_its_volume(comm, cells):
    """p_0 + κ φ, and that of depth; how the volume is spread over the cells does not matter."""
    part = shut_slab(comm, {**MELTING, "cavitation": 1e7}, cells, starts_liquid=True)
    begin(part, 640.0, 0.0)
    depth = WIDTH - part.mesh.points[part.cell_nodes].mean(axis=1)[:, 1]
    for strain in (0.0, 1e-8, -1e-3):
        expected = STIFFNESS * strain - 26.5e3 * depth
        for more in (0.0, 1e-3 * abs(strain) * bulge(part)):
            move(part, strain * UNIFORM)
            part.solution.x.array[:] += more
            part.residual()
            found = part.stress()[:, :3].mean(axis=1)
            scale = 1e-9 * (STIFFNESS * abs(strain) + 265.0)
            np.testing.assert_allclose(found, expected, rtol=0, atol=scale)
        spread = np.abs(part.material.dilatation - strain).max(initial=0.0)
        assert (comm.allreduce(spread, op=MPI.MAX) > 0.05 * abs(strain)) == (strain != 0.0)


@kinds
def test_two_pockets_have_pressures_of_their_own(comm, cells):
    """A wall moves in by δ: the pocket behind it has lost δ W, the other none."""
    part = shut_slab(comm, MELTING, cells, starts_liquid=True)
    begin(part, 640.0, molten_ends(part))
    pocket = part.formulation._pockets.content
    assert len(pocket.pockets) == 2
    values = part.solution.x.array.reshape(-1, part.block_size)
    values[:, 0] = np.where(part.mesh.points[:, 0] < 1e-9, 1e-9, 0.0)
    part.residual()
    centres = part.mesh.points[part.cell_nodes].mean(axis=1)
    x, depth = centres[:, 0], WIDTH - centres[:, 1]
    liquid = ~part.coherent
    found = (part.stress()[:, :3].mean(axis=1) + 26.5e3 * depth)[liquid]
    left = x[liquid] < LENGTH / 2
    number = comm.allreduce(int(pocket.pocket[liquid][left].max(initial=-1)), op=MPI.MAX)
    pressed = -STIFFNESS * 1e-9 * WIDTH / pocket.pockets[number]
    expected = np.where(left, pressed, 0.0)
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-6 * abs(pressed))
    assert comm.allreduce(int(left.sum())) and comm.allreduce(int((~left).sum()))


@kinds
def test_pores_open_where_the_pressure_rises_above_the_cavity_pressure(comm, cells):
    """Which it never exceeds; from there on the pocket resists no more."""
    part = shut_slab(comm, {**MELTING, "cavitation": 2e5}, cells, starts_liquid=True)
    begin(part, 640.0, 0.0)
    depth = WIDTH - part.mesh.points[part.cell_nodes].mean(axis=1)[:, 1]
    pockets = part.formulation._pockets
    for excess in (-2e5, -1e3, 1e2, 1e6, -1e3):
        move(part, (2e5 + excess) / STIFFNESS * UNIFORM)
        part.residual()
        expected = 2e5 + min(excess, 0.0) - 26.5e3 * depth
        np.testing.assert_allclose(pockets.cell_pressures(), expected, rtol=1e-9)
        assert pockets.stiffness.exists == (excess < 0.0) and part.formulation.has_pockets


@kinds
def test_a_void_that_rounding_may_leave_is_no_pore(comm, cells, caplog):
    for void, told in ((0.5e-9, False), (2e-9, True)):
        part = shut_slab(comm, MELTING, cells, starts_liquid=True)
        begin(part, 640.0, 0.0)
        move(part, void * UNIFORM)
        part.residual()
        caplog.clear()
        with caplog.at_level(logging.INFO, logger="castx"):
            part.commit()
        assert ("pores open" in caplog.text) == told


@kinds
def test_a_pocket_that_is_drawn_apart_opens_and_one_pressed_together_closes(comm, cells, caplog):
    """Its pores open at the cavity pressure, which then acts however far it is drawn apart."""
    part = shut_slab(comm, {**MELTING, "cavitation": 2e5}, cells, starts_liquid=True)
    begin(part, 640.0, 0.0)
    stretched, depth = 2e-3 * UNIFORM, WIDTH - part.mesh.points[part.cell_nodes].mean(axis=1)[:, 1]
    for factor in (1.0, 0.3, 1.0):
        move(part, factor * stretched)
        part.residual()
        found = part.stress()[:, :3].mean(axis=1)
        np.testing.assert_allclose(found, 2e5 - 26.5e3 * depth, rtol=1e-12)
    with caplog.at_level(logging.INFO, logger="castx"):
        part.commit()
    volume = 0.02 * 0.01
    totals = part.liquid_totals()
    assert totals["unfed_volume"] == pytest.approx(2e-3 * volume, rel=1e-9)
    assert totals["pocket_pressure"] == pytest.approx(2e5 - 26.5e3 * 0.005, rel=1e-9)
    assert f"{1e6 * volume:.3g} cm³ of liquid that nothing feeds" in caplog.text
    assert "pores open" in caplog.text
    begin(part, 640.0, 0.0)
    move(part, 0.1 * stretched)
    part.residual()
    assert part.liquid_totals()["unfed_volume"] == pytest.approx(2e-3 * volume, rel=1e-9)
    move(part, -0.1 * stretched)
    part.residual()  # filled, it resists
    found = part.stress()[:, :3].mean(axis=1)
    np.testing.assert_allclose(found, -2e-4 * STIFFNESS - 26.5e3 * depth, rtol=1e-9)
    caplog.clear()
    with caplog.at_level(logging.INFO, logger="castx"):
        part.commit()
    assert "pores have closed" in caplog.text
    assert part.liquid_totals()["unfed_volume"] == 0.0


def test_trapped_liquid_that_presses_beyond_any_mould_is_said_once(comm, caplog):
    part = shut_slab(comm, MELTING, starts_liquid=True)
    for pressure, times in ((0.9, 0), (1.1, 1), (1.5, 1)):
        begin(part, 640.0, 0.0)
        move(part, -pressure * LARGEST_PRESS / STIFFNESS * UNIFORM)
        part.residual()
        part.commit()
        assert caplog.text.count("which no mould bears") == times


@pytest.mark.parametrize("opened", [False, True], ids=["full", "porous"])
@pytest.mark.parametrize("stabilisation", ["osgs", "gls"])
def test_the_pressure_given_in_trapped_liquid_leaves_the_others_alone(comm, stabilisation, opened):
    """Whatever the nodes there have for a pressure, it hardly enters the equations of a shell."""
    part = shut_slab(comm, MELTING, starts_liquid=True, stabilisation=stabilisation)
    begin(part, 640.0, 0.0)
    move(part, (2e-3 if opened else -1e6 / STIFFNESS) * UNIFORM, 1e6)
    part.residual()
    assert part.formulation._pockets.stiffness.exists != opened
    bend = 1e6 * (part.mesh.points[:, 0] / 0.02) ** 2
    values = part.solution.x.array.reshape(-1, part.block_size)
    values[:, 2] = bend / part.unknowns.pressure_scale
    rows = part.residual().reshape(-1, part.block_size)[:, 2] / part.unknowns.pressure_scale
    stiffness = part.material.conditions.solid_compressibility.max()
    everywhere = 0.02 * 0.01 * stiffness * 1e6  # what a solid's pressure enters them by
    assert 0.0 < np.abs(rows).sum() < 1e-5 * everywhere


@kinds
def test_a_step_taken_back_leaves_the_pressures_of_the_accepted_one(comm, cells):
    part = shut_slab(comm, MELTING, cells, starts_liquid=True)
    begin(part, 640.0, 0.0)
    move(part, -1e-6 * UNIFORM)
    part.residual()
    part.commit()
    accepted, before = part.solution.x.array.copy(), part.residual()
    assert comm.allreduce(np.abs(before).max(initial=0.0), op=MPI.MAX) > 1e3
    begin(part, 640.0, 0.0)
    move(part, 2e-3 * UNIFORM)
    part.residual()
    part.rewind()
    part.solution.x.array[:] = accepted
    np.testing.assert_array_equal(part.residual(), before)
    move(part, -1e-6 * (UNIFORM + UNIFORM))  # not until a trial step begins
    part.residual()
    depth = WIDTH - part.mesh.points[part.cell_nodes].mean(axis=1)[:, 1]
    expected = -1e-6 * STIFFNESS - 26.5e3 * depth
    found = part.formulation._pockets.cell_pressures()
    np.testing.assert_allclose(found, expected, rtol=1e-9)


@kinds
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


SHRINKAGE = 0.05
SHRINKING: dict[str, Any] = {**MELTING, "solidification_shrinkage": SHRINKAGE}
PURE: dict[str, Any] = {**SHRINKING, "liquidus": 600.0}
metals = pytest.mark.parametrize("metal", [SHRINKING, PURE], ids=["alloy", "pure"])


def along(part, axis: int, *fractions: float) -> np.ndarray:
    """Return solid fractions of the local nodes that run through values, 5 mm from each other."""
    where = 0.005 * np.arange(len(fractions))
    return np.interp(part.mesh.points[:, axis], where, fractions)


def frozen(part, fraction: np.ndarray | float) -> dict[str, float]:
    """Accept a step in which nothing moves; return the totals."""
    begin(part, 600.0, fraction)
    part.residual()
    part.commit()
    return part.liquid_totals()


@pytest.mark.ranks
@kinds
@metals
@pytest.mark.parametrize("closed", [SHUT, SHUT[:-1]], ids=["shut", "open"])
def test_metal_is_fed_until_the_last_node_of_its_surface_is_solid(comm, cells, metal, closed):
    """Two layers freeze upwards; shut in, the lower one draws from the other, which then is alone.

    Down to the last node all that shrinks is fed, or is a void where nothing can give way. Solid
    that may not contract, under a pressure that is no unknown, takes no liquid; where it is one,
    these states of rest are in no equilibrium, and it takes less than it wants to contract.
    """
    part = alone(
        comm, cells=cells, properties=metal, closed=closed, starts_liquid=True,
        **({"formulation": "q1p0"} if cells != "simplices" else {}),
    )  # fmt: skip
    until = 1.0 if metal is PURE else 0.7
    frozen(part, 0.0)
    for rows in ((0.5, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 0.6, 0.0), (1.0, 1.0, 0.3),
                 (1.0, 1.0, 0.65), (1.0, 1.0, 1.0)):  # fmt: skip
        found = frozen(part, along(part, 1, *rows))
        low, middle, top = np.minimum(rows, until)
        demand = SHRINKAGE * LENGTH * WIDTH * (0.25 * low + 0.5 * middle + 0.25 * top)
        fed, void = (0.0, demand) if "top" in closed else (demand, 0.0)
        assert found["feeding_demand"] == pytest.approx(demand, rel=1e-10)
        assert found["fed_volume"] == pytest.approx(fed, rel=1e-10)
        resists = cells != "simplices" or metal is PURE or void == 0.0
        wanted = 0.0 if resists else SHRINKAGE * (1.0 - until) * LENGTH * WIDTH
        assert void * (1 - 1e-10) <= found["unfed_volume"] <= void * (1 + 1e-10) + wanted
        assert found["pocket_pressure"] == 0.0
    assert demand == pytest.approx(SHRINKAGE * until * LENGTH * WIDTH)


@pytest.mark.ranks
@kinds
def test_cells_that_hold_solid_draw_from_the_pool_of_their_region(comm, cells):
    """Two columns of cells are a pool, the third holds solid and liquid, the fourth is solid."""
    part = shut_slab(comm, {**SHRINKING, "cavitation": 1e5}, cells, starts_liquid=True)
    frozen(part, along(part, 0, 0.0, 0.0, 0.0, 1.0, 1.0))
    begin(part, 600.0, along(part, 0, 0.0, 0.0, 0.4, 1.0, 1.0))
    pockets = part.formulation._pockets
    x = part.mesh.points[part.cell_nodes].mean(axis=1)[:, 0]
    np.testing.assert_array_equal(pockets.content.pocket, np.where(x < 0.01, 0, -1))
    # Half of what shrinks at the nodes of f_s = 0.4 does so in the pool, half beside it.
    void = SHRINKAGE * 0.4 * 0.005 / 0.01
    for theta in (0.0, -0.5 * void, -void, -1.01 * void):
        move(part, theta * UNIFORM)
        part.residual()
        found = pockets.content.void_fraction(part.material.dilatation)
        np.testing.assert_allclose(found, [void + theta], rtol=1e-9, atol=1e-12 * void)
        assert pockets.stiffness.exists == (theta <= -void)
    move(part, np.zeros((3, 3)))
    part.residual()
    part.commit()
    totals = part.liquid_totals()
    assert totals["unfed_volume"] == pytest.approx(void * 0.01 * WIDTH, rel=1e-9)
    assert totals["fed_volume"] == 0.0
    # Melted again, they give it back.
    assert abs(frozen(part, along(part, 0, 0.0, 0.0, 0.0, 1.0, 1.0))["unfed_volume"]) < 1e-18


@pytest.mark.ranks
@kinds
@pytest.mark.parametrize("sign", [1, -1], ids=["shrinks", "swells"])
def test_a_region_without_a_pool_keeps_its_volume_and_gets_pores_in_place(comm, cells, sign):
    """All of its cells hold solid, which does not follow; metal that swells pushes it away."""
    metal = {**SHRINKING, "solidification_shrinkage": sign * SHRINKAGE}
    part = shut_slab(comm, metal, cells, starts_liquid=True)
    frozen(part, along(part, 0, 1.0, 0.0, 1.0, 0.0, 1.0))
    volume, before = part.material.start_volume.free.copy(), part.residual()
    found = frozen(part, along(part, 0, 1.0, 0.4, 1.0, 0.4, 1.0))
    shrunk = SHRINKAGE * 0.4 * LENGTH / 2 * WIDTH
    assert found["feeding_demand"] == pytest.approx(sign * shrunk, rel=1e-10)
    assert found["fed_volume"] == found["pocket_pressure"] == 0.0
    assert found["unfed_volume"] == pytest.approx(shrunk if sign > 0 else 0.0, rel=1e-10)
    assert not part.formulation.has_pockets and part.coherent.all()
    wet = np.round(part.mesh.points[:, 0] / 0.005) % 2
    pushed = 0.0 if sign > 0 else SHRINKAGE * 0.4 * wet[part.cell_nodes].mean(axis=1)
    grown = part.material.thermal_strain.x.array - volume
    np.testing.assert_allclose(grown, pushed, rtol=1e-10, atol=1e-16)
    change = np.abs(part.residual() - before).max(initial=0.0)
    moves = comm.allreduce(change, op=MPI.MAX) > 1e-9 * YOUNG * SHRINKAGE * WIDTH
    assert moves == (sign < 0)


@kinds
def test_liquid_that_is_cut_off_is_full_at_the_volume_that_it_has(comm, cells):
    """It has swollen by θ while its top was open; a skin on top then closes it in."""
    part = alone(
        comm, cells=cells, properties=SHRINKING, closed=SHUT[:-1], starts_liquid=True,
        **({"formulation": "q1p0"} if cells != "simplices" else {}),
    )  # fmt: skip
    theta = 1e-3
    begin(part, 600.0, 0.0)
    move(part, theta * UNIFORM)
    part.residual()
    part.commit()
    begin(part, 600.0, along(part, 1, 0.0, 0.0, 1.0))
    for more in (0.0, 2e-4):
        move(part, (theta + more) * UNIFORM)
        part.residual()
        found = part.formulation._pockets.content.void_fraction(part.material.dilatation)
        np.testing.assert_allclose(found, [more], rtol=1e-9, atol=1e-12)
    part.commit()
    totals = part.liquid_totals()
    assert totals["fed_volume"] == totals["feeding_demand"] > 0.0  # that of the skin
    # The skin shuts it in when its nodes are 70 % solid: 0.3 of the motion is left.
    assert totals["unfed_volume"] == pytest.approx(0.3 * 2e-4 * LENGTH * WIDTH / 2, rel=1e-8)


@kinds
@pytest.mark.parametrize("fraction", [0.7 - 1e-12, 0.7, 0.7 + 1e-12])
def test_liquid_at_coherency_stays_where_it_is(comm, cells, fraction):
    """On either side of it and just there the pores of a box that is closed stay its own."""
    part = shut_slab(comm, SHRINKING, cells, starts_liquid=True)
    for value in (0.0, 0.4, fraction):
        found = frozen(part, value)
    demand = SHRINKAGE * 0.7 * LENGTH * WIDTH
    assert found["feeding_demand"] == pytest.approx(demand, rel=1e-9)
    assert found["unfed_volume"] == pytest.approx(demand, rel=1e-9)
    assert found["fed_volume"] == 0.0
    assert part.formulation.has_pockets == (fraction <= 0.7)


def test_the_state_of_pockets_comes_back(casting) -> None:
    core, cells = core_of(casting), len(casting.nodes.dofmap.list)
    nodes = len(casting.points)
    one, other = (Pockets(casting, "axisymmetric", ["mould", "base"]) for _ in range(2))
    for pockets in (one, other):
        update(pockets, core)
    one.evaluate(np.full(cells, -1e-6))
    one.commit(partial(np.full, nodes, 3e5), np.full(cells, -1e-6))
    for name, part in one.stateful_parts().items():
        saved = {key: each.values for key, each in part.saved().items()}
        other.stateful_parts()[name].restore(saved)
    for each, now in ((f(one), f(other)) for f in (Pockets.cell_pressures, Pockets.totals)):
        np.testing.assert_equal(each, now)
    for pockets in (one, other):
        update(pockets, core)
        pockets.evaluate(np.full(cells, -2e-6))
    np.testing.assert_array_equal(one.cell_pressures(), other.cell_pressures())
    assert other.mean_pressure == one.mean_pressure == pytest.approx(-1e-6 * STIFFNESS, rel=1e-9)
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
    stands_for.stiffen(np.ones(part.unknowns.owned), np.ones(part.unknowns.owned))
    stands_for.evaluate(np.full(len(part.cell_nodes), 1e9))
    assert not stands_for.stiffness.exists
