"""Results folders made by hand for the hand-over: one body, one moment, given fields."""

from __future__ import annotations

import json

import numpy as np
import pyvista

from castx.handover.body_state import BodyState
from castx.results.files.vtu import VTK_TENSOR
from castx.results.reading import Results

CELLS = {
    ("3d", 4): pyvista.CellType.TETRA,
    ("3d", 8): pyvista.CellType.HEXAHEDRON,
    ("plane", 3): pyvista.CellType.TRIANGLE,
    ("plane", 4): pyvista.CellType.QUAD,
}
MATERIAL = {
    "density": 2700,
    "heat_capacity": 1000,
    "conductivity": 100,
    "young_modulus": [[20, 70e9], [400, 50e9]],
    "poisson_ratio": 0.33,
    "expansion": [[20, 2.1e-5], [400, 2.4e-5]],
    "expansion_reference": 20,
    "yield_stress": [[20, 100e6], [400, 40e6]],
    "hardening": {"linear": 1e9},
}


def box(corners, divisions=(2, 2, 2), sizes=(0.03, 0.02, 0.01)):
    """Return points and cells of a box, or of a rectangle with 3 or 4 corners in its cells."""
    flat = corners in (3, -4)
    axes = [np.linspace(0.0, size, n + 1) for size, n in zip(sizes, divisions, strict=True)]
    if flat:
        axes[2] = np.zeros(1)
    grid = pyvista.RectilinearGrid(*axes).cast_to_unstructured_grid()
    cells = np.asarray(grid.cell_connectivity).reshape(grid.n_cells, -1)
    cells = cells[:, [0, 1, 3, 2] if flat else [0, 1, 3, 2, 4, 5, 7, 6]]  # of pixels and voxels
    z, y, x = (axis.ravel() for axis in np.meshgrid(*axes[::-1], indexing="ij"))
    points = np.column_stack([x, y, z])  # pyvista's are of single precision
    if corners == 3:
        cells = np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])
    if corners == 4:
        split = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]]
        cells = np.concatenate([cells[:, part] for part in split])
    return points, cells


def made(folder, model, points, cells, nodal=None, cellwise=None, **about):
    """Write a results folder with a body `casting`, and return its state."""
    kind = CELLS["3d" if model == "3d" else "plane", cells.shape[1]]
    grid = pyvista.UnstructuredGrid({kind: cells}, points)
    grid.points = np.asarray(points, dtype=np.float64)
    count = len(points)
    for name, values in (nodal or {"temperature": np.full(count, 20.0)}).items():
        grid.point_data[name] = values
    for name, values in (cellwise or {}).items():
        grid.cell_data[name] = values[:, VTK_TENSOR] if values.shape[1:] == (6,) else values
    (folder / "fields").mkdir(parents=True)
    grid.save(folder / "fields" / "casting_00000_0.vtu")
    (folder / "fields" / "castx.pvd").write_text(
        '<VTKFile type="Collection" version="1.0"><Collection><DataSet timestep="5.0" '
        'group="casting" part="0" file="casting_00000_0.vtu"/></Collection></VTKFile>'
    )
    body = {"material": "metal", "law": "thermo-elastic", "symmetry": [], **about}
    record = {
        "castx": "0", "case": {"name": "made", "file": "made.toml"}, "model": model,
        "bodies": {"casting": body}, "interfaces": {},
        "stage_ends": [{"stage": 1, "cycle": 1, "time": 5.0, "bodies": {}}],
    }  # fmt: skip
    (folder / "run.json").write_text(json.dumps(record))
    (folder / "history.csv").write_text("time,casting.solid_fraction\n0,0.5\n5,1\n")
    (folder / "probes.csv").write_text("time\n0\n5\n")
    case = {
        "geometry": {
            "generator": "slab", "model": "3d", "length": 1, "width": 1, "depth": 1, "size": 1,
        },
        "bodies": [{"name": "casting", "material": "metal", "temperature": 20}],
        "materials": {"metal": MATERIAL},
        "time": {"end": 5},
    }  # fmt: skip
    (folder / "case.json").write_text(json.dumps(case))
    return BodyState(Results(folder), "casting")
