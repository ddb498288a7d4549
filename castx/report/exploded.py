"""The exploded view of a case: bodies on the left, their surfaces and interfaces on the right."""

from __future__ import annotations

import colorsys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pyvista
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.patches import Patch
from matplotlib.patheffects import Normal, Stroke
from matplotlib.transforms import BboxBase

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.report.display import display
from castx.report.pictures import EDGE, NEUTRAL, SHADING, Image, add_lines, outline
from castx.report.shells import Shell
from castx.report.spread import shifts
from castx.report.style import figure

FORMATS = (".png", ".svg", ".pdf")
WIDTH = 10.0
"""Of the figure [inch]."""
DOTS_PER_INCH = 100
PIXELS = 700
"""Largest side of one view."""
EYE = (-0.45, -1.0, 0.55)
"""Direction from the bodies to the eye; the second view is from the opposite one."""
PASSABLE = "/outside"
"""End of the names of surfaces that nobody has chosen."""
OPACITY = 0.25
MARGIN = 1.03
"""Size of a view over that of what is in it."""
LINE = 10
"""Height of the name of a mark [point]."""
LONG = 34
"""Characters of a name beyond which the columns of the legend are fewer."""
PERMANENT = [i for i in (*range(0, 20, 2), *range(1, 20, 2)) if i // 2 != 7]
"""matplotlib's colours tab20 but for its greys, the strong ones first."""
GOLDEN = 0.618034
"""Of a circle of hues, from each further colour to the next."""


@dataclass(frozen=True)
class Mark:
    """A probe of the case, drawn over the surfaces.

    Attributes:
        name: beside it.
        body: that it is moved with.
        at: coordinates as the case gives them, two or three [m].
    """

    name: str
    body: str
    at: Sequence[float]


@dataclass(frozen=True)
class Paint:
    """The colours of the names on one side of the figure.

    Attributes:
        title: above it.
        colours: by name.
        glassy: whether what lies behind surfaces that nobody has chosen shows through.
    """

    title: str
    colours: dict[str, str]
    glassy: bool = False

    def opacity(self, name: str) -> float:
        """Return the opacity of a surface."""
        return OPACITY if self.glassy and name.endswith(PASSABLE) else 1.0


def colours(count: int) -> list[str]:
    """Return colours, each different from all others."""
    table = [to_hex(mpl.colormaps["tab20"](index)) for index in PERMANENT]
    more = range(max(count - len(table), 0))
    further = [colorsys.hsv_to_rgb((GOLDEN * i) % 1.0, 0.55, 0.5 + 0.4 * (i % 3) / 2) for i in more]
    return [*table, *(to_hex(colour) for colour in further)][:count]


def paints(shells: Sequence[Shell], flat: bool) -> tuple[Paint, Paint]:
    """Return the colours of bodies, surfaces and interfaces.

    Args:
        shells: the bodies.
        flat: whether they lie in a plane, where surfaces are lines.
    """
    bodies = [shell.body for shell in shells]
    skins = list(dict.fromkeys(name for shell in shells for name in shell.skins))
    skins.sort(key=lambda name: name.endswith(PASSABLE))
    found = colours(len(bodies) + len(skins))
    of_bodies = dict(zip(bodies, found, strict=False))
    of_skins = dict(zip(skins, found[len(bodies) :], strict=True))
    return Paint("bodies", of_bodies), Paint("surfaces and interfaces", of_skins, not flat)


def refuse_format(file: Path) -> None:
    """Refuse the name of a picture that cannot be written.

    Raises:
        CaseError: with the formats.
    """
    if file.suffix.lower() not in FORMATS:
        raise CaseError(f"cannot draw {file}: the name must end in {', '.join(FORMATS)}")


def write_picture(
    shells: Sequence[Shell], flat: bool, file: Path, marks: Sequence[Mark] = ()
) -> None:
    """Draw bodies apart from each other, in space from two sides, and write them as a file.

    Args:
        shells: the bodies.
        flat: whether they lie in a plane.
        file: PNG, SVG or PDF.
        marks: probes to show on the side of the surfaces, in front of all that hides them.

    Raises:
        CaseError: the file has another end or cannot be written, or pictures cannot be drawn.
    """
    refuse_format(file)
    sides = paints(shells, flat)
    with display():
        rows = [[_view(shells, paint, eye, marks) for paint in sides] for eye in _eyes(flat)]
    entries = [_columns(paint) for paint in sides]
    lines = max(-(-len(paint.colours) // n) for paint, n in zip(sides, entries, strict=True))
    tall = sum(left.image.shape[0] / left.image.shape[1] for left, _ in rows)
    with figure(WIDTH, 0.5 * WIDTH * tall + 0.6 + 0.22 * lines) as (canvas, _):
        axes = canvas.subplots(len(rows), 2, squeeze=False)
        for axis, view in zip(axes.ravel(), [view for row in rows for view in row], strict=True):
            axis.imshow(view.image)
            axis.axis("off")
        canvas.draw_without_rendering()  # names of marks need to know how large views are
        for axis, (_, view) in zip(axes[:, 1], rows, strict=True):
            _show_marks(axis, marks, view.marks)
        for axis, paint, columns, place in zip(axes[0], sides, entries, ("left", "right"),
                                               strict=True):  # fmt: skip
            axis.set_title(paint.title)
            patches = [
                Patch(color=colour, alpha=paint.opacity(name), label=name)
                for name, colour in paint.colours.items()
            ]
            canvas.legend(handles=patches, loc=f"outside lower {place}", ncols=columns,
                          fontsize=8, frameon=False)  # fmt: skip
        try:
            canvas.savefig(file, dpi=DOTS_PER_INCH)
        except OSError as error:
            raise CaseError(f"cannot write {file}: {error.strerror}") from None


def _show_marks(axis: Axes, marks: Sequence[Mark], places: FloatArray) -> None:
    """Draw probes with their names over a view, at places in pixels (marks, 2).

    A name that would cover another one stands as many lines higher as it has to.
    """
    around = [Stroke(linewidth=3, foreground="white"), Normal()]
    taken: list[BboxBase] = []
    for index, mark in enumerate(marks):
        x, y = float(places[index, 0]), float(places[index, 1])
        axis.plot(x, y, "o", color="black", markersize=5, path_effects=around, scalex=False,
                  scaley=False)  # fmt: skip
        text = axis.annotate(mark.name, (x, y), (5, 4), textcoords="offset points", fontsize=8,
                             path_effects=around, annotation_clip=False)  # fmt: skip
        for line in range(len(marks)):
            text.set_position((5, 4 + LINE * line))
            if not any(text.get_window_extent().overlaps(other) for other in taken):
                break
        taken.append(text.get_window_extent())


def _columns(paint: Paint) -> int:
    longest = max(len(name) for name in paint.colours)
    return 1 if longest > LONG else 2


def _eyes(flat: bool) -> list[FloatArray]:
    if flat:
        return [np.array([0.0, 0.0, 1.0])]
    eye = np.array(EYE) / np.linalg.norm(EYE)
    return [eye, -eye]


def _screen(eye: FloatArray) -> FloatArray:
    """Return the unit vectors to the right and upwards on the picture."""
    upright = np.array([0.0, 1.0, 0.0] if abs(eye[2]) == 1.0 else [0.0, 0.0, 1.0])
    right = np.cross(upright, eye)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(eye, right)])


@dataclass(frozen=True)
class _View:
    """A picture of all bodies, and where the marks are in it, in pixels (marks, 2)."""

    image: Image
    marks: FloatArray


def _view(shells: Sequence[Shell], paint: Paint, eye: FloatArray, marks: Sequence[Mark]) -> _View:
    """Return the picture of all bodies from one side."""
    screen, flat = _screen(eye), abs(eye[2]) == 1.0
    axes = np.eye(3)[: 2 if flat else 3][::-1]  # upwards before sidewards
    moved = shifts([shell.points for shell in shells], screen, np.concatenate([axes, -axes]))
    points = np.concatenate([shell.points + moved[i] for i, shell in enumerate(shells)])
    plotter = pyvista.Plotter(off_screen=True, window_size=_window(points @ screen.T))
    plotter.background_color = "white"
    for index, shell in enumerate(shells):
        _add(plotter, shell, moved[index], paint, flat)
    _aim(plotter, points, screen, eye)
    plotter.renderer.enable_depth_peeling()
    plotter.enable_anti_aliasing("ssaa")
    image = plotter.screenshot(return_img=True)
    dots = _pixels(plotter, points @ screen.T, _moved(marks, shells, moved) @ screen.T)
    plotter.close()
    return _View(np.asarray(image), dots)


def _moved(marks: Sequence[Mark], shells: Sequence[Shell], shifts: FloatArray) -> FloatArray:
    """Return where marks are when their bodies are apart (marks, 3)."""
    order = [shell.body for shell in shells]
    found = np.zeros((len(marks), 3))
    for place, mark in zip(found, marks, strict=True):
        place[: len(mark.at)] = mark.at
        place += shifts[order.index(mark.body)]
    return found


def _pixels(plotter: pyvista.Plotter, shown: FloatArray, places: FloatArray) -> FloatArray:
    """Return where places on the screen are in a picture that shows just some others (n, 2)."""
    width, height = plotter.window_size
    scale = 0.5 * height / plotter.camera.parallel_scale
    middle = 0.5 * (shown.min(axis=0) + shown.max(axis=0))
    return np.asarray(np.array([width, height]) / 2.0 + (places - middle) * [scale, -scale])


def _window(places: FloatArray) -> list[int]:
    """Return width and height in pixels of a picture of points on the screen (points, 2)."""
    sides = np.ptp(places, axis=0)
    return [max(round(PIXELS * side / sides.max()), PIXELS // 4) for side in sides]


def _add(
    plotter: pyvista.Plotter, shell: Shell, shift: FloatArray, paint: Paint, flat: bool
) -> None:
    """Draw a body in its colour, or its surfaces in theirs if these are what is painted."""
    body = _polygons(shell.filled + shift)
    light = {**SHADING, "lighting": not flat}
    if shell.body in paint.colours:
        plotter.add_mesh(body, color=paint.colours[shell.body], **light)
    elif flat:
        plotter.add_mesh(body, color=NEUTRAL, **light)
    add_lines(plotter, outline(body), EDGE, 1)
    for name, corners in shell.skins.items():
        if name not in paint.colours:
            continue
        style = {"color": paint.colours[name], "opacity": paint.opacity(name), **light}
        plotter.add_mesh(_polygons(corners + shift), line_width=6, **style)


def _polygons(corners: FloatArray) -> pyvista.PolyData:
    """Return polygons or, of two corners each, lines."""
    facets, count = corners.shape[:2]
    numbers = np.arange(facets * count).reshape(-1, count)
    listed = np.column_stack([np.full(facets, count), numbers]).ravel()
    points = corners.reshape(-1, 3)
    polygons: pyvista.PolyData
    if count == 2:
        polygons = pyvista.PolyData(points, lines=listed).clean()
        return polygons
    # Facets come in both directions of turning, between which an edge would be seen.
    polygons = pyvista.PolyData(points, faces=listed).clean()
    polygons = polygons.compute_normals(point_normals=False, consistent_normals=True)
    return polygons


def _aim(plotter: pyvista.Plotter, points: FloatArray, screen: FloatArray, eye: FloatArray) -> None:
    """Let the picture show just all points."""
    frame = np.concatenate([screen, eye[None, :]])
    low, high = (points @ frame.T).min(axis=0), (points @ frame.T).max(axis=0)
    centre = 0.5 * (low + high) @ frame
    plotter.camera.enable_parallel_projection()
    plotter.camera.focal_point = centre
    plotter.camera.position = centre + 2.0 * np.linalg.norm(high - low) * eye
    plotter.camera.up = screen[1]
    width, height = plotter.window_size
    sides = high - low
    plotter.camera.parallel_scale = 0.5 * MARGIN * max(sides[1], sides[0] * height / width)
    plotter.reset_camera_clipping_range()
