"""Sizes of cells over space: by walls, curvature, interfaces and places, growing from there.

A first mesh of the faces, as coarse as allowed, samples them. Each sample gets the least of the
sizes that its place asks for; away from it sizes grow in proportion to the distance. gmsh gets them
on a regular grid.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import ceil

import gmsh
import numpy as np

from castx.arrays import FloatArray, LongArray
from castx.meshes.cad.cells import TRIANGLE, corners_of, node_points
from castx.meshes.cad.curvature import FILLING, curved_triangles
from castx.meshes.cad.description import MILLIMETRES, CadPart, SizeRule
from castx.meshes.cad.faces import Face

OPPOSITE = -0.5
"""Cosine between the normals of the two sides of a wall; they enclose at most 60°."""
ON_EDGE = 1e-6
"""Share of a triangle beyond its edges that still belongs to it."""
CHUNK = 256
"""Samples that are compared with all others at a time."""
MOST = 3000
"""Samples behind which walls are looked for."""
MOST_PAIRS = 6e7
"""Of such samples with all others."""
STEPS = 64
"""Of the grid of sizes along the longest extent, at most."""


@dataclass(frozen=True)
class Samples:
    """Triangles of a coarse mesh of the faces.

    Args:
        faces: index of the face of each one.
        corners: (samples, 3, 3) [m].
        points: their middles, (samples, 3) [m].
        normals: out of the first body of the face, (samples, 3).
        areas: [m²].
        edges: tags of the edges of its face that each corner lies on, and 0, (samples, 3, most).
        nodes: tags of the corners, (samples, 3).
    """

    faces: LongArray
    corners: FloatArray
    points: FloatArray
    normals: FloatArray
    areas: FloatArray
    edges: LongArray
    nodes: LongArray


def samples_of(faces: Sequence[Face]) -> Samples:
    """Return the triangles of the faces in the current gmsh model."""
    points = node_points()
    owners, corners, normals, edges, tags = [], [], [], [], []
    for index, face in enumerate(faces):
        nodes = corners_of(TRIANGLE, face.tag)
        places = points[nodes]
        owners.append(np.full(len(places), index))
        corners.append(places)
        normals.append(_outward(face, places))
        edges.append(_on_edges(face, nodes))
        tags.append(nodes)
    most = max(found.shape[2] for found in edges)
    edges = [np.pad(on, ((0, 0), (0, 0), (0, most - on.shape[2]))) for on in edges]
    places = np.concatenate(corners)
    vectors = np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0])
    return Samples(
        np.concatenate(owners),
        places,
        places.mean(axis=1),
        np.concatenate(normals),
        0.5 * np.linalg.norm(vectors, axis=1),
        np.concatenate(edges),
        np.concatenate(tags),
    )


def _on_edges(face: Face, nodes: LongArray) -> LongArray:
    """Return tags of the edges of a face on which its nodes lie, and 0: (triangles, 3, most)."""
    around = gmsh.model.getBoundary([(2, face.tag)], combined=False, oriented=False)
    edges = sorted({tag for _, tag in around})
    on = np.zeros((*nodes.shape, max(1, len(edges))), dtype=np.int64)
    for place, edge in enumerate(edges):
        on[..., place] = edge * np.isin(nodes, gmsh.model.mesh.getNodes(1, edge, True)[0])
    on = -np.sort(-on, axis=2)
    return on[..., : max(1, int((on > 0).sum(axis=2).max(initial=0)))]


def _outward(face: Face, places: FloatArray) -> FloatArray:
    """Return unit normals of triangles on the side of the normals of their face."""
    normals = np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    known = face.points[: len(face.normals)]
    middles = places.mean(axis=1)
    nearest = np.argmin(np.linalg.norm(middles[:, None] - known[None], axis=2), axis=1)
    sign = np.sign(np.einsum("ij,ij->i", normals, face.normals[nearest]))
    return np.asarray(normals * np.where(sign == 0.0, 1.0, sign)[:, None])


def wall_thickness(
    samples: Samples, faces: Sequence[Face], body: str
) -> tuple[FloatArray, FloatArray]:
    """Return the thickness of a body behind each sample, and the direction into it.

    Args:
        samples: of all faces.
        faces: of the model.
        body: its name.

    Returns:
        Thickness (samples,), infinite where there is no other side [m]; directions (samples, 3).
    """
    signs = [0.0 if body not in face.bodies else 1.0 if face.bodies[0] == body else -1.0
             for face in faces]  # fmt: skip
    side = np.array(signs)[samples.faces]
    own = np.flatnonzero(side)
    normals = samples.normals * side[:, None]
    thickness = np.full(len(side), np.inf)
    count = min(MOST, int(MOST_PAIRS / max(1, len(own))) + 1)
    asked = own[np.argsort(-samples.areas[own], kind="stable")[:count]]  # fillets have small ones
    others = samples.corners[own], normals[own], samples.edges[own].reshape(len(own), -1)
    for first in range(0, len(asked), CHUNK):
        rows = asked[first : first + CHUNK]
        thickness[rows] = _to_other_side(
            samples.points[rows], normals[rows], samples.edges[rows], *others
        )
    return thickness, -normals


def _to_other_side(
    points: FloatArray,
    normals: FloatArray,
    edges: LongArray,
    corners: FloatArray,
    other_normals: FloatArray,
    other_edges: LongArray,
) -> FloatArray:
    """Return the distance to the next opposite triangle, along the inward normal.

    Where both sides end in one edge, a wall is as thick as at the corners off it: the middle has a
    part of that by chance, and smaller cells at a knife edge are only flatter.

    Args:
        points: from which to look along the negative normals, (points, 3) [m].
        normals: outward ones.
        edges: tags of those on which the corners of their triangles lie, and 0, (points, 3, most).
        corners: of triangles, (triangles, 3, 3) [m].
        other_normals: of these.
        other_edges: tags of those that these touch, and 0, (triangles, 3 most).
    """
    first, sides = corners[:, 0], corners[:, 1:] - corners[:, :1]
    cosines = normals @ other_normals.T
    heights = np.einsum("ij,ij->i", first, other_normals) - points @ other_normals.T
    opposite = cosines < OPPOSITE
    depths = np.where(opposite, heights / np.where(opposite, -cosines, 1.0), np.inf)
    known = opposite & (depths > 1e-9)
    hit = np.where(known, depths, 0.0)
    duals = np.swapaxes(np.linalg.pinv(sides), 1, 2)  # of a triangle without area: none
    shares = []
    for number in range(2):
        dual = duals[:, number]
        start = points @ dual.T - np.einsum("ij,ij->i", first, dual)
        shares.append(start - hit * (normals @ dual.T))
    shares.append(1.0 - shares[0] - shares[1])
    for share in shares:
        known &= share >= -ON_EDGE
    hits = np.where(known, depths, np.inf)
    rows, columns = np.nonzero(known & (hits < 3.0 * hits.min(axis=1)[:, None]))
    near, met = edges[rows][..., None], other_edges[columns][:, None, None]
    off = 3 - ((near == met) & (near > 0)).any(axis=(2, 3)).sum(axis=1)
    hits[rows, columns] *= np.where(off < 3, 3.0 / np.maximum(off, 1), 1.0)
    return np.asarray(hits.min(axis=1))


@dataclass(frozen=True)
class Wishes:
    """Triangles and the sizes that are wanted there.

    Args:
        corners: (triangles, 3, 3) [m].
        sizes: (triangles,) [m].
    """

    corners: FloatArray
    sizes: FloatArray


def wanted_sizes(
    part: CadPart, faces: Sequence[Face], named: Mapping[str, Sequence[Face]], samples: Samples
) -> Wishes:
    """Return the size that each sample asks for, the middle of the wall behind it, and shells.

    Args:
        part: what is meshed.
        faces: of the model.
        named: faces of each surface.
        samples: of the faces.

    Returns:
        The samples first, then the middles of walls, and layers of a shell.
    """
    sizes = np.full(len(samples.areas), part.size)
    for index, face in enumerate(faces):
        here = samples.faces == index
        least = min([part.size, *(rule.size for rule in part.rules if _on(rule, face, named))])
        if part.interface_size is not None and len(face.bodies) == 2:
            least = min(least, part.interface_size)
        curved = curved_triangles(face.tag, samples.nodes[here], part.curvature)
        sizes[here] = np.minimum(least, curved)
    corners, wanted = [samples.corners], []
    bodies = dict.fromkeys(name for face in faces for name in face.bodies)
    for body in bodies if part.across else ():
        walls, inward = wall_thickness(samples, faces, body)
        sizes = np.minimum(sizes, walls / part.across)
        thin = np.flatnonzero(walls < part.across * part.size)
        for depth in np.linspace(0.0, 1.0, ceil(part.across) + 1)[1:-1]:
            moved = (depth * walls[thin])[:, None] * inward[thin]
            corners.append(samples.corners[thin] + moved[:, None])
            wanted.append(walls[thin] / part.across)
    for layer, size in _shell_layers(part, faces, samples):
        corners.append(layer)
        wanted.append(np.full(len(layer), size))
    return Wishes(np.concatenate(corners), np.concatenate([sizes, *wanted]))


def _shell_layers(
    part: CadPart, faces: Sequence[Face], samples: Samples
) -> Iterator[tuple[FloatArray, float]]:
    """Yield triangles of the layers of cells that a shell has, (triangles, 3, 3), with its size."""
    if part.mould is None or part.shell is None:
        return
    layers = max(1, ceil(part.across))
    outward = np.zeros(len(faces))
    for index, face in enumerate(faces):
        if len(face.bodies) == 2:
            first, second = (body in part.mould.parts for body in face.bodies)
            outward[index] = float(second) - float(first)
    around = outward[samples.faces] != 0.0
    directions = (outward[samples.faces][:, None] * samples.normals)[around]
    for depth in part.shell * np.arange(1, layers + 1) / layers:
        yield samples.corners[around] + (depth * directions)[:, None], part.shell / layers


def _on(rule: SizeRule, face: Face, named: Mapping[str, Sequence[Face]]) -> bool:
    if rule.surface is not None:
        return any(other.tag == face.tag for other in named.get(rule.surface, ()))
    return rule.body is not None and rule.body in face.bodies


@dataclass(frozen=True)
class SizeGrid:
    """Sizes at the nodes of a regular grid.

    Args:
        lowest: its first node [m].
        step: between nodes [m].
        sizes: at the nodes [m].
    """

    lowest: FloatArray
    step: float
    sizes: FloatArray

    def write(self, file: str) -> None:
        """Write the sizes as gmsh's field Structured reads them, in millimetres."""
        with open(file, "wb") as target:
            for numbers in (self.lowest * MILLIMETRES, np.full(3, self.step * MILLIMETRES)):
                target.write(numbers.astype(np.float64).tobytes())
            target.write(np.array(self.sizes.shape, dtype=np.int32).tobytes())
            target.write((self.sizes * MILLIMETRES).astype(np.float64).tobytes())


def size_grid(part: CadPart, wishes: Wishes) -> SizeGrid:
    """Return sizes over space: the wanted ones and sizes of boxes, growing away from them.

    Args:
        part: what is meshed.
        wishes: sizes on triangles.
    """
    corners = wishes.corners.reshape(-1, 3)
    least, extent = float(wishes.sizes.min()), float(np.ptp(corners, axis=0).max())
    step = max(extent / STEPS, 0.5 * least)
    lowest = corners.min(axis=0) - step
    counts = np.ceil((corners.max(axis=0) + step - lowest) / step).astype(np.int64) + 1
    grid = np.full(counts, part.size)
    axes = [low + step * np.arange(count) for low, count in zip(lowest, counts, strict=True)]
    for rule in part.rules:
        if rule.within is not None:
            inside = np.ix_(
                *(
                    (axis > low - step) & (axis < high + step)
                    for axis, low, high in zip(axes, *rule.within, strict=True)
                )
            )
            grid[inside] = np.minimum(grid[inside], rule.size)
    small = wishes.sizes < part.size
    for points, sizes in spread(wishes.corners[small], wishes.sizes[small], step):
        places = (points - lowest) / step
        first = places.astype(np.int64)  # all nodes round it, lest the grid lose thin walls
        for offset in np.ndindex(2, 2, 2):
            nodes = first + offset
            flat = np.ravel_multi_index(tuple(nodes.T), grid.shape)
            np.minimum.at(grid.ravel(), flat, sizes)
    return SizeGrid(lowest, step, _growing(grid, part.growth * step))


def spread(
    corners: FloatArray, sizes: FloatArray, step: float
) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Yield points all over triangles, no farther apart than a step, with their sizes.

    Args:
        corners: of the triangles, (triangles, 3, 3) [m].
        sizes: of the triangles.
        step: the largest distance [m].
    """
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    counts = np.maximum(1, np.ceil(edges / step)).astype(np.int64)
    for count in np.unique(counts):
        of_count = corners[counts == count]
        i, j = np.meshgrid(np.arange(count + 1), np.arange(count + 1), indexing="ij")
        kept = i + j <= count
        u, v = i[kept][:, None] / count, j[kept][:, None] / count
        weights = np.hstack([1.0 - u - v, u, v])
        points = np.einsum("pc,tcx->tpx", weights, of_count)
        yield points.reshape(-1, 3), np.repeat(sizes[counts == count], len(weights))


def _growing(grid: FloatArray, slope: float) -> FloatArray:
    """Return the largest numbers below those of a grid that change by no more than a slope a step.

    Args:
        grid: the numbers.
        slope: change from a node to the next one.
    """
    offsets = [np.array(k) - 1 for k in np.ndindex(3, 3, 3) if k != (1, 1, 1)]
    while True:
        before = grid.copy()
        for offset in offsets:
            along = list(zip(offset, grid.shape, strict=True))
            here = tuple(slice(max(0, -o), min(n, n - o)) for o, n in along)
            there = tuple(slice(max(0, o), min(n, n + o)) for o, n in along)
            rise = slope * float(np.linalg.norm(offset))
            np.minimum(grid[here], grid[there] + rise, out=grid[here])
        if np.array_equal(before, grid):
            return grid


def estimated_cells(
    part: CadPart, samples: Samples, sizes: FloatArray, volumes: Mapping[str, float]
) -> float:
    """Return the estimated number of cells of a mesh.

    Behind each sample sizes grow from its own to the largest one; the rest has the largest one.

    Args:
        part: what is meshed.
        samples: of the faces.
        sizes: at the samples [m].
        volumes: of the bodies [m³].
    """
    total = sum(volumes.values())
    small = np.minimum(sizes, part.size)
    reach = np.minimum((part.size - small) / part.growth, total / samples.areas.sum())
    ends = small + part.growth * reach
    # ∫ (h + g d)⁻³ dd from 0 to the reach, less what the largest size would have there
    layers = (small**-2 - ends**-2) / (2.0 * part.growth) - reach * part.size**-3
    near = float((samples.areas * layers).sum())
    inside = sum(_volume_of(rule, volumes) / rule.size**3 for rule in part.rules)
    return (near + total / part.size**3 + inside) / FILLING


def crowded_cells(grid: SizeGrid) -> float:
    """Return the estimated number of cells where sizes are below the step of their grid.

    The grid spreads such a size over all nodes round its place, about half of which is inside.
    """
    ratios = grid.step / np.minimum(grid.sizes, grid.step)
    return float(0.5 / FILLING * np.sum(ratios[ratios > 1.0] ** 3))


def _volume_of(rule: SizeRule, volumes: Mapping[str, float]) -> float:
    """Return the volume in which a rule holds at most [m³]."""
    if rule.within is not None:
        low, high = (np.array(corner) for corner in rule.within)
        return min(float(np.prod(high - low)), sum(volumes.values()))
    return volumes.get(rule.body, 0.0) if rule.body is not None else 0.0
