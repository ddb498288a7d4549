"""All generators: they mesh what they declare, bodies, surfaces and extents, from a case file."""

from __future__ import annotations

import inspect
import random
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from itertools import combinations, pairwise
from pathlib import Path

import numpy as np
import pytest

import castx.meshes.generators
from castx.case.geometry import GENERATORS, Geometry
from castx.domain.mesh import build_mesh
from castx.domain.summary import mesh_summary
from castx.errors import CaseError
from castx.meshes.generators.declaration import COMMON_ARGUMENTS
from tests.meshes.gmsh_meshes import generated

pytestmark = pytest.mark.serial

VARIANTS = [(name, model) for name, generator in GENERATORS.items() for model in generator.models]


def test_every_file_of_the_room_is_a_generator():
    folder = Path(castx.meshes.generators.__path__[0])
    assert set(GENERATORS) == {path.stem for path in folder.glob("[!_]*.py")} - {"declaration"}


def test_a_case_is_checked_without_gmsh():
    code = "import sys, castx.case.case; sys.exit('gmsh' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize("name", GENERATORS)
def test_a_generator_leaves_gmsh_to_the_model_that_it_fills(name):
    path = Path(castx.meshes.generators.__path__[0]) / f"{name}.py"
    assert "import gmsh" not in path.read_text()


@pytest.mark.parametrize("name", GENERATORS)
def test_arguments_are_those_of_the_function(name):
    """What has a default may be left out in some model, everything else is needed in all."""
    generator = GENERATORS[name]
    parameters = inspect.signature(generator.mesh).parameters
    assert {p.kind for p in parameters.values()} == {inspect.Parameter.KEYWORD_ONLY}
    declared = {**generator.arguments, **COMMON_ARGUMENTS}
    assert set(parameters) - {"model"} == set(declared)
    needed = {key for key, a in declared.items() if set(generator.models) <= set(a.needed)}
    without_default = {p.name for p in parameters.values() if p.default is inspect.Parameter.empty}
    assert without_default - {"model"} == needed
    for argument in declared.values():
        assert set(argument.needed) <= set(argument.models)


@cache
def example(name, model, cells="simplices", size=0.01, **sizes):
    """Return the mesh of the example of a generator as a case file asks for it."""
    generator = GENERATORS[name]
    given = {**generator.example(model), "cells": cells, "size": size, **sizes}
    arguments = Geometry.read(given).arguments
    return generated(generator.mesh, list(generator.surfaces), model=model, **arguments)


@pytest.mark.parametrize("cells", ["simplices", "quadrilaterals"])
@pytest.mark.parametrize("name, model", VARIANTS)
def test_bodies_have_proper_cells_and_share_nodes(name, model, cells):
    mesh = example(name, model, cells)
    bodies = list(GENERATORS[name].surfaces)
    nodes = [set(mesh.cells[mesh.bodies == body].ravel()) for body in range(len(bodies))]
    dimension = mesh.points.shape[1]
    assert mesh.cells.shape[1] == (dimension + 1 if cells == "simplices" else 2**dimension)
    assert all(nodes), f"a body of {bodies} has no cells"
    for own, other in pairwise(nodes):
        assert len(own & other) >= mesh.points.shape[1], f"bodies of {bodies} do not touch"
    volumes = mesh.kind.corner_volumes(mesh.points[mesh.cells])
    assert (volumes > 0.0).all()
    assert len(np.unique(mesh.points.round(9), axis=0)) == len(mesh.points)


def surfaces_found(mesh, bodies) -> Iterator[tuple[str, str]]:
    """Yield body and name of every named face."""
    corners = mesh.faces.shape[1]
    owner = {
        frozenset(chosen): bodies[body]
        for cell, body in zip(mesh.cells, mesh.bodies, strict=True)
        for chosen in combinations(cell, corners)
    }
    for face, surface in zip(mesh.faces, mesh.face_surfaces, strict=True):
        yield owner[frozenset(face)], mesh.surface_names[surface]


@pytest.mark.parametrize("name", GENERATORS)
def test_surfaces_are_those_that_are_declared(name):
    """Each one is there in some model, and no other one in any."""
    generator = GENERATORS[name]
    found = set()
    for model in generator.models:
        mesh = example(name, model)
        found |= set(surfaces_found(mesh, list(generator.surfaces)))
    declared = {(body, name) for body, names in generator.surfaces.items() for name in names}
    assert found == declared


@pytest.mark.parametrize("name, model", VARIANTS)
def test_outer_dimensions_hold_the_mesh(name, model):
    """A mesh that symmetry halves has half of them; the memory of a run is estimated by them."""
    mesh = example(name, model)
    real = np.sort(np.ptp(mesh.points, axis=0))
    given = GENERATORS[name].outer_dimensions(GENERATORS[name].example(model))
    given = np.sort([*given, *[max(given)] * (len(real) - len(given))])
    assert (given > 0.49 * real).all() and (given < 2.01 * real).all()


@pytest.mark.parametrize("name, model", VARIANTS)
def test_sizes_bound_the_cells(name, model):
    coarse, fine = (example(name, model, size=size) for size in (0.01, 0.005))
    assert len(fine.cells) > 2 * len(coarse.cells)


@pytest.mark.parametrize("name, model", VARIANTS)
def test_sizes_at_the_interface_and_their_growth_act(name, model):
    slow = {"interface_size": 0.004, "order_of_growth": 3.0}
    meshes = (example(name, model, **sizes) for sizes in ({}, {"interface_size": 0.004}, slow))
    uniform, graded, slowly_graded = (len(mesh.cells) for mesh in meshes)
    assert uniform < graded < slowly_graded


def varied(dice: random.Random, value: object) -> object:
    """Return a value of an argument that a case may give: other lengths, and more or fewer."""
    match value:
        case bool():
            return dice.random() < 0.5
        case int() | float():
            return value * dice.choice((0.2, 0.5, 1.0, 2.0, 5.0))
        case list() | tuple():
            count = dice.choice((len(value) - 1, len(value), len(value), len(value) + 1))
            return [varied(dice, dice.choice(value)) for _ in range(count)]
        case _:
            return value


@pytest.mark.parametrize("name, model", VARIANTS)
def test_a_case_refuses_what_cannot_be_meshed(name, model):
    """What is read without a problem is meshed; `problems` says before gmsh what contradicts."""
    generator, dice, meshed = GENERATORS[name], random.Random(f"{name} {model}"), 0
    given = generator.example(model)
    for _ in range(300):
        own = {key: varied(dice, given[key]) for key in generator.arguments if key in given}
        try:
            arguments = Geometry.read({**given, **own, "size": 0.05}).arguments
        except CaseError:
            continue
        try:
            generated(generator.mesh, list(generator.surfaces), model=model, **arguments)
        except ValueError as error:
            pytest.fail(f"{own}: `problems` of {name} does not say that {error}")
        meshed += 1
        if meshed == 10:
            return
    pytest.fail(f"only {meshed} of 300 drawn sets of arguments of {name} are accepted")


@pytest.mark.parametrize(("name", "model"), VARIANTS)
def test_moduli_are_volume_over_surface_of_the_mesh(name, model, comm):
    """Of meshes so fine that the polygon of a round section has a hundredth of its area less."""
    geometry = Geometry.read({**GENERATORS[name].example(model), "size": 0.006})
    declared = geometry.moduli
    assert set(declared) <= set(GENERATORS[name].surfaces)
    assert declared or name == "slab"
    mesh = build_mesh(geometry, list(GENERATORS[name].surfaces), comm)
    for body in mesh_summary(mesh).bodies:
        if body.name in declared:
            assert declared[body.name] == pytest.approx(body.modulus, rel=0.01)
