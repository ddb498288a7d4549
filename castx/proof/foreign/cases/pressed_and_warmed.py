"""X10 and X11: blocks that conduct by their pressure, by expansion or pressed unevenly."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.process.state import State
from castx.proof.foreign.blocks import draw_blocks
from castx.proof.foreign.cases.pressed_conductance import ALUMINIUM, HARMONIC, STEEL, ZERO
from castx.proof.foreign.declaration import ForeignCase, Number
from castx.proof.verification.states import (
    cellwise,
    centres,
    drawn_mesh,
    nodal,
    pair_areas,
    paired,
    places,
    states,
)

NAMES = ("steel", "aluminium")
COLD, HOT = 300.0 - ZERO, 800.0 - ZERO
HARDNESS = 2 * 129.0 * 15.0 / (129.0 + 15.0)
"""Of the contact, from those of both metals [Pa]."""
EXPANSION = {"steel": 17.3e-6, "aluminium": 24e-6}

WARMED = {
    2.0: (366.194, 366.223, 303.121e6, 257.045e6), 4.0: (445.282, 445.385, 475.986e6, 397.123e6),
    6.0: (511.536, 511.732, 599.787e6, 548.799e6), 8.0: (561.983, 562.282, 690.931e6, 687.942e6),
    10.0: (599.717, 600.112, 759.564e6, 806.323e6),
}  # fmt: skip
"""By time: exact temperature of the contact and that of the program [K], its von Mises stresses in
the cells at the contact, 0.2 m < y < 0.25 m, of aluminium and steel [Pa]."""
PRESSED = {0.5: (1259.11, 2135.22, 619.88), 1.0: (2518.22, 4270.44, 1239.75)}
"""Mean, largest and smallest contact pressure of the program by time [Pa]."""
CONDUCTED = {
    0.125: (380.476, 383.191, 377.626), 0.5: (578.095, 584.787, 572.463),
    1.0: (670.551, 672.234, 669.294),
}  # fmt: skip
"""Mean, highest and lowest temperature of the aluminium at the contact by time [K]."""


def case(expansion: bool, push: dict[str, Any], end: float, step: float) -> dict[str, Any]:
    """Return the case of a drawn mesh: the steel is pushed on the aluminium.

    Args:
        expansion: whether the metals expand with temperature.
        push: condition on the end of the steel.
        end: of the run [s].
        step: of all steps [s].
    """
    heat = {
        "law": "limited", "closed": 1e-6, "gas_conductivity": 1e-12,
        "pressure": {"resistance": 1 / HARMONIC, "hardness": HARDNESS, "exponent": 1.0},
    }  # fmt: skip
    grown = {"stress_free": COLD, "expansion": 0.0}
    materials = {"steel": STEEL | grown, "aluminium": ALUMINIUM | grown}
    for name in NAMES if expansion else ():
        materials[name]["expansion"] = EXPANSION[name]
    return {
        "geometry": {"file": "mesh.msh", "model": "plane-strain"},
        "materials": materials,
        "bodies": [{"name": n, "material": n, "temperature": COLD, "law": "thermo-elastic",
                    "formulation": "displacement"} for n in NAMES],
        "interfaces": [{"bodies": ["aluminium", "steel"], "heat": heat,
                        "contact": {"pairing": "node-to-face",
                                    "surfaces": ["aluminium-left", "steel-right"]}}],
        "boundaries": [
            {"on": "steel/steel-left", **push, "heat": {"type": "temperature", "value": COLD}},
            {"on": "aluminium/aluminium-right", "displacement": {"normal": 0.0},
             "heat": {"type": "temperature", "value": HOT}},
            *({"on": f"{n}/{n}-bottom", "displacement": {"normal": 0.0}} for n in NAMES),
        ],
        "time": {"end": end, "fixed_step": step, "heat_substeps": 1},
        "coupling": {"tolerance": 1e-6},
        "solver": {"linear": "direct", "mechanics_tolerance": 1e-9, "heat_tolerance": 1e-8},
    }  # fmt: skip


def run(
    comm: MPI.Intracomm, data: dict[str, Any], length: float, cells: tuple[tuple[int, int], ...]
) -> Iterator[tuple[float, State]]:
    """Yield the times and states of a case of two blocks of a length [m] and cells along x, y."""
    edges = (0.0, length, length, 2 * length)
    with drawn_mesh(comm, lambda: draw_blocks(NAMES, edges, 0.5, cells)) as folder:
        for state in states(comm, data, folder):
            yield round(state.time, 6), state


def at_contact(state: State, body: str, length: float) -> FloatArray:
    """Return the temperatures of the nodes of a body at the contact [K]."""
    there = np.isclose(places(state, body)[:, 0], length)
    return np.asarray(nodal(state, body, "temperature")[there] + ZERO)


def warmed(comm: MPI.Intracomm) -> tuple[Number, ...]:
    """Return temperatures and stresses of blocks that are warmed while they are pushed."""
    push = {"displacement": {"normal": [[0.0, 0.0], [10.0, -2e-6]]}}
    numbers = []
    for time, state in run(comm, case(True, push, 10.0, 2.0), 1.0, ((40, 10), (40, 10))):
        if time not in WARMED:
            continue
        exact, kept, *stresses = WARMED[time]
        T = at_contact(state, "aluminium", 1.0).mean()
        numbers.append(Number(f"T of the contact, {time:g} s", kept, T, exact, "K", 2e-4, 500.0))
        for body, stress in zip(("aluminium", "steel"), stresses, strict=True):
            x, y = centres(state, body).T
            cell = (np.abs(x - 1.0) < 0.025) & (y > 0.2) & (y < 0.25)
            found = cellwise(state, body, "von_mises")[cell].mean()
            name = f"von Mises stress in the {body}, {time:g} s"
            numbers.append(Number.relative(name, stress, found, stress, "Pa", 2e-2))
    return tuple(numbers)


def uneven(comm: MPI.Intracomm) -> tuple[Number, ...]:
    """Return pressures and temperatures of blocks that are pressed by 1e4 t y."""
    push = {"pressure": {"formula": "1e4*t*y"}}
    numbers = []
    for time, state in run(comm, case(False, push, 1.0, 0.125), 0.25, ((20, 10), (20, 13))):
        areas = pair_areas(state, "aluminium/steel")
        pressure = paired(state, "aluminium/steel", "contact_pressure")
        mean = float(areas @ pressure / areas.sum())
        if time in PRESSED:
            kept, exact = PRESSED[time][0], 2500.0 * time
            name = f"mean pressure, {time:g} s"
            numbers.append(Number.relative(name, kept, mean, exact, "Pa", 1e-6))
        for name, k, found in (("largest", 1, pressure.max()), ("least", 2, pressure.min())):
            if time in PRESSED:
                kept = PRESSED[time][k]
                numbers.append(Number(f"{name} pressure, {time:g} s", kept, float(found), kept,
                                      "Pa", 0.08, 2500.0 * time))  # fmt: skip
        T = at_contact(state, "aluminium", 0.25)
        means = (("mean", 0, T.mean()), ("highest", 1, T.max()), ("lowest", 2, T.min()))
        for name, k, found in means:
            if time in CONDUCTED:
                kept = CONDUCTED[time][k]
                numbers.append(Number(f"{name} T of the aluminium, {time:g} s", kept, float(found),
                                      kept, "K", 1e-3 if k == 0 else 4e-3, 500.0))  # fmt: skip
    return tuple(numbers)


FOLDER = "modules/combined/test/tests/gap_heat_transfer_mortar/finite-2d/"
CASES = (
    ForeignCase(
        number="X10",
        title="Blocks that expand against each other and conduct by their pressure",
        program="MOOSE",
        path=f"{FOLDER}closed_gap_thermomechanical_mortar_contact.i",
        exact="temperatures: one-dimensional finite elements of small strains; stresses: those of "
        "the program",
        remark="The program strains the blocks by up to 1.2 % in finite strain, castx in small "
        "strain: 0.4 K and 1 % of the stresses.",
        run=warmed,
    ),
    ForeignCase(
        number="X11",
        title="A block pressed unevenly on another one of another mesh",
        program="MOOSE",
        path=f"{FOLDER}varied_pressure_thermomechanical_mortar.i",
        exact="mean pressure: balance of forces, 2500 t; all others: those of the program",
        remark="Pressures differ at the corners, where castx has nodes and the program mortar "
        "segments; by the mean pressure alone the temperature at 0.5 s would be 2 K lower.",
        run=uneven,
    ),
)
