"""A casting in an open mould gives one history: turned in space, mirrored, in another order.

The block comes off its walls, bows and ends on a few pairs, which are the same however it lies, in
whatever order its bodies are named and its nodes are numbered. Reference: the case itself. At
tolerances of rounding a casting that floats between its walls takes the same steps too.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gmsh
import numpy as np
import pytest

from castx.arrays import FloatArray
from castx.materials.flow import VISCOPLASTIC
from castx.meshes.generators.box_in_mould import box_in_mould
from tests.coupled_cases import TIGHT, simulation

pytestmark = pytest.mark.sampled

SHAPES: dict[str, dict[str, Any]] = {
    "plane-strain": {"box": [0.04, 0.03], "wall": 0.02, "size": 0.005},
    "3d": {"box": [0.04, 0.03, 0.03], "wall": 0.015, "size": 0.015},
}
END = {"plane-strain": 30.0, "3d": 16.0}


def about(axis: tuple[float, float, float], angle: float) -> FloatArray:
    """Return the matrix of a rotation."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)


NARROW = {"box": [0.02, 0.05], "wall": 0.02, "size": 0.01}

UNTURNED = np.eye(3)
TURNED = {"plane-strain": about((0, 0, 1), 0.7), "3d": about((1, 2, 0.5), 1.1)}
MIRRORED = np.diag([-1.0, 1.0, 1.0])


def write_mesh(
    comm, path: Path, model: str, shape: dict[str, Any], matrix: FloatArray, renumbered: bool
) -> None:
    """Write the mesh of the case as a matrix places it, with its nodes in another order."""
    if comm.rank == 0:
        gmsh.initialize()
        gmsh.option.setNumber("General.Terminal", 0)
        try:
            box_in_mould(model=model, **shape)
            placed = np.column_stack([matrix, np.zeros(3)])
            gmsh.model.mesh.affineTransform(placed.ravel())
            if np.linalg.det(matrix) < 0:
                gmsh.model.mesh.reverse()
            if renumbered:
                tags = gmsh.model.mesh.getNodes()[0]
                gmsh.model.mesh.renumberNodes(tags, np.random.default_rng(1).permutation(tags))
            gmsh.write(str(path))
        finally:
            gmsh.finalize()
    comm.barrier()


def case_of(path: Path, model: str, matrix: FloatArray, order: list[str]) -> dict[str, Any]:
    """Return the case on its mesh, weighing as it lies."""
    up = matrix @ ([0.0, 0.0, 1.0] if model == "3d" else [0.0, 1.0, 0.0])
    return {
        "geometry": {"file": str(path), "model": model},
        "bodies": [
            {"name": "casting", "material": "AlSi7Mg", "temperature": 650, "law": VISCOPLASTIC},
            {"name": "mould", "material": "steel-H13", "temperature": 200},
        ],
        "interfaces": [
            {"bodies": order,
             "heat": {"law": "limited", "closed": 2000, "gas_conductivity": 0.05}},
        ],
        "boundaries": [{"on": "mould/base", "displacement": {"all": 0}}],
        "loads": {"gravity": [float(g) for g in -9.81 * up]},
        "time": {"end": END[model]},
    }  # fmt: skip


def history(
    comm, folder: Path, model: str, matrix: FloatArray = UNTURNED, *,
    order: tuple[str, str] = ("casting", "mould"), renumbered: bool = False,
    shape: dict[str, Any] | None = None, **changes: Any,
) -> dict[str, FloatArray]:  # fmt: skip
    """Return times, and by place gaps, contact forces and temperatures after each step."""
    path = folder / "placed.msh"
    write_mesh(comm, path, model, shape or SHAPES[model], matrix, renumbered)
    run = simulation(comm, case_of(path, model, matrix, list(order)) | changes)
    d = 3 if model == "3d" else 2
    found: dict[str, list[FloatArray]] = {"time": [], "gap": [], "force": [], "temperature": []}
    for state in run:
        (pairs,) = run.pairs.values()
        # Pairs of one corner, one for each wall, differ by their normals out of the casting.
        outwards = pairs.normals if order[0] == "mould" else -pairs.normals
        points = np.hstack([pairs.points, 1e-4 * outwards]) @ np.kron(np.eye(2), matrix[:d, :d])
        forces = np.linalg.norm(run.problem.states[0].force, axis=1)
        found["time"].append(np.array([state.time]))
        found["gap"].append(by_place(comm, points, state.paired("/".join(order), "gap")))
        found["force"].append(by_place(comm, points, forces))
        nodes = state.mesh.bodies["casting"].nodes
        own = nodes.dofmap.index_map.size_local
        places = nodes.tabulate_dof_coordinates()[:own, :d] @ matrix[:d, :d]
        temperature = state.nodal("casting", "temperature")[:own]
        found["temperature"].append(by_place(comm, places, temperature))
    run.destroy()
    return {name: np.array(values) for name, values in found.items()}


def by_place(comm, points: FloatArray, values: FloatArray) -> FloatArray:
    """Return values of all ranks in an order that only their places decide."""
    points = np.concatenate(comm.allgather(points))
    order = np.lexsort(np.round(points / 1e-6).T)
    return np.concatenate(comm.allgather(values))[order]


@pytest.mark.parametrize("model", SHAPES)
def test_one_history_however_it_lies(comm, shared_tmp_path, model):
    own = history(comm, shared_tmp_path, model)
    others = {
        "turned": history(comm, shared_tmp_path, model, TURNED[model]),
        "mirrored, renumbered, mould first": history(
            comm, shared_tmp_path, model, MIRRORED, order=("mould", "casting"), renumbered=True
        ),
    }
    assert len(own["time"]) > 6
    assert own["gap"][-1].max() > 1e-5 and np.any(own["force"][-1] == 0.0)
    for name, other in others.items():
        for quantity, values in own.items():
            assert values.shape == other[quantity].shape, (name, quantity)
            worst = np.abs(values - other[quantity]).max() / np.abs(values).max()
            assert worst < 1e-3, (name, quantity)


def test_the_same_steps_at_tolerances_of_rounding(comm, shared_tmp_path):
    """Rounding of a place on springs is no pass that fails: nothing is cut because of it.

    A casting that has come off both walls floats between them.
    """
    bodies = [
        {"name": "casting", "material": "Al-pure", "temperature": 690, "law": VISCOPLASTIC},
        {"name": "mould", "material": "steel-H13", "temperature": 200},
    ]
    settings = {"shape": NARROW, "bodies": bodies, "time": {"end": 12.0}, **TIGHT}
    own = history(comm, shared_tmp_path, "plane-strain", **settings)
    turned = history(
        comm, shared_tmp_path, "plane-strain", TURNED["plane-strain"], order=("mould", "casting"),
        renumbered=True, **settings,
    )  # fmt: skip
    np.testing.assert_allclose(turned["time"], own["time"], rtol=1e-9)
    np.testing.assert_array_equal(turned["force"] > 0.0, own["force"] > 0.0)
    np.testing.assert_allclose(turned["gap"], own["gap"], atol=1e-9 * own["gap"].max())
