"""Exploded view of an assembly."""

from pathlib import Path

import gmsh
import numpy as np
import pyvista

from castx.report.display import display
from demos.parts.assembly import Assembly, faces_by_bodies

COLOURS = ("silver", "steelblue", "cadetblue", "peru", "darkorange", "rosybrown", "slategray")


def draw(
    assembly: Assembly, size: float, file: Path, view: tuple[float, ...] = (1, -1.6, 0.9)
) -> None:
    """Draw a joined assembly with its bodies apart; meshes the faces of the current gmsh model.

    Args:
        assembly: to be drawn.
        size: of the largest triangles, in mm.
        file: picture to be written.
        view: direction from the middle of the assembly to the eye.
    """
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 24)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.model.mesh.generate(2)
    skins = {name: skin(assembly, name) for name in assembly.solids}
    gmsh.model.mesh.clear()
    gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 0)
    with display():
        plotter = pyvista.Plotter(off_screen=True, window_size=[900, 800])
        for number, (name, surface) in enumerate(skins.items()):
            away = surface.translate(assembly.apart.get(name, (0.0, 0.0, 0.0)))
            plotter.add_mesh(away, color=COLOURS[number % len(COLOURS)], smooth_shading=False)
            lines = away.extract_feature_edges(25, boundary_edges=False)
            plotter.add_mesh(lines, color="black", line_width=1.2)
        plotter.camera_position = [view, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)]
        plotter.reset_camera()
        plotter.enable_anti_aliasing("ssaa")
        plotter.screenshot(file)
        plotter.close()


def skin(assembly: Assembly, name: str) -> pyvista.PolyData:
    """Return the triangles round a body."""
    faces = faces_by_bodies(assembly).items()
    tags = [tag for bodies, found in faces if name in bodies for tag in found]
    nodes, coordinates, _ = gmsh.model.mesh.getNodes()
    place = np.zeros(int(nodes.max()) + 1, dtype=np.int64)
    place[nodes.astype(np.int64)] = np.arange(len(nodes))
    triangles = [gmsh.model.mesh.getElementsByType(2, tag)[1].reshape(-1, 3) for tag in tags]
    corners = place[np.concatenate(triangles).astype(np.int64)]
    surface = pyvista.PolyData.from_regular_faces(coordinates.reshape(-1, 3), corners)
    return surface.clean()
