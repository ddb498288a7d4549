"""Patch tests on assemblies with edges and points at which three and four bodies meet.

One is drawn as a mesh, one comes from a STEP file, with a conical core, a parting and sides of the
chill that lean.

A uniform pressure round the assembly is the stress everywhere; bodies of equal bulk modulus shrink
alike, u = -p/(3K) x. It crosses every interface at right angles, whatever its direction, also
at the round edge of the casting. A uniform flux crosses perfect interfaces as if there were none.
R. L. Taylor and P. Papadopoulos (1991), On a patch test for contact problems in two dimensions.
"""

from __future__ import annotations

from collections.abc import Sequence

from mpi4py import MPI

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.domain.measures import nodal_areas
from castx.domain.pairs.node_pairs import node_pairs
from castx.heat.body import HeatBody
from castx.heat.interface import HeatExchange
from castx.heat.problem import HeatProblem
from tests.elastic_bodies import (
    body,
    drawn,
    elastic,
    everywhere,
    fixed,
    gaps,
    motion,
    places,
    pressures,
    problem,
    pushed,
    stresses,
)
from tests.heat_conditions import surface_heat
from tests.multi_body import BODIES, CASTING_FIRST, HIGH, MOULD_FIRST, draw, turn
from tests.multi_body_step import meshed_step
from tests.verification.heat_strips import material

PRESSURE, BULK = 25e6, 70e9
POISSON = dict(zip(BODIES, (0.33, 0.2, 0.35, 0.3, 0.25), strict=True))


CHILL_AREAS = {"drawn": 0.012 * 0.014, "step": 0.012 * 0.016}


@pytest.fixture(scope="module", params=["drawn", "step"])
def origin(request):
    return request.param


@pytest.fixture(scope="module")
def mesh(tmp_path_factory, origin):
    comm = MPI.COMM_WORLD
    folder = comm.bcast(tmp_path_factory.mktemp("multi"))
    if origin == "step":
        return meshed_step(comm, folder)
    return drawn(comm, "3d", BODIES, folder / "bodies.msh", draw)


def pressed(mesh, contacts: Sequence[Contact], quadratic: Sequence[str] = ()):
    """Return the assembly under pressure, held by its planes of symmetry, in equilibrium."""
    bodies, held = {}, {}
    for name, poisson in POISSON.items():
        surfaces = mesh.bodies[name].surfaces
        loads = tuple(pushed(s, PRESSURE) for s in surfaces if s.startswith("far-"))
        formulation = "taylor-hood" if name in quadratic else "mixed"
        metal = elastic(3 * BULK * (1 - 2 * poisson), poisson)
        bodies[name] = body(metal, loads=loads, formulation=formulation)
        held[name] = [fixed(s) for s in surfaces if s.startswith("plane-")]
    made = problem(mesh, bodies, held, contacts)
    assert made.equilibrium.solve(0.0).balanced
    return made


def check_uniform(comm, made):
    """Compare stress and displacement of all bodies with the exact ones."""
    largest = PRESSURE / (3 * BULK) * np.linalg.norm(HIGH)
    for name in BODIES:
        stress = stresses(comm, made, name)
        np.testing.assert_allclose(stress[:, :3], -PRESSURE, rtol=1e-8)
        np.testing.assert_allclose(stress[:, 3:], 0.0, atol=1e-8 * PRESSURE)
        expected = -PRESSURE / (3 * BULK) * places(made, name)
        np.testing.assert_allclose(
            motion(made, name)[:, :3], expected, rtol=0.0, atol=1e-8 * largest
        )
    assert np.abs(gaps(comm, made)).max() < 1e-8 * largest


def test_pressure_crosses_all_interfaces_and_the_points_where_four_bodies_meet(comm, mesh):
    made = pressed(mesh, [Contact(*names) for names in MOULD_FIRST])
    check_uniform(comm, made)
    np.testing.assert_allclose(pressures(comm, made), PRESSURE, rtol=1e-8)
    assert len(everywhere(comm, made.gaps.areas)) > 100


@pytest.mark.parametrize("quadratic", [("casting",), BODIES])
def test_pressure_crosses_the_interfaces_of_quadratic_bodies(comm, mesh, quadratic):
    """Some of which are round: mid-sides have the area vectors of their edges."""
    made = pressed(mesh, [Contact(*names) for names in MOULD_FIRST], quadratic)
    check_uniform(comm, made)
    np.testing.assert_allclose(pressures(comm, made), PRESSURE, rtol=1e-8)


def test_areas_of_pairs_are_those_of_the_surfaces(comm, mesh, origin):
    """Each interface carries the heat of its own area, also where it ends at others."""
    for secondary, primary in CASTING_FIRST:
        own, other = node_pairs(mesh, secondary, primary), node_pairs(mesh, primary, secondary)
        area = comm.allreduce(own.areas.sum())
        assert area == pytest.approx(comm.allreduce(other.areas.sum()), rel=1e-12)
        np.testing.assert_allclose(
            comm.allreduce(own.area_vectors.sum(axis=0)),
            -comm.allreduce(other.area_vectors.sum(axis=0)),
            atol=1e-12 * area,
        )
    chill = comm.allreduce(node_pairs(mesh, "casting", "chill").areas.sum())
    assert chill == pytest.approx(CHILL_AREAS[origin], rel=1e-9)
    for name in BODIES:
        closed = sum(
            comm.allreduce(_owned_area(mesh, name, surface))
            for surface in mesh.bodies[name].surfaces
            if surface in BODIES
        )
        of_pairs = sum(
            comm.allreduce(node_pairs(mesh, *names).areas.sum())
            for names in CASTING_FIRST
            if name in names
        )
        assert of_pairs == pytest.approx(closed, rel=1e-12)


def _owned_area(mesh, name, surface):
    part = mesh.bodies[name]
    return nodal_areas(part, "3d", surface)[: part.nodes.dofmap.index_map.size_local].sum()


def test_a_uniform_flux_crosses_perfect_interfaces(comm, mesh):
    """From the bottom to the top through all five bodies: a linear temperature."""
    metal = material(heat_capacity=4e6, conductivity=40.0)
    exchanges = [
        HeatExchange("/".join(names), node_pairs(mesh, *names), "perfect")
        for names in CASTING_FIRST
    ]
    ends = (("lower/plane-z", 100.0), ("upper/far-z", 160.0), ("core/far-z", 160.0))
    heat = HeatProblem(
        mesh,
        [HeatBody(name, metal, 100.0) for name in BODIES],
        exchanges,
        [surface_heat(place, "temperature", value=value) for place, value in ends],
        tolerance=1e-12,
        linear="direct",
    )
    for k in range(2):
        heat.advance(k * 1e12, 1e12, [None] * len(exchanges))
        heat.commit()
    up = turn()[:, 2]
    for name in BODIES:
        points = mesh.bodies[name].nodes.tabulate_dof_coordinates()
        expected = 100.0 + 60.0 * (points @ up) / HIGH[2]
        np.testing.assert_allclose(heat.temperature[name].x.array, expected, rtol=1e-8)
