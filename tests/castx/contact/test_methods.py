"""Contact methods: the gap against known planes, PᵀAP against dense products, reaction."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.contact.condensed import CondensedContact
from castx.errors import CaseError
from tests.contact_methods import AT_ONCE, EXACT
from tests.elastic_bodies import (
    blocks,
    body,
    elastic,
    everywhere,
    fixed,
    gaps,
    generated,
    heat,
    motion,
    places,
    pressures,
    problem,
    pulled,
    pushed,
)

SOFT, STIFF = (7e9, 0.33), (70e9, 0.3)


def ring(comm, method: str, overlap: float = -2e-5, **law):
    """Return a hot ring on a core, of which a part has come off."""
    mesh = generated(
        comm, "plane-strain", "core_in_ring", ["core", "casting"],
        core_radius=0.03, outer_radius=0.05, size=0.004,
    )  # fmt: skip
    bodies = {
        "core": body(elastic(*STIFF, 1e-5), **law),
        "casting": body(elastic(*SOFT, 2e-5), **law),
    }
    contact = Contact("casting", "core", method, lambda x: overlap + 2e-3 * x[:, 0])
    made = problem(mesh, bodies, {}, [contact])
    heat(made, lambda x: 20 - 2e3 * x[:, 0])
    made.equilibrium.solve(0.0)
    return made


@pytest.mark.parametrize(
    "law", [{}, {"formulation": "displacement"}], ids=["mixed", "displacement"]
)
@pytest.mark.parametrize("method", AT_ONCE)
def test_action_is_reaction(comm, method, law):
    """At every pair the forces of the two bodies are ±f n, and nothing acts elsewhere."""
    made = ring(comm, method, **law)
    pairs, normals = made.pairs[0], made.gaps.interfaces[0].normals
    forces = made.equilibrium.pair_values()[1]
    inside = np.all(pairs.points > 1e-9, axis=1)
    expected = (forces[:, None] * normals)[inside]
    residuals = {
        n: everywhere(comm, b.residual().reshape(-1, b.block_size)[:, :2])
        for n, b in made.bodies.items()
    }
    largest = everywhere(comm, forces).max()
    np.testing.assert_allclose(
        residuals["casting"][pairs.secondary_nodes[inside]], expected, atol=1e-10 * largest
    )
    np.testing.assert_allclose(
        residuals["core"][pairs.primary_nodes[inside]], -expected, atol=1e-10 * largest
    )
    assert 0 < np.count_nonzero(everywhere(comm, forces)) < len(everywhere(comm, forces))


def test_methods_agree_pair_by_pair(comm):
    condensed, multipliers = (ring(comm, method) for method in EXACT)
    largest = pressures(comm, condensed).max()
    np.testing.assert_allclose(
        pressures(comm, condensed), pressures(comm, multipliers), atol=1e-10 * largest
    )
    for name in condensed.bodies:
        expected = everywhere(comm, motion(multipliers, name)[:, :2])
        size = np.abs(expected).max()
        found = everywhere(comm, motion(condensed, name)[:, :2])
        np.testing.assert_allclose(found, expected, atol=1e-10 * size)
    np.testing.assert_allclose(gaps(comm, condensed), gaps(comm, multipliers), atol=1e-14)


@pytest.mark.parametrize("method", EXACT)
def test_complementarity(comm, method):
    made = ring(comm, method)
    gap, pressure = gaps(comm, made), pressures(comm, made)
    assert gap.min() > -1e-12
    assert pressure.min() >= -1e-12 * pressure.max()
    assert np.abs(gap * pressure).max() < 1e-12 * pressure.max()
    assert 0 < np.count_nonzero(pressure) < len(pressure)


def test_gap_matrix_of_planes(comm):
    """The gap of two rigid motions is that of two planes."""
    mesh = blocks(comm, symmetry=False)
    made = problem(
        mesh, {n: body(elastic(*SOFT)) for n in ("upper", "base")}, {"base": [fixed("bottom")]},
        [Contact("upper", "base", initial_gap=lambda x: 1e-3 + x[:, 0])],
    )  # fmt: skip
    vector = made.layout.create_vector()
    for b, part in enumerate(made.bodies.values()):
        owned = part.space.dofmap.index_map.size_local
        x = part.mesh.nodes.tabulate_dof_coordinates()[:owned]
        values = np.zeros((owned, 3))
        values[:, 0] = 7.0
        values[:, 1] = 2.0 + 3.0 * x[:, 0] if b == 0 else 1.0 - 5.0 * x[:, 0]
        vector.array[made.layout.local_slice(b)] = values.ravel()
    x = made.pairs[0].points[:, 0]
    np.testing.assert_allclose(made.gaps.values(vector), 1e-3 + x + 1.0 + 8.0 * x, atol=1e-14)


def test_condensed_matrix_against_dense_products(comm):
    made = ring(comm, "condensed")
    balance = made.equilibrium.balance
    contact, assembly = balance.contact.pairs, balance.assembly
    assert isinstance(contact, CondensedContact)
    A, P = assembly.matrix(), balance.transform.P

    def dense(matrix):
        return np.vstack(comm.allgather(matrix.convert("dense").getDenseArray().copy()))

    contact.update_bodies(A)
    matrix = contact.matrix(balance.present(made.equilibrium.x))
    found, change, original = dense(matrix), dense(P), dense(A)
    expected = change.T @ original @ change
    np.testing.assert_allclose(found, expected, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("method", AT_ONCE)
def test_jacobian_against_differences_of_the_residual(comm, method):
    """OSGS, held rows, closed pairs, springs and multipliers included."""
    mesh = blocks(comm, symmetry=False, size=0.01)
    loads = (pushed("top", 1e6),)
    bodies = {"upper": body(elastic(*SOFT), loads=loads), "base": body(elastic(*STIFF))}
    held = {"base": [fixed("bottom", "all")]}
    made = problem(mesh, bodies, held, [Contact("upper", "base", method)])
    made.equilibrium.solve(0.0)
    equilibrium = made.equilibrium
    x = equilibrium.x.duplicate()
    first = int(comm.exscan(x.getLocalSize()) or 0)
    direction = x.duplicate()
    direction.array[:] = 1e-6 * np.sin(1.0 + 0.7 * (first + np.arange(x.getLocalSize())))
    results = []
    for sign in (1.0, -1.0):
        equilibrium.x.copy(x)
        x.axpy(sign, direction)
        f = x.duplicate()
        equilibrium.balance.residual(x, f)
        results.append(f.array_r.copy())
    product = x.duplicate()
    equilibrium.balance.operator.mult(None, direction, product)
    difference = (results[0] - results[1]) / 2
    scale = comm.allreduce(np.abs(difference).max(initial=0.0), op=max)
    np.testing.assert_allclose(difference, product.array_r, atol=1e-6 * scale)


@pytest.mark.parametrize("method", AT_ONCE)
def test_a_block_tilts_and_opens_at_one_side(comm, method):
    """Under a moment the pairs at one side open; the resultant of the others is the load."""
    mesh = blocks(comm, symmetry=False)
    loads = (pushed("top", 1e6), pulled("side", 2e5, 0.0))
    made = problem(
        mesh, {"upper": body(elastic(*SOFT), loads=loads), "base": body(elastic(*STIFF))},
        {"base": [fixed("bottom", "all")], "upper": [fixed("top", "x")]},
        [Contact("upper", "base", method)],
    )  # fmt: skip
    report = made.equilibrium.solve(0.0)
    forces = everywhere(comm, made.equilibrium.pair_values()[1])
    assert forces.sum() == pytest.approx(1e6 * 0.02, rel=1e-9)
    base = made.bodies["base"]
    bottom = np.abs(places(made, "base")[:, 1] + 0.02) < 1e-9
    reaction = everywhere(comm, base.residual().reshape(-1, base.block_size)[bottom, 1]).sum()
    assert reaction == pytest.approx(forces.sum(), rel=1e-10)
    assert report.contact_changes > 0
    assert 0 < np.count_nonzero(forces) < len(forces)


def test_initial_gap_closes_under_load(comm):
    made = problem(
        blocks(comm), {"upper": body(elastic(*SOFT)), "base": body(elastic(*STIFF))},
        {"base": [fixed("bottom")], "upper": [fixed("top", value=-3e-5)]},
        [Contact("upper", "base", initial_gap=lambda x: np.full(len(x), 2e-5))],
    )  # fmt: skip
    made.equilibrium.solve(0.0)
    factor = 1 - SOFT[1] ** 2, 1 - STIFF[1] ** 2
    expected = 1e-5 / (0.03 * factor[0] / SOFT[0] + 0.02 * factor[1] / STIFF[0])
    np.testing.assert_allclose(pressures(comm, made), expected, rtol=1e-8)
    np.testing.assert_allclose(gaps(comm, made), 0.0, atol=1e-15)


def test_methods_cannot_be_mixed(comm):
    bodies = {n: body(elastic(*SOFT)) for n in ("upper", "base")}
    contacts = [Contact("upper", "base", method) for method in EXACT]
    with pytest.raises(CaseError, match="contact methods condensed, multipliers in one case"):
        problem(blocks(comm), bodies, {}, contacts)
