"""Whole coupled cases as a case file would describe them, and what tests read from their runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from copy import deepcopy
from pathlib import Path
from typing import Any

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.case.reading.read import read_case
from castx.process.simulation import Simulation
from castx.process.state import State

ALUMINIUM = {
    "density": 2700.0,
    "heat_capacity": {"solid": 1080.0, "liquid": 1050.0},
    "conductivity": {"solid": [[20.0, 237.0], [660.0, 210.0]], "liquid": 95.0},
    "latent_heat": 397e3,
    "solidus": 660.0,
    "liquidus": 660.0,
    "young_modulus": [[20.0, 70e9], [660.0, 10e9]],
    "poisson_ratio": 0.33,
    "expansion": 2.4e-5,
}
STEEL = {
    "density": 7800.0,
    "heat_capacity": 460.0,
    "conductivity": 25.0,
    "young_modulus": 210e9,
    "poisson_ratio": 0.3,
    "expansion": 1.2e-5,
}
TIGHT = {
    "coupling": {"tolerance": 1e-11},
    "solver": {"linear": "direct", "mechanics_tolerance": 1e-12, "heat_tolerance": 1e-11},
}
"""Tolerances at which runs are compared to round-off."""


def merged(data: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return a copy of nested tables with the values of `changes` in place of their own."""
    result = deepcopy(dict(data))
    for key, value in changes.items():
        inner = result.get(key)
        if isinstance(inner, Mapping) and isinstance(value, Mapping):
            result[key] = merged(inner, value)
        else:
            result[key] = deepcopy(value)
    return result


def cylinder(*changes: Mapping[str, Any], method: str = "condensed", **geometry: Any) -> dict:
    """Return the aluminium cylinder in a steel mould of V20, a coarse one of own data."""
    data = {
        "geometry": {
            "generator": "cylinder_in_mould", "model": "axisymmetric",
            "radius": 0.03, "height": 0.06, "wall": 0.025, "size": 0.006, **geometry,
        },
        "materials": {"aluminium": ALUMINIUM, "steel": STEEL},
        "bodies": [
            {"name": "casting", "material": "aluminium", "temperature": 670.0},
            {"name": "mould", "material": "steel", "temperature": 200.0,
             "formulation": "displacement"},
        ],
        "interfaces": [
            {"bodies": ["casting", "mould"], "contact": {"method": method},
             "heat": {"law": "limited", "closed": 2300.0, "gas_conductivity": 0.05}},
        ],
        "boundaries": [
            {"on": f"{name}/base", "displacement": {"normal": 0.0}} for name in ("casting", "mould")
        ],
        "time": {"end": 5.0, "first_step": 0.05, "largest_step": 2.0, "smallest_step": 1e-4},
    }  # fmt: skip
    for change in changes:
        data = merged(data, change)
    return data


def ring(*changes: Mapping[str, Any], method: str = "condensed", **geometry: Any) -> dict:
    """Return an aluminium ring that shrinks onto a steel core: contact that closes, with h(p)."""
    data = {
        "geometry": {
            "generator": "core_in_ring", "model": "axisymmetric",
            "core_radius": 0.03, "outer_radius": 0.05, "height": 0.04, "size": 0.005, **geometry,
        },
        "materials": {"aluminium": ALUMINIUM, "steel": STEEL},
        "bodies": [
            {"name": "casting", "material": "aluminium", "temperature": 700.0},
            {"name": "core", "material": "steel", "temperature": 100.0,
             "formulation": "displacement"},
        ],
        "interfaces": [
            {"bodies": ["casting", "core"], "contact": {"method": method},
             "heat": {"law": "limited", "closed": 1500.0, "gas_conductivity": 0.05,
                      "pressure": {"resistance": 2e-4, "hardness": 5e8, "exponent": 0.95}}},
        ],
        "boundaries": [
            {"on": "core/base", "displacement": {"normal": 0.0}},
            {"on": "casting/base", "displacement": {"normal": 0.0}},
            {"on": "casting/outside", "heat": {"type": "convection", "coefficient": 500.0,
                                               "ambient": 30.0}},
        ],
        "time": {"end": 20.0, "first_step": 0.2, "largest_step": 4.0, "smallest_step": 1e-4},
    }  # fmt: skip
    for change in changes:
        data = merged(data, change)
    return data


def simulation(comm: MPI.Intracomm, data: Mapping[str, Any], folder: Path = Path()) -> Simulation:
    """Return the simulation of a case; mesh files are relative to the folder."""
    return Simulation.from_case(read_case(data, folder / "case.toml"), comm)


def states(comm: MPI.Intracomm, data: Mapping[str, Any], folder: Path = Path()) -> Iterator[State]:
    """Yield the states of a run, the initial one first; frees everything behind the last."""
    run = simulation(comm, data, folder)
    yield from run
    run.destroy()


def final_state(comm: MPI.Intracomm, data: Mapping[str, Any], folder: Path = Path()) -> State:
    """Return the last state of a run."""
    *_, last = simulation(comm, data, folder)
    return last


def gone_on(
    comm: MPI.Intracomm, data: Mapping[str, Any]
) -> tuple[list[dict[str, float]], dict[str, float]]:
    """Return the totals of all states of a run, and the last of one restored in its middle."""
    found = [dict(state.totals) for state in states(comm, data)]
    begun = simulation(comm, data)
    for number, _ in enumerate(begun):
        if number == len(found) // 2:
            break
    saved = {name: item.values for name, item in begun.saved().items()}
    goes_on = simulation(comm, data)
    goes_on.restore(saved)
    last: dict[str, float] = {}
    for state in goes_on:
        last = dict(state.totals)
    begun.destroy()
    goes_on.destroy()
    return found, last


def places(state: State, body: str) -> FloatArray:
    """Return the positions of the owned nodes of a body, (owned, gdim)."""
    nodes = state.mesh.bodies[body].nodes
    points = nodes.tabulate_dof_coordinates()[: nodes.dofmap.index_map.size_local]
    return points[:, : state.mesh.parent.geometry.dim]


def ordered(comm: MPI.Intracomm, points: FloatArray, values: FloatArray) -> FloatArray:
    """Return the rows of values of all ranks in an order that only their places decide."""
    points = np.concatenate(comm.allgather(points))
    values = np.concatenate(comm.allgather(values))
    order = np.lexsort(np.round(points / np.abs(points).max(), 7).T)
    return values[order]


def nodal(state: State, body: str, name: str) -> FloatArray:
    """Return a nodal field of all ranks, ordered by place."""
    points = places(state, body)
    return ordered(state.mesh.comm, points, state.nodal(body, name)[: len(points)].copy())


def paired(state: State, interface: str, name: str) -> FloatArray:
    """Return a field of the pairs of all ranks, ordered by place."""
    points = state.pairs[interface].points
    return ordered(state.mesh.comm, points, state.paired(interface, name).copy())


def fields(state: State) -> dict[str, FloatArray]:
    """Return all that V20 and the checks compare, by name, ordered by place."""
    found = {}
    moves = state.problem.mechanics is not None
    for body in state.mesh.bodies:
        for name in ("temperature", "solid_fraction", *(("displacement",) if moves else ())):
            found[f"{body} {name}"] = nodal(state, body, name)
    for interface in state.pairs:
        for name in ("gap", "contact_pressure", "heat_transfer_coefficient"):
            found[f"{interface} {name}"] = paired(state, interface, name)
    return found


def largest_difference(
    a: Mapping[str, FloatArray], b: Mapping[str, FloatArray]
) -> tuple[float, str]:
    """Return the largest difference relative to the largest value of its kind, and the field.

    A kind is the last word of the name: a body that does not move is compared with one that does.
    While all pairs are closed, their gaps are rounding: of a micrometre at least.
    """
    assert a.keys() == b.keys()
    scales: dict[str, float] = {"gap": 1e-6}
    for name in a:
        kind, size = name.split()[-1], float(max(np.abs(a[name]).max(), np.abs(b[name]).max()))
        scales[kind] = max(size, scales.get(kind, 0.0))
    worst = {n: float(np.abs(a[n] - b[n]).max()) / (scales[n.split()[-1]] or 1.0) for n in a}
    name = max(worst, key=worst.__getitem__)
    return worst[name], name


def value_at(state: State, body: str, name: str, *place: float) -> Any:
    """Return a nodal value at the node nearest to a place, on all ranks."""
    comm, points = state.mesh.comm, places(state, body)
    distance = np.linalg.norm(points - np.array(place), axis=1)
    nearest = comm.allgather((float(distance.min(initial=np.inf)), comm.rank))
    here = min(nearest)[1]
    value = state.nodal(body, name)[int(np.argmin(distance))] if comm.rank == here else None
    return comm.bcast(value, root=here)


def pair_value_at(state: State, interface: str, name: str, place: Sequence[float]) -> float:
    """Return a value of the pair nearest to a place, on all ranks."""
    comm, points = state.mesh.comm, state.pairs[interface].points
    distance = np.linalg.norm(points - np.array(place), axis=1)
    nearest = comm.allgather((float(distance.min(initial=np.inf)), comm.rank))
    here = min(nearest)[1]
    value = float(state.paired(interface, name)[np.argmin(distance)]) if comm.rank == here else None
    return comm.bcast(value, root=here)
