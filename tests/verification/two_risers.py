"""Mesh of two risers on a runner, which one melt fills, written by hand."""

from __future__ import annotations

from pathlib import Path

import numpy as np

GRID = 10e-3
AREAS = np.array([4 * GRID, GRID])
"""Of the risers, per metre [m²]."""
NAMES = ("wall", "wide", "narrow", "casting")


def volume(narrow: int) -> float:
    """Return the volume of the section per metre [m³], with a narrow riser of so many 10 mm."""
    return len(_squares(narrow)) * GRID**2


def _squares(narrow: int) -> set[tuple[int, int]]:
    """Return the squares of a runner, a riser 50 mm high, and a narrow one."""
    boxes = ((0, 7, 0, 2), (0, 4, 2, 5), (6, 7, 2, narrow))
    return {
        (i, j)
        for left, right, bottom, top in boxes
        for i in range(left, right)
        for j in range(bottom, top)
    }


def write(path: Path, narrow: int) -> None:
    """Write the section as triangles of 10 mm, with surfaces wide, narrow and wall.

    Args:
        path: of the file.
        narrow: height of the narrow riser in 10 mm.
    """
    squares = _squares(narrow)
    corners = sorted({(i + a, j + b) for i, j in squares for a in (0, 1) for b in (0, 1)})
    number = {corner: n for n, corner in enumerate(corners, 1)}
    cells, edges = [], []
    for i, j in sorted(squares):
        a, b, c, d = (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)
        cells += [(a, b, c), (a, c, d)]
        for beside, edge in (((i, j - 1), (a, b)), ((i + 1, j), (b, c)), ((i, j + 1), (c, d)),
                             ((i - 1, j), (d, a))):  # fmt: skip
            if beside not in squares:
                edges.append((_surface(*edge, narrow), edge))
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(NAMES))]
    lines += [f'{2 if name == "casting" else 1} {n} "{name}"' for n, name in enumerate(NAMES, 1)]
    lines += ["$EndPhysicalNames", "$Nodes", str(len(corners))]
    lines += [f"{number[i, j]} {i * GRID} {j * GRID} 0" for i, j in corners]
    lines += ["$EndNodes", "$Elements", str(len(edges) + len(cells))]
    found: list[tuple[int, int, tuple[tuple[int, int], ...]]]
    found = [(1, NAMES.index(name) + 1, edge) for name, edge in edges]
    found += [(2, len(NAMES), cell) for cell in cells]
    for n, (kind, tag, points) in enumerate(found, 1):
        nodes = " ".join(str(number[point]) for point in points)
        lines.append(f"{n} {kind} 2 {tag} {tag} {nodes}")
    path.write_text("\n".join([*lines, "$EndElements", ""]))


def _surface(a: tuple[int, int], b: tuple[int, int], narrow: int) -> str:
    if a[1] == b[1] == 5 and a[0] < 5:
        return "wide"
    return "narrow" if a[1] == b[1] == narrow else "wall"
