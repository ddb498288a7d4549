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

from castx.arrays import FloatArray

Image = npt.NDArray[np.uint8]
PIXELS = 900
"""Largest side of a picture."""

SHADING = {"ambient": 0.7, "diffuse": 0.35}
"""Weak, so that colours can be read on faces of any direction."""

NEUTRAL = "#c9ccd1"
EDGE = "#30343a"
FRONT = "#00a0ff"
NICE = (1.0, 2.0, 5.0, 10.0)
VISIBLE_DISPLACEMENT = 0.06
"""Share of the size of the bodies that an exaggerated displacement has at most."""


@dataclass(frozen=True)
class View:
    """The camera, which is the same at all times.

    Args:
        model: of the run; axisymmetric bodies are shown with their mirror image.
        low: lowest corner of what is in view (3,) [m].
        high: highest corner [m].
        cut: whether y < 0 is cut away to show the inside.
        direction: from the bodies to the eye (3,); None: straight at the plane.
    """

    model: str
    low: FloatArray
    high: FloatArray
    cut: bool
    direction: FloatArray | None

    @classmethod
    def of(
        cls, model: str, grids: Iterable[pyvista.UnstructuredGrid], outside: bool = False
    ) -> View:
        """Return the view that shows all bodies.

        Args:
            model: of the run.
            grids: the bodies.
            outside: whether a 3-D model is seen from the side opposite to its planes of symmetry.
        """
        points = np.concatenate([grid.points for grid in grids])
        low, high = points.min(axis=0), points.max(axis=0)
        if model != "3d":
            margin = 0.04 * np.linalg.norm(high - low) * np.array([1.0, 1.0, 0.0])
            if model == "axisymmetric":
                low = low * [0.0, 1.0, 1.0] - high * [1.0, 0.0, 0.0]
            return cls(model, low - margin, high + margin, False, None)
        open_x, open_y = np.abs(low[:2]) < 1e-6 * (high - low)[:2]
        along = {(True, True): (-0.75, -1.0), (True, False): (-1.0, -0.45)}
        direction = np.array([*along.get((bool(open_x), bool(open_y)), (-0.45, -1.0)), 0.55])
        if outside:
            return cls(model, low, high, False, direction * [-1.0, -1.0, 1.0])
        cut = not (open_x or open_y) and low[1] < 0.0 < high[1]
        return cls(model, low, high, cut, direction)

    @property
    def size(self) -> float:
        """Diagonal of what is in view [m]."""
        return float(np.linalg.norm(self.high - self.low))

    def shown(self, grid: pyvista.UnstructuredGrid) -> pyvista.PolyData:
        """Return the surface of a body that is drawn."""
        if self.cut:
            grid = grid.clip("-y", origin=(0.0, 0.0, 0.0))
        surface = grid.extract_surface()
        if self.model == "axisymmetric":
            surface = surface.triangulate()  # pyvista flips triangles only
            mirrored = surface.reflect((1.0, 0.0, 0.0), point=(0.0, 0.0, 0.0))
            mirrored.flip_normals()
            surface = surface.merge(mirrored).clean(tolerance=1e-9)
        return surface

    def window(self) -> tuple[int, int]:
        """Return width and height in pixels."""
        if self.direction is not None:
            return PIXELS, PIXELS
        width, height = (self.high - self.low)[:2]
        scale = PIXELS / max(width, height)
        return max(round(scale * width), 200), max(round(scale * height), 200)

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
    """
    plotter = pyvista.Plotter(off_screen=True, window_size=list(view.window()))
    plotter.background_color = "white"
    flat = view.direction is None
    shown = {"scalars": field, "clim": limits, "cmap": colours, "nan_color": NEUTRAL,
             "show_scalar_bar": False}  # fmt: skip
    for name, grid in grids.items():
        surface = view.shown(deformed(grid, exaggeration))
        style = shown if name in coloured else {"color": NEUTRAL}
        plotter.add_mesh(surface, lighting=not flat, **SHADING, **style)
        add_lines(plotter, outline(surface), EDGE, 2)
        if front and name in coloured and "solid_fraction" in surface.point_data:
            add_lines(plotter, surface.contour([0.5], scalars="solid_fraction"), FRONT, 4)
    view.aim(plotter)
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
    return surface.extract_feature_edges(
        feature_angle=40.0, manifold_edges=False, non_manifold_edges=False
    )


def deformed(grid: pyvista.UnstructuredGrid, factor: float) -> pyvista.UnstructuredGrid:
    """Return a body with its displacements times a factor added to its points."""
    if factor == 0.0 or "displacement" not in grid.point_data:
        return grid
    return grid.warp_by_vector("displacement", factor=factor)


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


def chosen_times(times: Sequence[float]) -> list[float]:
    """Return up to four of the times: the last one, and those nearest to 1/9, 2/9 and 4/9 of it."""
    wanted = [share * times[-1] for share in (1 / 9, 2 / 9, 4 / 9, 1.0)]
    return sorted({min(times, key=lambda time: abs(time - share)) for share in wanted})
