"""Elements of CalculiX: their integration points, and nodal forces of a stress there.

CalculiX computes plane and axisymmetric elements as solid ones: it makes a layer of thickness one,
or a sector of two degrees, of each triangle (a wedge, two points) and quadrilateral (a brick, eight
points), and takes forces and displacements of both faces together (CalculiX CrunchiX User's Manual,
version 2.20, sections on CAX3 to CPS4). Forces of axisymmetric models are those of the full turn.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray, LongArray
from castx.errors import CaseError

SECTOR = np.deg2rad(2.0)
"""Angle of the sector that stands for an axisymmetric element."""
GAUSS = np.array([-1.0, 1.0]) / np.sqrt(3.0)

NAMES = {
    ("3d", 4): "C3D4",
    ("3d", 8): "C3D8",
    ("axisymmetric", 3): "CAX3",
    ("axisymmetric", 4): "CAX4",
    ("plane-strain", 3): "CPE3",
    ("plane-strain", 4): "CPE4",
    ("plane-stress", 3): "CPS3",
    ("plane-stress", 4): "CPS4",
}
MIRRORED = {
    3: ([0, 2, 1], [0]),
    4: ([0, 3, 2, 1], [0, 2, 1, 3]),
    8: ([4, 5, 6, 7, 0, 1, 2, 3], [4, 5, 6, 7, 0, 1, 2, 3]),
}
"""Order of nodes and points that turns a cell over, by number of corners in its model."""
MIRRORED_TETRAHEDRON = ([0, 2, 1, 3], [0])


@dataclass(frozen=True, eq=False)
class Elements:
    """Elements of CalculiX with the stress at their integration points.

    Attributes:
        name: of the kind, such as "C3D4".
        model: geometric model.
        points: positions of the nodes, (nodes, 3) [m].
        cells: their nodes in the order of CalculiX, (cells, corners).
        stress: at the points of CalculiX as xx yy zz xy xz yz, axisymmetric rr zz θθ rz,
            (cells, points, 6) [Pa].
    """

    name: str
    model: str
    points: FloatArray
    cells: LongArray
    stress: FloatArray

    @classmethod
    def of(
        cls, model: str, points: FloatArray, cells: LongArray, stress: FloatArray
    ) -> Elements:
        """Return the elements of cells, turned over where their volume would be negative.

        Args:
            model: geometric model.
            points: positions of the nodes, (nodes, 3) [m].
            cells: nodes in the order of VTK, (cells, corners).
            stress: at the integration points of castx, the first local direction fastest,
                (cells, points, 6) [Pa].

        Raises:
            CaseError: CalculiX has no element for the model or the cells.
        """
        corners = cells.shape[1]
        if (model, corners) not in NAMES:
            known = ", ".join(dict.fromkeys(name for name, _ in NAMES))
            raise CaseError(
                f"CalculiX has no element for cells of {corners} corners in the model {model}; "
                f"models that can be handed over: {known}"
            )
        solid = model == "3d"
        order = MIRRORED_TETRAHEDRON if solid and corners == 4 else MIRRORED[corners]
        turned = _orientation(points, cells, solid) < 0.0
        cells, stress = cells.copy(), stress.copy()
        cells[turned] = cells[turned][:, order[0]]
        stress[turned] = stress[turned][:, order[1]]
        if not solid:  # the same in both layers of points
            stress = np.concatenate([stress, stress], axis=1)
        return cls(NAMES[model, corners], model, points, cells, stress)

    def forces(self) -> tuple[FloatArray, FloatArray]:
        """Return the nodal forces of the stress, and the sums of their sizes over the elements.

        Returns:
            Forces that keep the stress in equilibrium, (nodes, 3) [N], per metre of depth in plane
            models and of the full turn in axisymmetric ones; sums, (nodes,) [N].
        """
        places, faces = self._solid()
        gradients, weights = _gradients(places)
        of_cells = np.einsum(
            "cq,cqij,cqnj->cni", weights, _tensors(self.stress), gradients, optimize=True
        )
        if faces is not None:
            of_cells = faces.together(of_cells)
        forces, sizes = np.zeros((len(self.points), 3)), np.zeros(len(self.points))
        np.add.at(forces, self.cells, of_cells)
        np.add.at(sizes, self.cells, np.linalg.norm(of_cells, axis=2))
        return forces, sizes

    def _solid(self) -> tuple[FloatArray, SolidFaces | None]:
        """Return the places of the nodes of all solid elements, and their two faces if any."""
        places = self.points[self.cells]
        if self.model == "3d":
            return places, None
        faces = SolidFaces(self.model == "axisymmetric")
        return faces.apart(places), faces


@dataclass(frozen=True)
class SolidFaces:
    """The two faces of the solid element that stands for a plane or axisymmetric one.

    Attributes:
        axisymmetric: whether they enclose a sector about the second axis.
    """

    axisymmetric: bool

    def apart(self, places: FloatArray) -> FloatArray:
        """Return the nodes of the first faces, then of the second ones, (cells, 2 corners, 3)."""
        found = []
        for side in (-0.5, 0.5):
            face = places.copy()
            if self.axisymmetric:
                face[..., 0] = places[..., 0] * np.cos(side * SECTOR)
                face[..., 2] = places[..., 0] * np.sin(side * SECTOR)
            else:
                face[..., 2] = side
            found.append(face)
        return np.concatenate(found, axis=1)

    def together(self, forces: FloatArray) -> FloatArray:
        """Return forces on the nodes of both faces (cells, 2 corners, 3) as forces of the model."""
        first, second = np.split(forces, 2, axis=1)
        if not self.axisymmetric:
            both = first + second
            both[..., 2] = 0.0
            return both
        c, s = np.cos(0.5 * SECTOR), np.sin(0.5 * SECTOR)
        found = np.zeros_like(first)
        found[..., 0] = c * (first + second)[..., 0] + s * (second - first)[..., 2]
        found[..., 1] = (first + second)[..., 1]
        return np.asarray(found * (2.0 * np.pi / SECTOR))


def _tensors(stress: FloatArray) -> FloatArray:
    """Return (cells, points, 6) as xx yy zz xy xz yz in matrices, (cells, points, 3, 3)."""
    return stress[..., [[0, 3, 4], [3, 1, 5], [4, 5, 2]]]


def _gradients(places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return gradients of the shape functions at the points, and weights [m³].

    Args:
        places: of the nodes of tetrahedra, wedges or bricks, (cells, nodes, 3).
    """
    slopes, weights = {4: _tetrahedron, 6: _wedge, 8: _brick}[places.shape[1]]()
    jacobian = np.einsum("cni,qnj->cqij", places, slopes)
    inverse = np.linalg.inv(jacobian)
    gradients = np.einsum("qnj,cqji->cqni", slopes, inverse)
    return gradients, np.abs(np.linalg.det(jacobian)) * weights


def _tetrahedron() -> tuple[FloatArray, FloatArray]:
    return np.vstack([-np.ones(3), np.eye(3)])[None], np.array([1.0 / 6.0])


def _wedge() -> tuple[FloatArray, FloatArray]:
    plane = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
    slopes = [
        np.vstack([
            np.column_stack([0.5 * (1.0 + side * z) * plane, np.full(3, side / 6.0)])
            for side in (-1.0, 1.0)
        ])
        for z in GAUSS
    ]  # fmt: skip
    return np.array(slopes), np.full(2, 0.5)


def _brick() -> tuple[FloatArray, FloatArray]:
    signs = np.array([
        [-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1],
        [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1],
    ], dtype=np.float64)  # fmt: skip
    z, y, x = (axis.ravel() for axis in np.meshgrid(GAUSS, GAUSS, GAUSS, indexing="ij"))
    values = 1.0 + signs * np.column_stack([x, y, z])[:, None]
    slopes = np.stack([
        signs[:, axis] * values[..., others[0]] * values[..., others[1]] / 8.0
        for axis, others in enumerate(([1, 2], [0, 2], [0, 1]))
    ], axis=-1)  # fmt: skip
    return slopes, np.ones(8)


def _orientation(points: FloatArray, cells: LongArray, solid: bool) -> FloatArray:
    """Return the signed volumes of the first corners of cells, up to a factor, (cells,)."""
    last = {4: 3, 8: 4}[cells.shape[1]] if solid else 0
    edges = points[cells] - points[cells[:, :1]]
    side = 3 if cells.shape[1] == 8 or (not solid and cells.shape[1] == 4) else 2
    normal = np.cross(edges[:, 1], edges[:, side])
    if not solid:
        return np.asarray(normal[:, 2], dtype=np.float64)
    return np.asarray(np.einsum("ci,ci->c", normal, edges[:, last]), dtype=np.float64)
