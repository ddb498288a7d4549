"""Parts of a mould that nothing holds but contact, such as a plug inside an open box.

A part is what hangs together by cells, and by ties with others. Displacement conditions, symmetry
planes and clamps hold its rigid motions; what is left of them is free between the walls of the
casting, which hold nothing until it has shrunk on. The part that is held best, and of such ones the
largest, is the mould beside which the others move.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray, LongArray
from castx.case.cad.holds import frame_clamp, frame_stiffness, joined
from castx.case.case import Case
from castx.case.contact import NONE, is_tied
from castx.coupling.building import prescribed_displacements
from castx.coupling.clamps import surface_clamps
from castx.domain.measures import bounding_box, nodal_volumes
from castx.domain.mesh import BodyMesh, CastingMesh
from castx.domain.pairs.node_pairs import NodePairs
from castx.materials.lookup import find_material
from castx.mechanics.clamp import clamp_directions
from castx.mechanics.fixed_directions import axes_of, fixed_directions
from castx.mechanics.liquid.regions import CellRegions
from castx.meshes.model import SYMMETRY

HELD = 1e-8
"""Sum of the squared motions of held nodes, as shares of a rigid motion, below which it is free."""


@dataclass(frozen=True, eq=False)
class BodyPiece:
    """A connected piece of a body.

    Attributes:
        body: name of the body.
        number: of the piece on its body.
        alone: whether it is all of the body.
        volume: as the model counts it [m³].
        middle: its centre [m], shape (dimension,).
        surface: one that no other body shares; None: it has none.
        held: Gram matrix of the motions of its held nodes, shape (motions, motions).
    """

    body: str
    number: int
    alone: bool
    volume: float
    middle: FloatArray
    surface: str | None
    held: FloatArray


def loose_parts(case: Case, mesh: CastingMesh, pairs: Mapping[str, NodePairs]) -> Iterator[str]:
    """Yield a warning for each part of a mould that nothing but contact holds; collective.

    Castings fill their mould and need no hold: bodies that start liquid, and those that are the
    secondary ones of all their contacts.

    Args:
        case: the case.
        mesh: of its bodies.
        pairs: of its interfaces.

    Raises:
        CaseError: a displacement or a clamp has a direction that model or surface lack.
    """
    tools = _tools(case)
    if case.coupling.scheme == "thermal" or not tools:
        return
    parts = {b.name: _part_of_nodes(mesh.bodies[b.name]) for b in case.bodies if b.law != "rigid"}
    pieces = [piece for name, part in parts.items() for piece in _pieces(case, mesh, name, part)]
    cast = _castings(case)
    groups = [
        group
        for group in _tied(case, parts, pieces, pairs, mesh.comm)
        if tools.intersection(p.body for p in group)
        and not cast.intersection(p.body for p in group)
    ]
    groups.sort(key=lambda group: (len(_free(group)), -sum(piece.volume for piece in group)))
    beside = [] if case.rigid_bodies else groups[:1]
    floats = any(len(_free(group)) for group in beside)
    for group in groups[len(beside) :]:
        if len(_free(group)):
            yield _told(case, mesh.model, _by_size(group), _by_size(beside[0]) if floats else [])


def _castings(case: Case) -> set[str]:
    found = {body.name: find_material(body.material, case.materials) for body in case.bodies}
    return {body.name for body in case.bodies if body.is_poured(found[body.name])}


def _tools(case: Case) -> set[str]:
    """Return the primary bodies of contact that neither are rigid nor cast."""
    primary = {
        interface.primary
        for interface in case.interfaces
        if interface.contact.method != NONE and not is_tied(interface.contact.method)
    }
    return primary - _castings(case) - set(case.rigid_bodies)


def _by_size(group: Sequence[BodyPiece]) -> list[BodyPiece]:
    return sorted(group, key=lambda piece: -piece.volume)


def _free(group: Sequence[BodyPiece]) -> FloatArray:
    """Return the rigid motions that nothing of a group holds, shape (free, motions)."""
    values, vectors = np.linalg.eigh(np.sum([piece.held for piece in group], axis=0))
    return np.asarray(vectors[:, values < HELD].T)


def _part_of_nodes(body: BodyMesh) -> IntArray:
    """Return the connected part of each owned node, shape (owned,); collective."""
    regions = CellRegions(body)
    _, part = regions.find(np.ones(len(regions.cell_nodes), dtype=bool))
    of_node = np.full(len(body.parent_vertices), -1, dtype=np.int32)
    of_node[regions.cell_nodes] = part[:, None]
    return of_node[: body.nodes.dofmap.index_map.size_local]


def _pieces(case: Case, mesh: CastingMesh, name: str, part: IntArray) -> Iterator[BodyPiece]:
    """Yield the pieces of a body; collective."""
    body, owned = mesh.bodies[name], len(part)
    comm = body.mesh.comm
    count = comm.allreduce(int(part.max(initial=-1)), op=MPI.MAX) + 1
    volumes, points = nodal_volumes(body, mesh.model), body.points[:owned]
    names = {other.name for other in case.bodies}
    surfaces = [s for s in body.surfaces if s not in names and not s.startswith(SYMMETRY)]
    nodes, rows = _held_rows(case, mesh, body)
    for number in range(count):
        here = part == number
        sums = np.append((volumes[:, None] * points)[here].sum(axis=0), volumes[here].sum())
        sums = comm.allreduce(sums, op=MPI.SUM)
        own = rows[here[nodes]]
        touched = [s for s in surfaces if _meets(body, s, here)]
        yield BodyPiece(
            name, number, count == 1, float(sums[-1]), sums[:-1] / sums[-1],
            next(iter(touched), None), comm.allreduce(own.T @ own, op=MPI.SUM),
        )  # fmt: skip


def _meets(body: BodyMesh, surface: str, here: BoolArray) -> bool:
    nodes = body.surface_nodes(surface)
    return bool(body.mesh.comm.allreduce(bool(here[nodes[nodes < len(here)]].any()), op=MPI.LOR))


def _held_rows(case: Case, mesh: CastingMesh, body: BodyMesh) -> tuple[IntArray, FloatArray]:
    """Return held owned nodes, and the rigid motions there along what holds them, (n, motions)."""
    model, owned = mesh.model, body.nodes.dofmap.index_map.size_local
    held: list[tuple[IntArray, FloatArray]] = [
        (fixed.nodes, fixed.directions)
        for fixed in fixed_directions(body, model, prescribed_displacements(case)[body.name])
        if fixed.value is not None
    ]
    boundaries = [boundary for boundary in case.boundaries if boundary.body == body.name]
    for clamp in surface_clamps(boundaries, model):
        nodes = body.surface_nodes(clamp.surface)
        nodes = nodes[nodes < owned]
        for direction in clamp_directions(body, model, clamp)[0]:
            held.append((nodes, np.tile(direction, (len(nodes), 1))))
    box = bounding_box(np.asarray(mesh.parent.geometry.x, dtype=np.float64), mesh.comm)
    motions = _motions(model, body.points[:owned], box)
    nodes = np.concatenate([np.zeros(0, dtype=np.int32), *(nodes for nodes, _ in held)])
    along = [np.einsum("ni,mni->nm", e, motions[:, nodes]) for nodes, e in held]
    return nodes, np.concatenate([np.zeros((0, len(motions))), *along])


def _motions(model: str, points: FloatArray, box: tuple[FloatArray, FloatArray]) -> FloatArray:
    """Return the rigid motions that all bodies have in common, (motions, points, dimension)."""
    dimension = points.shape[1]
    shifts = [np.tile(e, (len(points), 1)) for e in np.eye(dimension)]
    if model == "axisymmetric":
        return np.array(shifts[1:])
    low, high = box
    middle, size = 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low))
    arms = (points - middle[:dimension]) / size
    if dimension == 2:
        return np.array([*shifts, np.stack((-arms[:, 1], arms[:, 0]), axis=1)])
    return np.array([*shifts, *(np.cross(axis, arms) for axis in np.eye(3))])


def _tied(
    case: Case, parts: Mapping[str, IntArray], pieces: Sequence[BodyPiece],
    pairs: Mapping[str, NodePairs], comm: MPI.Intracomm,
) -> list[list[BodyPiece]]:  # fmt: skip
    """Return the pieces by what ties join; collective."""
    everywhere: dict[str, LongArray] = {
        name: np.concatenate(comm.allgather(part)) for name, part in parts.items()
    }
    found = {(piece.body, piece.number): piece for piece in pieces}
    ties: list[tuple[tuple[str, int], tuple[str, int]]] = []
    for interface in case.interfaces:
        if not is_tied(interface.contact.method) or not set(interface.bodies) <= set(parts):
            continue
        paired, (partners, _) = pairs[interface.name], pairs[interface.name].partners
        first = parts[interface.secondary][paired.secondary_local]
        second = everywhere[interface.primary][partners]
        links = np.stack([np.repeat(first, partners.shape[1]), second.ravel()], axis=1)
        for a, b in np.unique(np.concatenate(comm.allgather(links)), axis=0):
            ties.append(((interface.secondary, int(a)), (interface.primary, int(b))))
    return [[found[key] for key in group] for group in joined(found, ties)]


def _told(case: Case, model: str, group: Sequence[BodyPiece], mould: Sequence[BodyPiece]) -> str:
    """Return the warning of a part.

    Args:
        case: the case.
        model: geometric model.
        group: its pieces, the largest first.
        mould: pieces beside which it moves, if nothing holds them either, the largest first.
    """
    piece = group[0]
    others = dict.fromkeys(p.body for p in group if p.body != piece.body)
    name = piece.body if piece.alone else f"a piece of {piece.body} round {_place(piece)} m"
    name += f" (with {', '.join(others)})" if others else ""
    ways = _ways(model, _free(group))
    text = (
        f"{name}: nothing but contact holds it, so that it {ways} as the casting "
        "shrinks, and gaps, distortion and stress round it are false; "
    )
    hung = next((p for p in group if p.surface is not None), None)
    if hung is None:
        return text + (
            "it has no free surface to hang it at: let a core print reach into the mould and tie "
            f'it there (contact = {{ method = "tied" }}), or give {piece.body} law = "rigid"'
        )
    text += (
        f"hang it at what carries it, {_clamp(case, model, hung)}, or tie it "
        '(contact = { method = "tied" }) to a part of the mould that is held'
    )
    # On a surface of that body the same key holds both.
    floats = next((p for p in mould if p.surface is not None), None)
    if floats is not None and hung.body not in {p.body for p in mould}:
        text += f"; {floats.body} floats too and then needs {_clamp(case, model, floats)}"
    return text


def _place(piece: BodyPiece) -> str:
    return f"({', '.join(f'{x:.3g}' for x in piece.middle)})"


def _ways(model: str, free: FloatArray) -> str:
    """Return in words what a part can do that is free in some rigid motions."""
    axes = ["z"] if model == "axisymmetric" else list(axes_of(model))
    reach = np.abs(free).max(axis=0)
    moves = [axis for axis, share in zip(axes, reach, strict=False) if share > HELD]
    words = [f"moves along {', '.join(moves)}"] if moves else []
    words += ["turns"] if (reach[len(axes) :] > HELD).any() else []
    return " and ".join(words)


def _clamp(case: Case, model: str, piece: BodyPiece) -> str:
    """Return the key that holds a piece at its free surface."""
    body = next(body for body in case.bodies if body.name == piece.body)
    bounds = body.temperature.bounds
    volume = piece.volume if model in ("3d", "axisymmetric") else 1.0  # per metre of depth
    stiffness = frame_stiffness(
        find_material(body.material, case.materials), bounds[0] if bounds else 20.0, volume
    )
    return f'on = "{piece.body}/{piece.surface}", {frame_clamp(stiffness or 1e8)}'
