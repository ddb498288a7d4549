"""Description of the CAD files to mesh, in metres."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from castx.arrays import FloatArray

MILLIMETRES = 1e3
"""Units of the gmsh model in a metre."""

ROOM = 1.25
"""Margin of the block out of which a shell is cut, in thicknesses of the shell."""
NO_CELLS = 4
"""Exit code of a mesher after `NoCellsError`."""
Vector = tuple[float, float, float]
Box = tuple[Vector, Vector]
"""Lowest and highest corner [m]."""


class NoCellsError(ValueError):
    """Solids that are sound make no mesh of the cells that are wanted; others may make one."""


@dataclass(frozen=True)
class CadFile:
    """A file with solids.

    Args:
        path: of the file.
        body: the body that all its solids make; None: each one is named by its label.
        unit: of the numbers of a BREP file [m]; others carry their own.
    """

    path: str
    body: str | None = None
    unit: float = 1.0 / MILLIMETRES


@dataclass(frozen=True)
class Selector:
    """Conditions for the faces of a named surface; a face must meet all of them.

    Args:
        name: of the surface.
        body: that the faces belong to.
        normal: outward direction, a unit vector.
        angle: largest angle between it and the normals of a face [rad].
        within: box that contains the faces [m].
        touches: body on the other side; None: free faces.
        radius: of curvature, the smaller one [m].
        largest: how many of the remaining faces, by area.
        tolerance: of lengths [m].
    """

    name: str
    body: str | None = None
    normal: Vector | None = None
    angle: float = 0.0
    within: Box | None = None
    touches: str | None = None
    radius: float | None = None
    largest: int | None = None
    tolerance: float = 1e-6


@dataclass(frozen=True)
class SizeRule:
    """A largest size of cells at a place: in a body, on a named surface, or in a box.

    Args:
        size: of the cells [m].
        body: the body.
        surface: the name of the surface.
        within: the box [m].
    """

    size: float
    body: str | None = None
    surface: str | None = None
    within: Box | None = None


@dataclass(frozen=True)
class SizeMap:
    """Sizes of cells over space, linear in tetrahedra such as those of an earlier mesh.

    Args:
        corners: of the tetrahedra, (tetrahedra, 4, 3) [m].
        sizes: at their corners, (tetrahedra, 4) [m].
    """

    corners: FloatArray
    sizes: FloatArray


@dataclass(frozen=True)
class Channel:
    """A cooling channel, drilled through the block of a mould.

    Args:
        name: of the surface of its walls.
        line: corners of its axis, two or more [m].
        diameter: [m].
    """

    name: str
    line: tuple[Vector, ...]
    diameter: float


@dataclass(frozen=True)
class Chill:
    """A chill, a box or a cylinder; the part is cut out of it.

    Args:
        name: of the body.
        box: [m].
        line: the two ends of the axis of a cylinder [m].
        diameter: of the cylinder [m].
    """

    name: str
    box: Box | None = None
    line: tuple[Vector, Vector] | None = None
    diameter: float = 0.0


@dataclass(frozen=True)
class Mould:
    """A block out of which everything else is cut.

    Args:
        name: of its body; of two halves its beginning.
        margin: of the block round all solids [m].
        box: the block, instead of the margin [m].
        split: axis and place of the plane that divides it [m].
        cores: bodies that are cut out of others where they overlap.
        chills: made for it.
        channels: drilled through it.
        plug: body of its pieces that hang at no outer part of it, as inside an open box; None: they
            stay with it, or with the half in which more of them lies.
        shell: distance from the solids up to which the block stays [m]; None: all of it does.
    """

    name: str = "mould"
    margin: float = 0.0
    box: Box | None = None
    split: tuple[int, float] | None = None
    cores: tuple[str, ...] = ()
    chills: tuple[Chill, ...] = ()
    channels: tuple[Channel, ...] = ()
    plug: str | None = None
    shell: float | None = None

    @property
    def room(self) -> float:
        """Distance of the faces of the block from all solids, where no box says it [m]."""
        return max(self.margin, ROOM * (self.shell or 0.0))

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of all bodies that may come of the block."""
        return self.bodies if self.plug is None else (*self.bodies, self.plug)

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of the block's bodies, without a plug."""
        if self.split is None:
            return (self.name,)
        return f"{self.name}-low", f"{self.name}-high"


@dataclass(frozen=True)
class SymmetryPlane:
    """A plane that cuts everything.

    Args:
        axis: of its normal.
        place: on the axis [m].
        above: whether what lies above it stays.
    """

    axis: int
    place: float
    above: bool


@dataclass(frozen=True)
class CadPart:
    """An assembly of CAD solids and how it is meshed.

    Args:
        files: with its solids.
        size: largest element size [m]; infinite: a twelfth of the extent.
        bodies: names that the solids must get; None: whatever they get.
        names: body of a label, where they differ.
        tolerance: gaps and overlaps of solids up to it are closed [m].
        narrowest: faces that are narrower are taken out with what they bound [m].
        selectors: of the named surfaces.
        rest: name of the free faces that no selector has.
        curvature: elements round a full circle.
        across: cells across a wall; 0: as many as the other sizes make. Shells have one at least.
        interface_size: size on faces that two bodies share [m]; None: as elsewhere.
        growth: by how much sizes grow over a distance, as a share of it.
        rules: sizes at places.
        size_map: further sizes, over space.
        most_cells: that a mesh may have.
        mould: made round the solids.
        symmetry: planes that cut everything.
    """

    files: tuple[CadFile, ...]
    size: float
    bodies: tuple[str, ...] | None = None
    names: Mapping[str, str] = field(default_factory=dict)
    tolerance: float = 1e-6
    narrowest: float = 0.0
    selectors: tuple[Selector, ...] = ()
    rest: str = "outside"
    curvature: float = 16.0
    across: float = 2.0
    interface_size: float | None = None
    growth: float = 0.4
    rules: tuple[SizeRule, ...] = ()
    size_map: SizeMap | None = None
    most_cells: float = 2e6
    mould: Mould | None = None
    symmetry: tuple[SymmetryPlane, ...] = ()

    @property
    def shell(self) -> float | None:
        """Thickness of the shell that the mould is [m]; None: there is none, or it is a block."""
        return None if self.mould is None else self.mould.shell
