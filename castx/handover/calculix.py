"""A body with its stresses as input of CalculiX: mesh, state, materials, forces and a first step.

Only a state without loads and contact is in equilibrium alone. What acts on the body otherwise is
what its stress leaves at the nodes: it is written as `*CLOAD`, without the reactions of planes of
symmetry, which are held. Plastic strain is not handed over as `TYPE=PLASTIC STRAIN`: CalculiX takes
that for a further strain and deforms the part.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from castx.arrays import BoolArray, FloatArray
from castx.foundry.cracking import principal_values
from castx.handover.body_state import BodyState
from castx.handover.classes import Classes
from castx.handover.elements import Elements
from castx.handover.material_cards import flows, material_cards, yield_stress
from castx.handover.supports import ALIGNED, Holding, supports
from castx.handover.text import digits, listed, row, write_lines
from castx.materials.lookup import find_material
from castx.materials.material import Material
from castx.version import __version__

SMALL = 1e-12
"""Force on a node, beside those of its elements, below which nothing acts on it."""
CLASSED = ("yield_strength", "arm_spacing")
"""Quantities that may be classes of elements; the first one that was written is."""
FOR = "the hand-over to CalculiX"
PER_LINE = 16


@dataclass(frozen=True, eq=False)
class Handed:
    """Report on the files for CalculiX: forces, materials, stresses above the yield stress.

    Attributes:
        files: that were written, the deck first.
        forces: share of the largest force that acts on a node in those of the elements there.
        classes: of the elements; None: all have one material.
        over: share of the elements whose stress exceeds the yield stress; None: there is none.
        excess: largest ratio of stress and yield stress.
        place: where that is, (3,) [m].
    """

    files: tuple[Path, ...]
    forces: float
    classes: Classes | None
    over: float | None
    excess: float
    place: FloatArray


def write_calculix(
    state: BodyState, folder: Path, release: bool = False, elastic: bool = False
) -> Handed:
    """Write a body with its stresses for CalculiX, a deck beside the files that it includes.

    Args:
        state: the body at a moment.
        folder: for the files.
        release: leave out what acts on the body, so that it springs back.
        elastic: leave out `*PLASTIC`.

    Raises:
        CaseError: a field or a property is missing, CalculiX has no such element, or the files
            cannot be written.
    """
    elements = elements_of(state)
    material = find_material(state.about["material"], state.case.materials)
    law = "thermo-elastic" if elastic else state.about["law"]
    held = supports(state.points, state.model, state.planes)
    forces, sizes = elements.forces()
    forces = held.without_reactions(forces)
    acting = np.linalg.norm(forces, axis=1)
    written = {name: state.in_cells(name) for name in CLASSED if state.has(name)}
    classes = _classes(written)
    stem = state.name
    parts = {
        f"{stem}-mesh.inp": mesh_lines(elements),
        f"{stem}-materials.inp": _materials(material, law, elements, classes),
        f"{stem}-state.inp": _state(elements, state.values("temperature")),
        f"{stem}-forces.inp": [] if release else force_lines(forces, acting > SMALL * sizes.max()),
    }
    deck = folder / f"{stem}.inp"
    write_lines(deck, deck_lines(state, list(parts), held))
    for name, lines in parts.items():
        write_lines(folder / name, lines)
    table = folder / f"{stem}-elements.csv"
    write_lines(table, element_rows(state, elements, classes, written))
    over, excess, place = _excess(state, elements, material, law, classes)
    return Handed(
        (deck, *(folder / name for name in parts), table),
        float(acting.max() / max(sizes.max(), np.finfo(float).tiny)),
        classes, over, excess, place,
    )  # fmt: skip


def elements_of(state: BodyState) -> Elements:
    """Return the elements of a body with its stresses.

    Raises:
        CaseError: a field is missing, or CalculiX has no such element.
    """
    simplices = state.cells.shape[1] == (4 if state.model == "3d" else 3)
    name = "stress" if simplices else "point_stress"
    wanted = [name, "temperature"]
    if state.about["law"] != "thermo-elastic":
        wanted.append("plastic_strain")
    state.need(wanted, FOR)
    stress = state.values(name)
    return Elements.of(
        state.model, state.points, state.cells, stress.reshape(len(stress), -1, 6)
    )


def von_mises(stress: FloatArray) -> FloatArray:
    """Return the equivalent of stresses (n, 6) [Pa]."""
    principal = principal_values(stress)
    apart = principal - np.roll(principal, 1, axis=1)
    return np.asarray(np.sqrt(0.5 * np.sum(apart**2, axis=1)))


def _classes(written: dict[str, FloatArray]) -> Classes | None:
    for name, values in written.items():
        if np.isfinite(values).any():
            return Classes.of(name, values)
    return None


def mesh_lines(elements: Elements) -> Iterator[str]:
    """Yield nodes and elements, both numbered from 1."""
    yield "*NODE, NSET=ALL"
    for number, place in enumerate(listed(elements.points), 1):
        yield f"{number}, {row(place)}"
    yield f"*ELEMENT, TYPE={elements.name}, ELSET=ALL"
    for number, corners in enumerate(listed(elements.cells + 1), 1):
        yield f"{number}, " + ", ".join(map(str, corners))


def _materials(
    material: Material, law: str, elements: Elements, classes: Classes | None
) -> Iterator[str]:
    """Yield a material with its section for all elements, or for each class of them."""
    if classes is None:
        yield from _material(material, "METAL", law, "ALL", elements)
        return
    yield f"** classes of {classes.quantity}, width {classes.width:.6g} in SI units"
    for number in np.unique(classes.numbers):
        name = f"{classes.quantity.upper()}_{number + 1}"
        middle = float(classes.middles[number]) if number >= 0 else None
        known = "not known" if middle is None else f"{middle:.6g}"
        yield f"** {name}: {classes.quantity} {known}"
        yield f"*ELSET, ELSET={name}"
        yield from _set(listed(np.flatnonzero(classes.numbers == number) + 1))
        strength = middle if classes.quantity == "yield_strength" else None
        yield from _material(material, f"METAL_{name}", law, name, elements, strength)


def _material(
    material: Material,
    name: str,
    law: str,
    of: str,
    elements: Elements,
    strength: float | None = None,
) -> Iterator[str]:
    yield from material_cards(material, name, law, strength)
    yield f"*SOLID SECTION, ELSET={of}, MATERIAL={name}"
    if elements.model.startswith("plane"):
        yield "1."


def _set(numbers: list[int]) -> Iterator[str]:
    for start in range(0, len(numbers), PER_LINE):
        yield ", ".join(map(str, numbers[start : start + PER_LINE])) + ","


def _state(elements: Elements, temperature: FloatArray) -> Iterator[str]:
    """Yield temperatures of the nodes and stresses of the integration points."""
    yield "*INITIAL CONDITIONS, TYPE=TEMPERATURE"
    for number, value in enumerate(listed(temperature), 1):
        yield f"{number}, {digits(value)}"
    yield "*INITIAL CONDITIONS, TYPE=STRESS"
    for number, of_points in enumerate(listed(elements.stress), 1):
        for point, stress in enumerate(of_points, 1):
            yield f"{number}, {point}, {row(stress)}"


def force_lines(forces: FloatArray, acting: BoolArray) -> Iterator[str]:
    """Yield the forces on the nodes on which some act."""
    if not acting.any():
        return
    yield "*CLOAD"
    for node in listed(np.flatnonzero(acting)):
        for axis, force in enumerate(listed(forces[node]), 1):
            if force:
                yield f"{node + 1}, {axis}, {digits(force)}"


def support_lines(held: Holding) -> Iterator[str]:
    """Yield the conditions that hold a body; those along no axis as equations."""
    oblique: list[tuple[int, list[float]]] = []
    taken: set[tuple[int, int]] = set()
    yield "*BOUNDARY"
    for node, direction in zip(listed(held.nodes), listed(held.directions), strict=True):
        axis = int(np.argmax(np.abs(direction)))
        if abs(direction[axis]) < ALIGNED:
            oblique.append((node, direction))
        elif (node, axis) not in taken:
            taken.add((node, axis))
            yield f"{node + 1}, {axis + 1}, {axis + 1}, 0."
    for node, direction in oblique:
        axes = [a for a in range(3) if abs(direction[a]) > 1.0 - ALIGNED]
        axes.sort(key=partial(_later, (node, direction), taken))
        if (node, axes[0]) in taken:  # held by the planes before
            continue
        taken.add((node, axes[0]))
        yield "*EQUATION"
        yield str(len(axes))
        yield ", ".join(f"{node + 1}, {a + 1}, {digits(direction[a])}" for a in axes)


def _later(
    condition: tuple[int, list[float]], taken: set[tuple[int, int]], axis: int
) -> tuple[bool, float]:
    """Return the order in which an axis may depend on the others of a node: the longest first."""
    node, direction = condition
    return (node, axis) in taken, -abs(direction[axis])


def deck_lines(state: BodyState, included: Sequence[str], held: Holding) -> Iterator[str]:
    """Yield the lines of the deck: included files, supports, and one static step."""
    mesh, materials, fields, forces = included
    yield "*HEADING"
    yield f"{state.name} at {state.moment:.10g} s, castx {__version__}; m, N, Pa, degC"
    for name in (mesh, materials, fields):
        yield f"*INCLUDE, INPUT={name}"
    yield f"** the last {held.minimal} conditions hold rigid motions alone"
    yield from support_lines(held)
    yield from ("*STEP", "*STATIC")
    yield f"*INCLUDE, INPUT={forces}"
    yield from ("*NODE FILE", "U, NT", "*EL FILE", "S", "*NODE PRINT, NSET=ALL", "U")
    yield from ("*EL PRINT, ELSET=ALL", "S", "*END STEP")


def element_rows(
    state: BodyState,
    elements: Elements,
    classes: Classes | None,
    written: dict[str, FloatArray],
) -> Iterator[str]:
    """Yield the rows of the table of exact values by element."""
    columns: dict[str, FloatArray] = {"von_mises": von_mises(elements.stress.mean(axis=1))}
    for name in ("plastic_strain",):
        if state.has(name):
            columns[name] = state.values(name)
    columns |= written
    yield ",".join(["element", "class", *columns])
    numbers = np.zeros(len(elements.cells), dtype=int) if classes is None else classes.numbers + 1
    for index, values in enumerate(zip(*(listed(c) for c in columns.values()), strict=True)):
        yield ",".join([str(index + 1), str(numbers[index]), *(f"{v:.15g}" for v in values)])


def _excess(
    state: BodyState, elements: Elements, material: Material, law: str, classes: Classes | None
) -> tuple[float | None, float, FloatArray]:
    """Return share of elements beyond their yield stress, the largest ratio, and where it is."""
    if not flows(material, law):
        return None, 0.0, np.zeros(3)
    limit = yield_stress(material, state.in_cells("temperature"))
    if classes is not None and classes.quantity == "yield_strength":
        known = classes.numbers >= 0
        limit = np.where(known, classes.middles[classes.numbers], limit)
    count, points = elements.stress.shape[:2]
    equivalent = von_mises(elements.stress.reshape(-1, 6)).reshape(count, points).max(axis=1)
    with np.errstate(divide="ignore"):
        ratio = equivalent / limit
    worst = int(ratio.argmax())
    place = elements.points[elements.cells[worst]].mean(axis=0)
    return float(np.mean(ratio > 1.0)), float(ratio[worst]), place
