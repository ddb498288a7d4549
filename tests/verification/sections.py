"""Meshes of sections that are made of squares, written by hand."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

Box = tuple[int, int, int, int]
"""First and last column, and first and last row, in squares; the last ones are not in it."""
Corner = tuple[int, int]


def squares_of(boxes: Sequence[Box]) -> set[Corner]:
    """Return the squares of some boxes by their lower left corners."""
    return {
        (i, j)
        for left, right, bottom, top in boxes
        for i in range(left, right)
        for j in range(bottom, top)
    }


def write_section(
    path: Path,
    boxes: Sequence[Box],
    grid: float,
    surfaces: Sequence[str],
    surface: Callable[[Corner, Corner], str],
) -> None:
    """Write a section as triangles, two in a square, of a body `casting`.

    Args:
        path: of the file.
        boxes: of which it is made.
        grid: side of a square [m].
        surfaces: names of the surfaces.
        surface: returns the name of the one on which an edge lies.
    """
    squares, names = squares_of(boxes), [*surfaces, "casting"]
    corners = sorted({(i + a, j + b) for i, j in squares for a in (0, 1) for b in (0, 1)})
    number = {corner: n for n, corner in enumerate(corners, 1)}
    cells, edges = [], []
    for i, j in sorted(squares):
        a, b, c, d = (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)
        cells += [(a, b, c), (a, c, d)]
        for beside, edge in (((i, j - 1), (a, b)), ((i + 1, j), (b, c)), ((i, j + 1), (c, d)),
                             ((i - 1, j), (d, a))):  # fmt: skip
            if beside not in squares:
                edges.append((surface(*edge), edge))
    lines = ["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names))]
    lines += [f'{2 if name == "casting" else 1} {n} "{name}"' for n, name in enumerate(names, 1)]
    lines += ["$EndPhysicalNames", "$Nodes", str(len(corners))]
    lines += [f"{number[i, j]} {i * grid} {j * grid} 0" for i, j in corners]
    lines += ["$EndNodes", "$Elements", str(len(edges) + len(cells))]
    found: list[tuple[int, int, tuple[Corner, ...]]]
    found = [(1, names.index(name) + 1, edge) for name, edge in edges]
    found += [(2, len(names), cell) for cell in cells]
    for n, (kind, tag, points) in enumerate(found, 1):
        nodes = " ".join(str(number[point]) for point in points)
        lines.append(f"{n} {kind} 2 {tag} {tag} {nodes}")
    path.write_text("\n".join([*lines, "$EndElements", ""]))
