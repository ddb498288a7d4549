"""The parts of the demos: volumes, contacts, names in STEP, meshes."""

from __future__ import annotations

from collections.abc import Callable
from math import pi
from pathlib import Path
from typing import NamedTuple

import gmsh
import numpy as np
import pytest
from scipy.integrate import quad

from castx.case.reading.read import load_case
from demos.parts import block, bracket, housing, wheel
from demos.parts.assembly import (
    Assembly,
    contacts,
    faces_by_bodies,
    fill_mesh,
    free_surfaces,
    joined,
    mesh_quality,
    volumes,
    write_gmsh,
    write_step,
)
from demos.parts.solids import drawing
from demos.parts.step_names import names_of_solids

pytestmark = pytest.mark.serial

BRACKET = bracket.Bracket()
WHEEL = wheel.Wheel(spokes=2, half=1)
HOUSING = housing.Housing()
BLOCK = block.Block(cylinders=1)
PARTS: dict[str, tuple[Callable[[], Assembly], float]] = {
    "bracket": (lambda: bracket.bracket(BRACKET), 14.0),
    "wheel": (lambda: wheel.wheel(WHEEL), 18.0),
    "housing": (lambda: housing.housing(HOUSING), 16.0),
    "block": (lambda: block.block(BLOCK), 14.0),
}


class Measured(NamedTuple):
    """What a part is made of [mm], and its mesh [m]."""

    volumes: dict[str, float]
    skins: dict[str, float]
    contacts: dict[tuple[str, str], float]
    free: dict[str, dict[str, float]]
    step: str
    read: list[tuple[str, float]]
    meshed: dict[str, float]
    least_quality: float
    probes: dict[str, bool]


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    """Return a function that draws, writes, reads and meshes a part, once."""
    known: dict[str, Measured] = {}

    def measure(name: str) -> Measured:
        if name not in known:
            known[name] = measure_part(name, tmp_path_factory.mktemp(name))
        return known[name]

    return measure


def measure_part(name, folder):
    build, size = PARTS[name]
    with drawing(name):
        assembly = build()
        write_step(assembly, folder / "part.step")
        of_solids, skins = volumes(assembly), {n: skin(t) for n, t in assembly.solids.items()}
        assembly = joined(assembly)
        touching = contacts(assembly)
        free = free_areas(assembly)
        probes = {probe.name: is_inside(probe, assembly) for probe in case_of(name).probes}
        fill_mesh(assembly, size)
        meshed = {n: mesh_volume(tag) for n, tag in assembly.solids.items()}
        _, least, _ = mesh_quality()
        write_gmsh(folder / "part.msh")
    text = (folder / "part.step").read_text()
    with drawing("read"):
        gmsh.option.setNumber("Geometry.OCCImportLabels", 1)
        read = [(label(tag), gmsh.model.occ.getMass(3, tag)) for tag in imported(folder)]
    return Measured(of_solids, skins, touching, free, text, read, meshed, least, probes)


def case_of(name):
    """Return the case of a part."""
    return load_case(Path(block.__file__).parent / f"{name}.toml")


def is_inside(probe, assembly):
    """Return whether a probe lies in its body as it is drawn."""
    place = [1e3 * coordinate for coordinate in probe.at]
    return gmsh.model.isInside(3, assembly.solids[probe.body], place) == 1


def imported(folder):
    found = gmsh.model.occ.importShapes(str(folder / "part.step"))
    gmsh.model.occ.synchronize()
    return [tag for _, tag in found]


def label(solid):
    """Return the last part of the label of a solid that was read."""
    return gmsh.model.getEntityName(3, solid).split("/")[-1]


def skin(solid):
    """Return the area of all faces of a solid."""
    faces = gmsh.model.getBoundary([(3, solid)], oriented=False)
    return sum(gmsh.model.occ.getMass(2, tag) for _, tag in faces)


def free_areas(assembly):
    """Return the areas of the free faces of each body by their names."""
    found: dict[str, dict[str, float]] = {name: {} for name in assembly.solids}
    owner = {t: b[0] for b, tags in faces_by_bodies(assembly).items() if len(b) == 1 for t in tags}
    for name, tags in free_surfaces(assembly).items():
        for tag in tags:
            areas = found[owner[tag]]
            areas[name] = areas.get(name, 0.0) + gmsh.model.occ.getMass(2, tag)
    return found


def mesh_volume(solid):
    """Return the volume of the tetrahedra of a solid [mm³], all of which must have one."""
    _, nodes = gmsh.model.mesh.getElementsByType(4, solid)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    place = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    place[tags.astype(np.int64)] = np.arange(len(tags))
    corners = coordinates.reshape(-1, 3)[place[nodes.astype(np.int64)]].reshape(-1, 4, 3)
    each = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6.0
    assert (each > 0.0).all()
    return float(each.sum())


@pytest.mark.sampled
@pytest.mark.parametrize("name", PARTS)
def test_each_face_of_a_body_is_free_or_touches_one_other(measured, name):
    """Areas of a body's free faces and contacts add up to those of the solid as it was drawn."""
    part = measured(name)
    for body, area in part.skins.items():
        touching = sum(a for bodies, a in part.contacts.items() if body in bodies)
        assert touching + sum(part.free[body].values()) == pytest.approx(area, rel=1e-6)


@pytest.mark.parametrize("name", PARTS)
def test_solids_fill_the_mould_without_its_channels(measured, name):
    assert sum(measured(name).volumes.values()) == pytest.approx(MOULDS[name], rel=1e-6)


def box_volume(corners):
    return float(np.prod(np.subtract(corners[1], corners[0])))


def tube(diameter, length):
    return 0.25 * pi * diameter**2 * length


def block_volume(p):
    low, high = block.die_corners(p)
    return box_volume((low, high)) - 4 * tube(p.channel, high[0] - low[0])


def bracket_volume(p):
    low, high = bracket.die_corners(p)
    return box_volume((low, high)) - 2 * tube(p.channel, high[1] - low[1])


def wheel_volume(p):
    whole = tube(2.0 * wheel.outer(p), p.die + p.feeder_height)
    return 0.5 * (whole - 2 * tube(p.channel, 2 * pi * wheel.ring_radius(p)))


MOULDS = {
    "bracket": bracket_volume(BRACKET),
    "wheel": wheel_volume(WHEEL),
    "housing": box_volume(housing.mould_corners(HOUSING)),
    "block": block_volume(BLOCK),
}


def test_bracket_has_the_chill_the_pin_and_the_pads_that_it_should(measured):
    p, part = BRACKET, measured("bracket")
    foot = tube(p.bore, 1.0)
    length = p.chill_length
    assert part.volumes["chill"] == pytest.approx(length * 2 * p.chill * p.chill, rel=1e-10)
    assert part.contacts["casting", "chill"] == pytest.approx(length * 2 * p.chill, rel=1e-10)
    assert part.contacts["casting", "pin"] == pytest.approx(pi * p.bore * p.pad, rel=1e-9)
    assert part.contacts["upper", "pin"] == pytest.approx(pi * p.bore * p.die + foot, rel=1e-9)
    assert part.volumes["pin"] == pytest.approx(tube(p.bore, p.die + p.pad), rel=1e-9)
    assert part.free["casting"] == {"top": pytest.approx(tube(p.feeder, 1.0), rel=1e-9)}


def test_half_a_wheel_has_half_a_core(measured):
    p, part = WHEEL, measured("wheel")
    end = 0.5 * pi * p.bore**2
    assert part.volumes["core"] == pytest.approx(end * (p.print + p.hub_height), rel=1e-9)
    side = pi * p.bore
    assert part.contacts["casting", "core"] == pytest.approx(side * p.hub_height + end, rel=1e-9)
    assert part.contacts["lower", "core"] == pytest.approx(side * p.print + end, rel=1e-9)
    plane = 2 * p.bore * (p.print + p.hub_height)
    assert part.free["core"] == {"symmetry-y": pytest.approx(plane, rel=1e-9)}


def test_housing_is_filled_by_its_core(measured):
    """A room with round corners and roof, by integration of its sections over the height."""
    p, part = HOUSING, measured("housing")
    length, width = p.length - 2 * p.wall, p.width - 2 * p.wall
    corner, roof = p.corner - p.wall, p.roof - p.wall

    def section(inset):
        return (length - 2 * inset) * (width - 2 * inset) - (4 - pi) * (corner - inset) ** 2

    upper, _ = quad(lambda z: section(roof - np.sqrt(roof**2 - z**2)), 0.0, roof)
    room = section(0.0) * (p.height - p.wall - roof + p.print) + upper
    wall = p.wall + p.bearing_length
    tail = (tube(p.bore, 1.0) / 2 + p.bore * p.bearing_height) * p.print
    core = room + tube(p.bore, wall) + tail
    assert part.volumes["core"] == pytest.approx(core, rel=1e-6)
    around = 2 * (length + width) - 2 * (4 - pi) * corner
    assert part.contacts["drag", "core"] == pytest.approx(
        around * p.print + section(0.0) + p.bore * p.print, rel=1e-6
    )


def test_block_has_the_liner_and_the_jacket_that_it_should(measured):
    p, part = BLOCK, measured("block")
    inner, outer = block.radius(p, 0), block.radius(p, 1)
    height, end = p.deck - block.liner_foot(p), pi * (outer**2 - inner**2)
    assert part.volumes["liner-1"] == pytest.approx(end * height, rel=1e-9)
    assert part.contacts["casting", "liner-1"] == pytest.approx(
        2 * pi * outer * height + end, rel=1e-9
    )
    assert part.contacts["lower", "liner-1"] == pytest.approx(2 * pi * inner * height, rel=1e-9)
    assert part.contacts["upper", "liner-1"] == pytest.approx(end, rel=1e-9)
    gates = 4 * tube(p.gate, 1.0)
    assert part.free["casting"] == {"gate": pytest.approx(gates, rel=1e-9)}


@pytest.mark.parametrize("name", PARTS)
def test_step_holds_the_solids_by_their_names(measured, name):
    part = measured(name)
    assert sorted(names_of_solids(part.step)) == sorted(part.volumes)
    assert sorted(label for label, _ in part.read) == sorted(part.volumes)
    for body, volume in part.read:
        assert volume == pytest.approx(part.volumes[body], rel=1e-6)


@pytest.mark.parametrize("name", PARTS)
def test_meshes_have_the_volumes_of_the_solids(measured, name):
    """A coarse mesh cuts round corners, and what one body loses its neighbour gets."""
    part = measured(name)
    assert sum(part.meshed.values()) == pytest.approx(sum(part.volumes.values()), rel=1e-2)
    for body, volume in part.volumes.items():
        assert part.meshed[body] == pytest.approx(volume, rel=0.12)
    assert part.least_quality > 5e-3


@pytest.mark.parametrize("name", PARTS)
def test_cases_name_the_bodies_and_the_contacts_of_the_part(measured, name):
    """The case file of a part is valid, and says of every contact what crosses it."""
    case, part = case_of(name), measured(name)
    assert case.output.folder.name == name
    assert {body.name for body in case.bodies} == set(part.volumes)
    described = {frozenset(interface.bodies) for interface in case.interfaces}
    assert described == {frozenset(bodies) for bodies in part.contacts}
    assert case.geometry.model == "3d"
    assert set(case.geometry.cad.surfaces) >= set(part.free["casting"]) - {"outside"}


@pytest.mark.parametrize("name", PARTS)
def test_probes_lie_in_the_body_as_it_is_drawn(measured, name):
    """On coarse cells one beside it is moved to the nearest node, on fine ones it is refused."""
    probes = measured(name).probes
    assert probes and all(probes.values())


def test_parameters_that_do_not_fit_are_refused():
    with drawing("bracket"), pytest.raises(ValueError, match="solids where there must be one"):
        bracket.bracket(bracket.Bracket(window=300.0))


def test_names_that_select_nothing_are_refused():
    with drawing("bracket"):
        assembly = bracket.bracket(BRACKET)
        away = ((900.0, 0.0, 0.0), (901.0, 1.0, 1.0))
        wrong = Assembly("bracket", assembly.solids, {"sprue": (away,)})
        with pytest.raises(ValueError, match="'sprue'"):
            free_surfaces(joined(wrong))
