"""Residual and matrix of two bodies in one layout, from what each of them has."""

from __future__ import annotations

import numpy as np
import pytest

from castx.errors import ConvergenceError
from castx.mechanics.assembly import BodyAssembly
from castx.mechanics.body import BodyMechanics
from castx.mechanics.description import SurfaceLoad
from castx.solvers.layout import Layout
from castx.tables import Table
from tests.castx.mechanics.lone_bodies import (
    MELTING,
    POISSON,
    SHUT,
    YOUNG,
    alone,
    begin,
    begin_anywhere,
    jacobian_times,
    molten_ends,
    molten_quadrilaterals,
    random_field,
)
from tests.elastic_bodies import blocks, body, elastic, pushed

RISING = SurfaceLoad("bottom", pressure=Table(np.array([0.0, 1.0]), np.array([2e6, 4e6])))


@pytest.fixture
def bodies(comm):
    """Return a mixed body in generalised plane strain beside one of displacements, both loaded."""
    mesh, model = blocks(comm, "generalised-plane-strain"), "generalised-plane-strain"
    metal = elastic(YOUNG, POISSON, 2e-5)
    descriptions = {
        "upper": body(metal, loads=(pushed("top", 1e6),)),
        "base": body(metal, formulation="displacement", loads=(RISING,)),
    }
    parts = [BodyMechanics(mesh.bodies[n], model, d) for n, d in descriptions.items()]
    for part in parts:
        begin_anywhere(part)
    return parts


def assembled(comm, bodies):
    """Return the assembly of bodies, with unknowns at random."""
    maps = [part.space.dofmap.index_map for part in bodies]
    layout = Layout(comm, maps, [part.block_size for part in bodies])
    made = BodyAssembly(layout, bodies)
    fields = [1e-5 * random_field(part, 1.3) for part in bodies]
    made.unknowns.array[:] = joined(bodies, fields)
    return made, fields


def joined(bodies, fields):
    """Return the owned parts of fields of the bodies one after the other."""
    owned = [part.unknowns.owned for part in bodies]
    return np.concatenate([field[:size] for size, field in zip(owned, fields, strict=True)])


def test_residual_is_that_of_each_body(comm, bodies):
    made, fields = assembled(comm, bodies)
    found = made.residual().array_r.copy()
    for part, field in zip(bodies, fields, strict=True):
        np.testing.assert_allclose(part.solution.x.array, field, rtol=1e-9)
    alone = [part.residual() for part in bodies]
    np.testing.assert_array_equal(found, np.concatenate(alone))
    made.destroy()


def test_matrix_has_the_jacobians_on_its_diagonal(comm, bodies):
    made, fields = assembled(comm, bodies)
    made.residual()
    for _ in range(2):
        A = made.matrix()
    x, y = A.createVecs()
    x.array[:] = joined(bodies, fields)
    A.mult(x, y)
    product = y.array_r.copy()
    for correction in made.corrections():
        correction(x.array_r, product)
    expected = [jacobian_times(part, field) for part, field in zip(bodies, fields, strict=True)]
    scale = comm.allreduce(np.abs(product).max(), op=max)
    np.testing.assert_allclose(product, np.concatenate(expected), atol=1e-12 * scale, rtol=0)
    for item in (x, y, made):
        item.destroy()


def test_corrections_are_those_of_the_body_with_osgs(comm, bodies):
    made, fields = assembled(comm, bodies)
    x = joined(bodies, fields)
    y = np.zeros_like(x)
    (correction,) = made.corrections()
    correction(x, y)
    own = bodies[0].unknowns.owned
    assert not y[own:].any()
    rows = y[:own].reshape(-1, bodies[0].block_size)
    pressure = bodies[0].unknowns.pressure_component
    assert comm.allreduce(int(np.count_nonzero(rows[:, pressure]))) > 0
    assert not np.delete(rows, pressure, axis=1).any()
    made.destroy()


@pytest.mark.ranks
def test_corrections_have_a_matrix_in_a_layout_with_more_unknowns(comm, bodies):
    """Of the bodies that are asked for; one in its displacement has none."""
    made, fields = assembled(comm, bodies)
    maps = [part.space.dofmap.index_map for part in bodies]
    layout = Layout(comm, [*maps, maps[0]], [*(part.block_size for part in bodies), 1])
    assert made.corrections_matrix(layout, [1]) is None
    matrix = made.corrections_matrix(layout, range(2))
    x, y = matrix.createVecs()
    assert x.getSize() == layout.size_global
    known = joined(bodies, fields)
    x.array[: len(known)], x.array[len(known) :] = known, 1.0
    matrix.mult(x, y)
    expected = np.zeros_like(known)
    for correction in made.corrections():
        correction(known, expected)
    scale = comm.allreduce(np.abs(expected).max(), op=max)
    np.testing.assert_allclose(y.array_r[: len(known)], expected, atol=1e-12 * scale, rtol=0)
    assert not y.array_r[len(known) :].any() and scale > 0
    for item in (matrix, x, y, made):
        item.destroy()


def test_trapped_liquid_couples_the_displacements_of_its_body_alone(comm, bodies):
    """Two pockets of a body, between a body of displacements and a solid of the same layout."""
    full = {**MELTING, "cavitation": 1e20}  # whatever draws at it
    liquid = alone(comm, properties=full, closed=SHUT, starts_liquid=True)
    begin_anywhere(liquid, molten_ends(liquid))
    parts = [bodies[1], liquid, bodies[0]]
    made, fields = assembled(comm, parts)
    made.residual()
    assert made.has_pockets and not made.is_linear
    x = joined(parts, fields)
    y = np.zeros_like(x)
    for correction in made.coupled_corrections():
        correction(x, y)
    first, own = bodies[1].unknowns.owned, liquid.unknowns.owned
    expected = np.zeros(own)
    (add_product,) = liquid.formulation.coupled_products()
    add_product(x[first : first + own].copy(), expected)
    assert comm.allreduce(int(np.count_nonzero(expected))) > 0
    np.testing.assert_array_equal(y[first : first + own], expected)
    assert not y[:first].any() and not y[first + own :].any()
    begin_anywhere(liquid, 1.0)
    assert not made.has_pockets
    made.destroy()


def test_displacements_are_told_from_pressures(comm, bodies):
    """Displacements and the axial strain count, the pressure of the mixed body does not."""
    made, _ = assembled(comm, bodies)
    nodes = [part.owned_nodes for part in bodies]
    expected = np.concatenate([np.tile([1, 1, 0, 1], nodes[0]), np.tile([1, 1, 1], nodes[1])])
    np.testing.assert_array_equal(made.displacement_rows(), expected)
    made.destroy()


@pytest.mark.ranks
def test_force_scales_are_the_larger_of_internal_forces_and_loads(comm, bodies):
    made, _ = assembled(comm, bodies)
    made.residual()
    squares = comm.allreduce(np.array([part.force_scale() for part in bodies]))
    np.testing.assert_allclose(made.force_scales(), np.sqrt(squares.max(axis=1)), rtol=1e-14)
    made.unknowns.set(0.0)
    for part in bodies:
        begin(part, 20.0)
    made.residual()
    loads = [np.sqrt(comm.allreduce(p.formulation.forms.load @ p.formulation.forms.load))
             for p in bodies]  # fmt: skip
    np.testing.assert_allclose(made.force_scales(), loads, rtol=1e-12)
    made.destroy()


@pytest.mark.ranks
def test_a_failure_on_one_rank_is_raised_on_all(comm, bodies, monkeypatch):
    def fail():
        raise ConvergenceError("no stress at a point")

    made, _ = assembled(comm, bodies)
    if comm.rank == comm.size - 1:
        monkeypatch.setattr(bodies[1], "update_points", fail)
    with pytest.raises(ConvergenceError, match="body 'base': no stress at a point"):
        made.residual()
    made.destroy()


def test_laws_of_all_bodies_decide_what_is_linear(comm, bodies):
    made, _ = assembled(comm, bodies)
    assert made.is_linear and made.is_elastic and not made.has_pockets
    mesh, metal = blocks(comm), elastic(YOUNG, POISSON, 2e-5, **MELTING)
    liquid = BodyMechanics(mesh.bodies["upper"], "plane-strain", body(metal))
    other, _ = assembled(comm, [liquid])
    assert other.is_linear and not other.is_elastic
    for each in (made, other):
        each.destroy()


def test_only_q1p0_has_pressures_to_improve(comm, bodies):
    made, _ = assembled(comm, bodies)
    assert not made.improve_pressures()
    liquid = molten_quadrilaterals(comm)
    other, _ = assembled(comm, [liquid])
    other.residual()
    assert other.improve_pressures()
    begin(liquid, 20.0, 1.0)
    assert not other.improve_pressures()
    for each in (made, other):
        each.destroy()


def counted(monkeypatch):
    """Return a list to which every evaluation of the law of a body adds its name."""
    names, update = [], BodyMechanics.update_points

    def noted(self):
        names.append(self.name)
        update(self)

    monkeypatch.setattr(BodyMechanics, "update_points", noted)
    return names


def test_nothing_is_evaluated_twice_at_the_same_unknowns(comm, bodies, monkeypatch):
    made, _ = assembled(comm, bodies)
    names = counted(monkeypatch)
    found = made.residual().array_r.copy()
    for part in bodies:
        part.stress()
        part.commit()
    np.testing.assert_array_equal(made.residual().array_r, found)
    assert names == ["upper", "base"]
    made.unknowns.array[:] *= 2.0
    assert (made.residual().array_r != found).any()
    assert names == ["upper", "base"] * 2
    made.destroy()


@pytest.mark.parametrize("change", ["state", "load", "rewound"])
def test_a_residual_is_that_of_the_present_state(comm, bodies, change):
    """Temperature, loads and the start of the step change it although the unknowns stay."""
    made, _ = assembled(comm, bodies)
    before = made.residual().array_r.copy()
    if change == "rewound":
        for part in bodies:
            part.commit()
    for part in bodies:
        if change == "load":
            part.set_time(0.5)
        else:
            begin(part, 333.0)
    if change == "rewound":
        made.residual()
        for part in bodies:
            part.rewind()
    found = made.residual().array_r.copy()
    alone = np.concatenate([part.residual() for part in bodies])
    np.testing.assert_array_equal(found, alone)
    differs = comm.allreduce(bool((found != before).any()), op=max)
    assert differs == (change != "rewound")
    made.destroy()


@pytest.mark.ranks
def test_a_linear_body_is_assembled_once_for_each_state_of_its_material(comm, bodies, monkeypatch):
    made, _ = assembled(comm, bodies)
    made.residual()
    count = [0, 0]
    for b, part in enumerate(bodies):

        def assemble(A, b=b, inner=part.formulation.assemble_jacobian):
            count[b] += 1
            inner(A)

        monkeypatch.setattr(part.formulation, "assemble_jacobian", assemble)
    monkeypatch.setattr(type(bodies[0]), "is_linear", property(lambda part: part is bodies[1]))
    made.matrix()
    made.matrix()
    assert count == [2, 1]
    begin_anywhere(bodies[1])
    made.matrix()
    assert count == [3, 2]
    made.destroy()


def test_the_residual_of_an_accepted_liquid_is_that_of_its_better_multipliers(comm):
    """The pressures that hold its volume start the next step, so that it has to be summed anew."""
    part = molten_quadrilaterals(comm)
    made, _ = assembled(comm, [part])
    before = made.residual().array.copy()
    part.commit()
    accepted = made.residual().array.copy()
    np.testing.assert_allclose(accepted, part.residual(), rtol=1e-12)
    assert np.abs(accepted - before).max() > 0.1 * np.abs(before).max()
