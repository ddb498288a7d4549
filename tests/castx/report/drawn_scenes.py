"""What the page draws of a scene, by its own scripts in a browser without a canvas."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyvista

from castx.arrays import FloatArray
from castx.report.page.assets import text
from tests.castx.app.browser import evaluated

DRAW = """
castx.Painter = class {
  batch() { return {}; }
  fill(batch, positions) { batch.positions = positions; }
  begin() {} triangles() {} lines() {}
};
return (async ({ scene, shows, body }) => {
  const view = new castx.View(scene, { clientWidth: 1, clientHeight: 1 }), found = [];
  await view.load();
  const controls = Object.assign(Object.create(castx.Controls.prototype),
    { view, pending: Promise.resolve(), plane: () => controls.cut, tell: () => {}, cut: null });
  await controls.update(true);
  for (const { plane, ...change } of shows) {
    const cuts = plane !== undefined;
    if (cuts) controls.cut = plane;
    await controls.show(change, cuts);
    const { positions } = view.bodies.find((one) => one.name === body).batch;
    found.push(Array.from(positions));
  }
  return found;
})(%s);
"""
SCRIPTS = ("data", "geometry", "camera", "view", "controls")


def drawn(
    scene: Mapping[str, Any], body: str, shows: Sequence[Mapping[str, Any]], folder: Path
) -> list[FloatArray]:
    """Return the triangles of a body after each change of what is shown, (triangles, 3, 3) [m].

    Args:
        scene: of a run.
        body: its name.
        shows: changes of the state of the view; `plane` is a cut, until there is another one.
        folder: for the profile of the browser.
    """
    told = json.dumps({"scene": scene, "shows": list(shows), "body": body})
    scripts = [*(text(f"scripts/{name}.js") for name in SCRIPTS), DRAW % told]
    found = evaluated("\n".join(scripts), folder)
    return [np.array(values).reshape(-1, 3, 3) for values in found]


def area(triangles: FloatArray) -> float:
    """Return the area of triangles (n, 3, 3) [m²]."""
    sides = triangles[:, 1:] - triangles[:, :1]
    return float(0.5 * np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum())


def surface(grid: pyvista.UnstructuredGrid) -> float:
    """Return the area of the surface of a body [m²]."""
    return float(grid.extract_surface().triangulate().area)
