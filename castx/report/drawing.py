"""A field drawn on its bodies, with axes and colour bar of a figure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import pyvista
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from castx.errors import CaseError
from castx.input.problems import among
from castx.report.display import display
from castx.report.pictures import Image, View, exaggeration, limits_of, picture
from castx.report.style import DOTS_PER_INCH, figure

INCHES, BAR, AXIS = 5.0, 1.6, 0.6
"""Largest side of a picture in a notebook, and room for its colour bar and its axis [inch]."""


@dataclass(frozen=True)
class Drawing:
    """A picture of a field.

    Attributes:
        pixels: colours from 0 to 255, (height, width, 3).
        extent: left, right, lower and upper end of the picture, as `imshow` of matplotlib has them
            [m]; None in space.
        limits: values at the ends of the colours.
        colours: name of the colour map.
        exaggeration: factor on the displacements; 0: bodies are drawn undeformed.
    """

    pixels: Image
    extent: tuple[float, float, float, float] | None
    limits: tuple[float, float]
    colours: str
    exaggeration: float

    def _repr_png_(self) -> bytes:
        """Return the picture with axes and colour bar, as a notebook shows it."""
        height, width = self.pixels.shape[:2]
        scale = INCHES / max(height, width)
        with figure(scale * width + BAR, scale * height + AXIS) as (drawn, stream):
            axes = drawn.add_subplot()
            axes.imshow(self.pixels, extent=self.extent)
            axes.grid(visible=False)
            if self.extent is None:
                axes.set_axis_off()
            else:
                axes.set(xlabel="m", ylabel="m")
            drawn.colorbar(ScalarMappable(Normalize(*self.limits), self.colours), ax=axes)
            drawn.savefig(stream, format="png", dpi=DOTS_PER_INCH)
        return stream.getvalue()


def draw(
    grids: Mapping[str, pyvista.UnstructuredGrid],
    field: str,
    model: str,
    *,
    limits: tuple[float, float] | None = None,
    colours: str = "inferno",
    coloured: Sequence[str] | None = None,
    factor: float | None = None,
) -> Drawing:
    """Draw a field on bodies, deformed visibly.

    >>> import castx
    >>> folder = castx.run("cylinder.toml", ["time.end=0.05", "geometry.size=1e-2"])
    t 0 s  step 0  ...
    >>> results = castx.Results(folder)
    >>> drawing = castx.draw(results.grids(), "temperature", results.model, limits=(200, 670))
    >>> drawing.pixels.shape[2], drawing.limits
    (3, (200, 670))

    A notebook shows it with axes and a colour bar. In a figure of matplotlib it is
    `plt.imshow(drawing.pixels, extent=drawing.extent)`.

    Args:
        grids: the bodies, such as `Results.grids` gives them; fields may be added to them.
        field: name of an array of the points or cells.
        model: of the run; axisymmetric bodies are shown with their mirror image.
        limits: values at the ends of the colours; None: the least and the largest value.
        colours: name of a colour map of matplotlib.
        coloured: bodies that show the field, the others are grey; None: all.
        factor: on the displacements; None: a round one that makes them visible.

    Raises:
        CaseError: no body has the field, or pictures cannot be drawn.
    """
    shown = list(grids) if coloured is None else list(coloured)
    limits = limits or limits_of([grids], field, shown)
    if limits is None:
        known = sorted({name for grid in grids.values() for name in grid.array_names})
        raise CaseError(f"no body has values of {field!r}; {among(field, known)}")
    view = View.of(model, grids.values())
    factor = exaggeration(view, grids) if factor is None else factor
    with display():
        pixels = picture(
            view, grids, field, limits, colours=colours, coloured=shown, exaggeration=factor,
            smooth=True,
        )  # fmt: skip
    (left, lower, _), (right, upper, _) = view.low, view.high
    extent = None if model == "3d" else (float(left), float(right), float(lower), float(upper))
    return Drawing(pixels, extent, limits, colours, factor)
