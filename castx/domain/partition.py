"""Distribution of cells to ranks: every body in equal parts, interfaces undivided."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from castx.arrays import BoolArray, FloatArray, IntArray, LongArray

CUT_WEIGHT = 0.05
"""Weight of cut faces against the imbalance of the bodies."""

SKEW = 1e-7
"""Tilt of the cutting planes against the grid lines of structured meshes."""


def partition(midpoints: FloatArray, bodies: LongArray, across: LongArray, parts: int) -> LongArray:
    """Return the rank of each cell by recursive coordinate bisection, (cells,).

    Cells that face each other across an interface form a cluster with one position and are never
    parted. Of the coordinate directions and their diagonals the one is cut in which every body is
    divided most evenly, since solvers work on one body after the other, and in which few faces are
    cut. The result depends on the mesh only.

    Args:
        midpoints: (cells, gdim) [m].
        bodies: (cells,) body of each cell.
        across: (cells, faces) neighbours, negative outside.
        parts: number of ranks.
    """
    rank = np.zeros(len(bodies), dtype=np.int64)
    if parts == 1:
        return rank
    cell, face = np.nonzero(across >= 0)
    edges = np.column_stack([cell, across[cell, face]])
    edges = edges[edges[:, 0] < edges[:, 1]]
    cluster = _clusters(edges[bodies[edges[:, 0]] != bodies[edges[:, 1]]], len(bodies))
    sums = [np.bincount(cluster, x)[cluster] for x in midpoints.T]
    position = np.asarray(np.column_stack(sums) / np.bincount(cluster)[cluster, None])
    todo: list[tuple[LongArray, int, int]] = [(np.arange(len(bodies)), 0, parts)]
    while todo:
        cells, first, count = todo.pop()
        rank[cells] = first
        if count == 1 or not len(cells):
            continue
        left = _best_half(cells, position, cluster, bodies, edges, (count // 2) / count)
        todo.append((cells[left], first, count // 2))
        todo.append((cells[~left], first + count // 2, count - count // 2))
    return rank


def _clusters(facing: LongArray, cells: int) -> LongArray:
    graph = coo_array((np.ones(len(facing), dtype=np.int8), tuple(facing.T)), shape=(cells, cells))
    numbers: LongArray = connected_components(graph, directed=False)[1].astype(np.int64)
    return numbers


def _best_half(
    cells: LongArray,
    position: FloatArray,
    cluster: LongArray,
    bodies: LongArray,
    edges: LongArray,
    share: float,
) -> BoolArray:
    """Return a mask of the cells in the left part, which gets a given share of all cells."""
    best: BoolArray = np.zeros(len(cells), dtype=bool)
    lowest = np.inf
    inside = np.zeros(len(bodies), dtype=bool)
    inside[cells] = True
    edges = edges[inside[edges].all(axis=1)]
    for direction in _directions(position.shape[1]):
        along = (position[cells] * direction).sum(axis=1)
        left = _cut(along, cluster[cells], share)
        side = np.zeros(len(bodies), dtype=bool)
        side[cells] = left
        faces = np.count_nonzero(side[edges[:, 0]] != side[edges[:, 1]])
        cost = _imbalance(bodies[cells], left, share)
        cost += CUT_WEIGHT * faces / len(cells) ** (1 - 1 / position.shape[1])
        if cost < lowest - 1e-12:
            best, lowest = left, cost
    return best


def _directions(gdim: int) -> Iterator[FloatArray]:
    """Yield coordinate directions and diagonals, slightly tilted so that few positions agree."""
    skew = SKEW * np.arange(1, gdim + 1)
    for axis in range(gdim):
        yield np.eye(gdim)[axis] + skew
    for first, second in combinations(range(gdim), 2):
        for sign in (1.0, -1.0):
            yield np.eye(gdim)[first] + sign * np.eye(gdim)[second] + skew


def _cut(along: FloatArray, cluster: LongArray, share: float) -> BoolArray:
    """Return the cells below the cut: whole clusters, as near to the share as possible."""
    order = np.lexsort([cluster, along])
    ends = np.flatnonzero(np.append(np.diff(cluster[order]) != 0, True)) + 1
    cut = ends[np.argmin(np.abs(ends - share * len(cluster)))]
    left = np.zeros(len(cluster), dtype=bool)
    left[order[:cut]] = True
    return left


def _imbalance(bodies: LongArray, left: BoolArray, share: float) -> float:
    """Return the relative work of the slower part, body after body; 1 for equal parts."""
    total = np.bincount(bodies)
    below = np.bincount(bodies[left], minlength=len(total))
    return float(np.maximum(below / share, (total - below) / (1 - share)).sum() / len(bodies))


def destinations(rank: LongArray, across: LongArray) -> tuple[IntArray, IntArray]:
    """Return the ranks of each cell, its owner first, then the ranks with a ghost of the cell.

    Args:
        rank: owner of each cell, (cells,).
        across: (cells, faces) neighbours, negative outside.

    Returns:
        Ranks of all cells one after the other, and offsets (cells + 1,).
    """
    cell, face = np.nonzero(across >= 0)
    holder = rank[across[cell, face]]
    ghost = holder != rank[cell]
    ghosts = np.unique(np.column_stack([cell[ghost], holder[ghost]]), axis=0)
    cells = np.concatenate([np.arange(len(rank)), ghosts[:, 0]])
    values = np.concatenate([rank, ghosts[:, 1]])
    order = np.argsort(cells, kind="stable")
    offsets = np.concatenate([[0], np.cumsum(np.bincount(cells, minlength=len(rank)))])
    return values[order].astype(np.int32), offsets.astype(np.int32)
