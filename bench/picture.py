"""A picture of one body of a run: its skin with a field at one of the written moments.

    bin/with-fenicsx python3 bench/picture.py results/wheel wheel.png [--body casting]
        [--field temperature] [--time S] [--from X Y Z] [--zoom 1.3]

Shows the cells of the skin, and the colours between the lowest and the highest value there.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyvista

from castx.report.display import display
from castx.report.pictures import outer_faces
from castx.results.reading import Results


def main(arguments: Sequence[str] | None = None) -> None:
    """Draw the picture."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("run", type=Path, help="folder of the run")
    parser.add_argument("file", type=Path, help="picture to be written")
    parser.add_argument("--body", default="casting")
    parser.add_argument("--field", default="temperature")
    parser.add_argument("--time", type=float, help="a written moment [s], the last one by default")
    parser.add_argument("--from", dest="eye", type=float, nargs=3, default=(1.0, -1.6, 0.9))
    parser.add_argument("--zoom", type=float, default=1.0, help="of a body that is wide or deep")
    asked = parser.parse_args(arguments)
    run = Results(asked.run)
    unit = run.units(asked.body, asked.time).get(asked.field, "")
    title = ", ".join(filter(None, (asked.field.replace("_", " "), unit)))
    skin = outer_faces(run.grids(asked.time)[asked.body])
    with display():
        draw(skin, asked.field, title, asked.eye, asked.zoom, asked.file)


def draw(
    skin: pyvista.PolyData,
    field: str,
    title: str,
    eye: Sequence[float],
    zoom: float,
    file: Path,
) -> None:
    """Draw a field on a skin, seen from a direction."""
    plotter = pyvista.Plotter(off_screen=True, window_size=[1000, 680])
    plotter.add_mesh(
        skin, scalars=field, cmap="inferno", show_edges=True, edge_color="#30343a", line_width=0.3,
        edge_opacity=0.4, ambient=0.25, scalar_bar_args={
            "title": title, "color": "black", "n_labels": 4, "fmt": "%.4g", "vertical": True,
            "position_x": 0.88, "position_y": 0.15, "height": 0.7,
        },
    )  # fmt: skip
    plotter.set_background("white")
    middle = np.array(skin.center)
    plotter.camera_position = [middle + np.array(eye), middle, (0.0, 0.0, 1.0)]
    plotter.reset_camera()
    plotter.camera.zoom(zoom)
    plotter.enable_anti_aliasing("ssaa")
    plotter.screenshot(file)
    plotter.close()


if __name__ == "__main__":
    main()
