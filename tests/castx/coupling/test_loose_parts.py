"""Plugs and cores inside a ring that is cast: what holds them, what they can do, and the cure."""

from __future__ import annotations

from functools import partial
from pathlib import Path

import gmsh
import pytest

from castx.case.reading.read import read_case
from castx.coupling.loose_parts import loose_parts
from castx.domain.mesh import build_mesh
from castx.domain.pairs.pairing import case_pairs
from castx.proof.verification.states import drawn_mesh

HEIGHT, WIDTHS = 0.02, {"mould": 0.06, "casting": 0.04, "core": 0.024}
BASE = "base"


def draw(names: dict[str, str], base: bool, flat: bool) -> None:
    """Draw squares in each other, or prisms, the inner ones cut out of the outer ones.

    Args:
        names: body of each of them.
        base: whether a plate lies under all of them.
        flat: whether they are squares.
    """
    occ, made = gmsh.model.occ, {}
    for name, width in WIDTHS.items():
        low = -0.5 * width
        square = occ.addRectangle(low, low, 0.0, width, width)
        ends = [] if flat else occ.extrude([(2, square)], 0, 0, HEIGHT)
        made[name] = square if flat else next(tag for dim, tag in ends if dim == 3)
    if base:
        made[BASE] = occ.addBox(-0.03, -0.03, -0.005, 0.06, 0.06, 0.005)
    dimension = 2 if flat else 3
    _, parts = occ.fragment([(dimension, tag) for tag in made.values()], [])
    occ.synchronize()
    inner: set[int] = set()
    found: dict[str, list[int]] = {}
    for name, pieces in reversed(list(zip(made, parts, strict=True))):
        own = {tag for _, tag in pieces} - inner
        inner |= own
        found.setdefault(names.get(name, name), []).extend(own)
    faces: dict[int, list[str]] = {}
    for name, tags in found.items():
        gmsh.model.addPhysicalGroup(dimension, tags, name=name)
        for _, face in gmsh.model.getBoundary([(dimension, t) for t in tags], oriented=False):
            faces.setdefault(face, []).append(name)
    free = [face for face, bodies in faces.items() if len(bodies) == 1]
    top = [f for f in free if not flat and gmsh.model.getBoundingBox(dimension - 1, f)[2] > 0.019]
    for name, tags in (("top", top), ("outside", [face for face in free if face not in top])):
        gmsh.model.addPhysicalGroup(dimension - 1, tags, name=name)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.01)
    gmsh.model.mesh.generate(dimension)


def case_of(*touching, bodies=("mould", "casting", "core"), model="3d", **changes):
    metal = {"young_modulus": 2e11, "poisson_ratio": 0.3, "expansion": 1e-5}
    return {
        "geometry": {"file": "mesh.msh", "model": model},
        "materials": {"metal": metal},
        "bodies": [{"name": name, "material": "metal", "temperature": 20.0} for name in bodies],
        "interfaces": [
            {"bodies": [first, second], "contact": {"method": method}}
            for first, second, method in touching
        ],
        "time": {"end": 1.0, "fixed_step": 1.0},
        "coupling": {"scheme": "mechanical"},
    } | changes  # fmt: skip


def told(comm, data, names=None, *, base=False):
    draws = partial(draw, names or {}, base, data["geometry"]["model"] != "3d")
    with drawn_mesh(comm, draws) as folder:
        case = read_case(data, Path(folder) / "case.toml")
        mesh = build_mesh(case.geometry, [body.name for body in case.bodies], comm)
        return list(loose_parts(case, mesh, case_pairs(mesh, case.interfaces)))


IN_MOULD, ON_CORE = ("casting", "mould", "condensed"), ("casting", "core", "condensed")
FRAME = {"stiffness": 1e7, "direction": "all"}
AT_TOP = {"on": "core/top", "clamp": FRAME}
FIXED = {"on": "mould/outside", "displacement": {"all": 0.0}}


@pytest.mark.ranks
def test_a_core_that_touches_the_casting_alone(comm):
    (text,) = told(comm, case_of(IN_MOULD, ON_CORE))
    assert text.startswith(
        "core: nothing but contact holds it, so that it moves along x, y, z and "
        "turns as the casting shrinks"
    )
    stiffness = 0.01 * 2e11 * (0.024**2 * 0.02) ** (1 / 3)
    assert f'clamp = {{ stiffness = "{stiffness / 1e6:.2g} kN/mm", direction = "all" }}' in text
    assert 'on = "core/' in text and 'mould floats too and then needs on = "mould/' in text


@pytest.mark.ranks
def test_a_piece_of_the_mould_of_its_own(comm):
    """The key on its surface holds the rest of the mould too."""
    (text,) = told(comm, case_of(IN_MOULD, bodies=("mould", "casting")), {"core": "mould"})
    assert text.startswith("a piece of mould round (") and ", 0.01) m: nothing but contact" in text
    assert 'on = "mould/' in text and "floats too" not in text


@pytest.mark.serial
@pytest.mark.parametrize(
    "boundaries, loose, ways",
    [
        ([FIXED], "core", "moves along x, y, z and turns"),
        ([AT_TOP], "mould", "moves along x, y, z and turns"),
        ([FIXED, {"on": "core/top", "displacement": {"normal": 0.0}}], "core",
         "moves along x, y and turns"),
        ([FIXED, {"on": "core/top", "displacement": {"x": "uniform"}}], "core",
         "moves along x, y, z and turns"),
    ],
)  # fmt: skip
def test_what_a_part_can_do_beside_a_part_that_is_held(comm, boundaries, loose, ways):
    (text,) = told(comm, case_of(IN_MOULD, ON_CORE, boundaries=boundaries))
    assert text.startswith(f"{loose}: nothing") and f"so that it {ways} as the" in text
    assert "floats too" not in text


@pytest.mark.serial
@pytest.mark.parametrize(
    "data",
    [
        case_of(IN_MOULD, ON_CORE, boundaries=[AT_TOP, {"on": "mould/top", "clamp": FRAME}]),
        case_of(IN_MOULD, ON_CORE, boundaries=[
            {"on": f"{name}/top", "displacement": {"all": 0.0}} for name in ("core", "mould")]),
        case_of(IN_MOULD, ("casting", "core", "tied")),
        case_of(("mould", "casting", "condensed"), ("core", "casting", "condensed")),
        case_of(IN_MOULD, ("casting", "core", "none")),
        case_of(IN_MOULD, bodies=("mould", "casting"), coupling={"scheme": "thermal"}),
    ],
    ids=["frames", "fixed", "tied", "shrunk on", "apart", "no mechanics"],
)  # fmt: skip
def test_nothing_is_said_of_what_is_held_or_cast(comm, data):
    names = {} if len(data["bodies"]) == 3 else {"core": "mould"}
    if data["coupling"]["scheme"] == "thermal":
        data["materials"]["metal"] |= {"density": 7e3, "heat_capacity": 5e2, "conductivity": 30.0}
        data["interfaces"][0]["heat"] = {"law": "constant", "closed": 1e3}
    assert told(comm, data, names) == []


@pytest.mark.ranks
@pytest.mark.parametrize("method", ["tied", "condensed"])
def test_a_core_in_its_print(comm, method):
    """The base is part of the mould, and the core stands on it."""
    data = case_of(IN_MOULD, ON_CORE, ("core", "mould", method))
    found = told(comm, data, {BASE: "mould"}, base=True)
    assert [text.partition(":")[0] for text in found] == ([] if method == "tied" else ["core"])


@pytest.mark.serial
def test_a_core_beside_a_rigid_mould(comm):
    data = case_of(IN_MOULD, ON_CORE)
    data["bodies"][0]["law"] = "rigid"
    (text,) = told(comm, data)
    assert text.startswith("core: nothing") and "floats too" not in text
    data["bodies"][2]["law"] = "rigid"
    assert told(comm, data) == []


@pytest.mark.serial
def test_a_core_without_a_free_surface(comm):
    (text,) = told(comm, case_of(IN_MOULD, ON_CORE, model="plane-strain"))
    assert "so that it moves along x, y and turns as" in text
    assert "it has no free surface to hang it at" in text and 'give core law = "rigid"' in text
