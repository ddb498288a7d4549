"""Pictures of written fields, drawn off-screen with pyvista.

They are drawn inside `castx.report.display.display()`, as arrays of pixels (height, width, 3)
without a colour bar.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pyvista
from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter

from castx.arrays import FloatArray
from castx.results.sunk_shape import drawn_body

Image = npt.NDArray[np.uint8]
PIXELS = 900
"""Largest side of a picture."""

SHADING = {"ambient": 0.7, "diffuse": 0.35}
"""Weak, so that colours can be read on faces of any direction."""

NEUTRAL = "#c9ccd1"
EDGE = "#30343a"
FRONT = "#00a0ff"
ROUNDING = 1e-9
NICE = (1.0, 2.0, 5.0, 10.0)
SLENDER = 200 / 900
"""Least ratio of the sides of a picture: what is longer has white beside it."""
VISIBLE_DISPLACEMENT = 0.06
"""Share of the size of the bodies that an exaggerated displacement has at most."""


@dataclass(frozen=True)
class View:
    """The camera, which is the same at all times.

    Args:
        model: of the run; axisymmetric bodies are shown with their mirror image.
        low: lowest corner of what is in view (3,) [m].
        high: highest corner [m].
        cut: place of a plane whose side towards smaller y is cut away to show the inside [m]; None:
            nothing is.
        direction: from the bodies to the eye (3,); None: straight at the plane.
        pixels: largest side of a picture.
    """

    model: str
    low: FloatArray
    high: FloatArray
    cut: float | None
    direction: FloatArray | None
    pixels: int = PIXELS

    @classmethod
    def of(
        cls,
        model: str,
        grids: Iterable[pyvista.UnstructuredGrid],
        outside: bool = False,
        castings: Iterable[pyvista.UnstructuredGrid] = (),
    ) -> View:
        """Return the view that shows all bodies.

        A 3-D model is cut through the middle of its castings, which is their plane of symmetry if
        they have one, wherever they lie. If they show at a side of the whole, as those of a half or
        a quarter do, they are seen from there instead.

        Args:
            model: of the run.
            grids: the bodies.
            outside: whether a 3-D model is seen from the side opposite to its planes of symmetry.
            castings: the bodies that matter; none: the smallest of several.
        """
        boxes = [box(grid) for grid in grids]
        low, high = merged(boxes)
        inner = merged([box(grid) for grid in castings] or [min(boxes, key=diagonal)])
        if model != "3d":
            margin = 0.04 * np.linalg.norm(high - low) * np.array([1.0, 1.0, 0.0])
            if model == "axisymmetric":
                low = low * [0.0, 1.0, 1.0] - high * [1.0, 0.0, 0.0]
            low, high = low - margin, high + margin
            sides = high - low
            lacking = np.maximum(SLENDER * sides.max() - sides, 0.0) * [0.5, 0.5, 0.0]
            return cls(model, low - lacking, high + lacking, None, None)
        shows = np.abs(inner[0] - low)[:2] < 1e-6 * (high - low)[:2]
        open_x, open_y = shows & (len(boxes) > 1)
        along = {(True, True): (-0.75, -1.0), (True, False): (-1.0, -0.45)}
        direction = np.array([*along.get((bool(open_x), bool(open_y)), (-0.45, -1.0)), 0.55])
        if outside:
            return cls(model, low, high, None, direction * [-1.0, -1.0, 1.0])
        middle = float(0.5 * (inner[0] + inner[1])[1])
        return cls(model, low, high, None if open_x or open_y else middle, direction)

    @property
    def size(self) -> float:
        """Diagonal of the visible bodies [m]."""
        return float(np.linalg.norm(self.high - self.low))

    def shown(self, grid: pyvista.UnstructuredGrid) -> pyvista.PolyData:
        """Return the surface of a body that is drawn."""
        if self.cut is not None:
            grid = grid.clip("-y", origin=(0.0, self.cut, 0.0))
        surface = outer_faces(grid)
        if self.model == "axisymmetric":
            surface = surface.triangulate()
            mirrored = surface.reflect((1.0, 0.0, 0.0), point=(0.0, 0.0, 0.0))
            mirrored.regular_faces = mirrored.regular_faces[:, ::-1]  # a mirror turns them over
            surface = surface.merge(mirrored).clean(tolerance=1e-9)
        return surface

    def window(self) -> tuple[int, int]:
        """Return width and height in pixels."""
        if self.direction is not None:
            return self.pixels, self.pixels
        width, height = (self.high - self.low)[:2]
        scale = self.pixels / max(width, height)
        return round(scale * width), round(scale * height)

    def aim(self, plotter: pyvista.Plotter) -> None:
        """Point the camera."""
        centre = 0.5 * (self.low + self.high)
        plotter.camera.enable_parallel_projection()
        plotter.camera.focal_point = centre
        if self.direction is None:
            plotter.camera.position = centre + np.array([0.0, 0.0, self.size])
            plotter.camera.up = (0.0, 1.0, 0.0)
            plotter.camera.parallel_scale = 0.5 * (self.high - self.low)[1]
        else:
            plotter.camera.position = centre + 2.0 * self.size * self.direction
            plotter.camera.up = (0.0, 0.0, 1.0)
            plotter.camera.parallel_scale = 0.52 * self.size
        plotter.reset_camera_clipping_range()


Box = tuple[FloatArray, FloatArray]
"""Lowest and highest corner, (3,) each [m]."""


def outer_faces(grid: pyvista.UnstructuredGrid) -> pyvista.PolyData:
    """Return the faces of one cell only by VTK itself; pyvista has renamed its function."""
    faces = vtkGeometryFilter()
    faces.SetInputData(grid)
    faces.Update()
    return pyvista.PolyData(faces.GetOutput())


def box(grid: pyvista.UnstructuredGrid) -> Box:
    """Return the box round a body."""
    points = np.asarray(grid.points, dtype=np.float64)
    return points.min(axis=0), points.max(axis=0)


def merged(boxes: Sequence[Box]) -> Box:
    """Return the box round all boxes."""
    return np.min([low for low, _ in boxes], axis=0), np.max([high for _, high in boxes], axis=0)


def diagonal(of: Box) -> float:
    """Return the diagonal of a box [m]."""
    return float(np.linalg.norm(of[1] - of[0]))


@dataclass(frozen=True)
class Scale:
    """Colours of values.

    Attributes:
        limits: values at the ends of the colours.
        colours: name of the colour map.
        bodies: that are shown so.
    """

    limits: tuple[float, float]
    colours: str
    bodies: tuple[str, ...]


def picture(
    view: View,
    grids: Mapping[str, pyvista.UnstructuredGrid],
    field: str,
    limits: tuple[float, float],
    *,
    colours: str,
    coloured: Sequence[str],
    front: bool = False,
    exaggeration: float = 0.0,
    beside: Scale | None = None,
    smooth: bool = False,
) -> Image:
    """Return a picture of a field on bodies.

    Args:
        view: where from.
        grids: the bodies.
        field: array of points or cells.
        limits: values at the ends of the colours.
        colours: name of the colour map.
        coloured: bodies that show the field; the others are grey.
        front: draw the line f_s = 0.5.
        exaggeration: factor on the displacements; 0: undeformed.
        beside: colours of other bodies, such as moulds beside a casting.
        smooth: smooth the stairs of lines, at the cost of twice the time; a picture that is shown
            smaller than it is drawn does without.
    """
    scales = [Scale(limits, colours, tuple(coloured)), *([] if beside is None else [beside])]
    scale_of = {name: scale for scale in reversed(scales) for name in scale.bodies}
    plotter = pyvista.Plotter(off_screen=True, window_size=list(view.window()))
    plotter.background_color = "white"
    flat = view.direction is None
    edges, fronts = [], []
    for name, grid in grids.items():
        surface = view.shown(deformed(drawn_body(grid, view.model, field), exaggeration))
        if surface.n_cells == 0:  # the cut has taken it away
            continue
        scale = scale_of.get(name)
        if scale is None or field not in grid.array_names:
            style: dict[str, object] = {"color": NEUTRAL}
        else:
            style = {"scalars": field, "clim": scale.limits, "cmap": scale.colours,
                     "nan_color": NEUTRAL, "show_scalar_bar": False}  # fmt: skip
        plotter.add_mesh(surface, lighting=not flat, **SHADING, **style)
        edges.append(outline(surface))
        if front and name in coloured and "solid_fraction" in surface.point_data:
            fronts.append(surface.contour([0.5], scalars="solid_fraction"))
    for lines, colour, width in ((edges, EDGE, 2), (fronts, FRONT, 4)):
        if lines:  # all at once: what pyvista adds costs more than what it draws
            add_lines(plotter, pyvista.merge(lines), colour, width)
    view.aim(plotter)
    if smooth:
        plotter.enable_anti_aliasing("ssaa")
    image = plotter.screenshot(return_img=True)
    plotter.close()
    return np.asarray(image)


def add_lines(plotter: pyvista.Plotter, lines: pyvista.PolyData, colour: str, width: int) -> None:
    """Add lines to a picture, unless there are none.

    Args:
        plotter: of the picture.
        lines: their points and segments.
        colour: as matplotlib names it.
        width: of the lines [pixels].
    """
    if lines.n_points > 0:
        plotter.add_mesh(lines, color=colour, line_width=width, lighting=False)


def outline(surface: pyvista.PolyData) -> pyvista.PolyData:
    """Return the boundary and the sharp edges of a surface."""
    edges: pyvista.PolyData = surface.extract_feature_edges(
        feature_angle=40.0, manifold_edges=False, non_manifold_edges=False
    )
    return edges


def deformed(grid: pyvista.UnstructuredGrid, factor: float) -> pyvista.UnstructuredGrid:
    """Return a body with its displacements times a factor added to its points."""
    if factor == 0.0 or "displacement" not in grid.point_data:
        return grid
    moved: pyvista.UnstructuredGrid = grid.warp_by_vector("displacement", factor=factor)
    return moved


def exaggeration(view: View, grids: Mapping[str, pyvista.UnstructuredGrid]) -> float:
    """Return a round factor that makes the displacements visible; 0: there are none.

    Args:
        view: the camera, whose size counts.
        grids: the bodies.
    """
    largest = max(
        (
            float(np.linalg.norm(grid["displacement"], axis=1).max())
            for grid in grids.values()
            if "displacement" in grid.point_data
        ),
        default=0.0,
    )
    if largest <= 1e-12 * view.size:
        return 0.0
    wanted = VISIBLE_DISPLACEMENT * view.size / largest
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(max(nice * power for nice in NICE if nice * power <= wanted * (1.0 + 1e-9)))


def limits_of(
    states: Sequence[Mapping[str, pyvista.UnstructuredGrid]],
    field: str,
    bodies: Sequence[str],
    share: float = 1.0,
) -> tuple[float, float] | None:
    """Return the smallest and the largest value of a field, None where there is none.

    Args:
        states: the bodies at some times.
        field: array of points or cells.
        bodies: names of those that count.
        share: of the values that count; the largest ones beyond it are left out.
    """
    grids = [state[name] for state in states for name in bodies if name in state]
    values = [grid[field] for grid in grids if field in grid.array_names]
    found = np.concatenate([np.empty(0), *(array[np.isfinite(array)] for array in values)])
    if found.size == 0:
        return None
    return float(found.min()), float(np.quantile(found, share))


def chosen_times(times: Sequence[float], moments: Mapping[float, str]) -> dict[float, str]:
    """Return the first times after some moments with their events; the last time always.

    Args:
        times: at which there are fields, ascending [s].
        moments: what happens, by its time [s].
    """
    found: dict[float, list[str]] = {}
    for moment, what in sorted(moments.items()):
        after = [time for time in times if time >= moment * (1.0 - ROUNDING)]
        found.setdefault(min(after, default=times[-1]), []).append(what)
    found.setdefault(times[-1], [])
    return {time: ", ".join(found[time]) for time in sorted(found)}
