"""Pairs without a row of their own: another pair of their node holds the same direction.

Where a die parts at a face of the casting, the nodes there face both halves along one normal, and a
node of the casting has room for one of the two gaps. The other half is held through the first one
if both are tied or rigid; else it may penetrate there.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray, IntArray
from castx.case.interfaces import Interface
from castx.contact.kinematics.placement import GRAZING
from castx.domain.pairs.node_pairs import NodePairs

RIGID = "rigid bodies"
"""Name under which all of them stand together."""


def hidden_pair_warnings(
    interfaces: Sequence[Interface],
    pairs: Mapping[str, NodePairs],
    rigid: Collection[str],
    comm: MPI.Intracomm,
) -> list[str]:
    """Return a warning for each interface of which pairs carry no force; collective.

    Args:
        interfaces: of the case.
        pairs: of each interface by its name.
        rigid: names of rigid bodies.
        comm: the ranks.
    """
    together = _moving_together(interfaces, rigid)
    met: dict[tuple[str, int], list[tuple[FloatArray, str]]] = {}
    warnings = []
    for interface in interfaces:
        if interface.contact.method in ("none", "tied") or interface.secondary in rigid:
            continue
        own = pairs[interface.name]
        hidden = _hidden(own, together.get(own.primary, own.primary), met)
        places = np.concatenate(comm.allgather(own.points[hidden]))
        total = comm.allreduce(len(own.areas))
        if len(places):
            warnings.append(_text(interface, places, total))
    return warnings


def _moving_together(interfaces: Sequence[Interface], rigid: Collection[str]) -> dict[str, str]:
    """Return the name of the group of each body that is tied or rigid."""
    group = {body: RIGID for body in rigid}
    for interface in interfaces:
        if interface.contact.method == "tied":
            first, second = (group.get(body, body) for body in interface.bodies)
            group = {body: first if name == second else name for body, name in group.items()}
            group |= {body: first for body in interface.bodies}
    return group


def _hidden(
    pairs: NodePairs, group: str, met: dict[tuple[str, int], list[tuple[FloatArray, str]]]
) -> IntArray:
    """Return which pairs have no room at their node; the others are added to `met`."""
    hidden = []
    for k in range(len(pairs.areas)):
        normal = np.asarray(pairs.normals[k])
        known = met.setdefault((pairs.secondary, int(pairs.secondary_local[k])), [])
        if _independent(normal, [row for row, _ in known]):
            known.append((normal, group))
        elif not any(g == group and abs(row @ normal) > 1 - GRAZING**2 for row, g in known):
            hidden.append(k)
    return np.array(hidden, dtype=np.int32)


def _independent(normal: FloatArray, rows: Sequence[FloatArray]) -> bool:
    if not rows:
        return True
    if len(rows) >= len(normal):
        return False
    basis = np.linalg.qr(np.stack(rows, axis=1))[0]
    return bool(np.linalg.norm(normal - basis @ (basis.T @ normal)) > GRAZING)


def _text(interface: Interface, places: FloatArray, total: int) -> str:
    secondary, primary = interface.bodies
    order = np.lexsort(np.round(places, 9).T)
    place = ", ".join(f"{x:g}" for x in places[order[0]])
    return (
        f"interface {interface.name}: {len(places)} of {total} pairs carry no force, the first at "
        f"({place}) m: {secondary} touches several bodies there along one normal, and they can "
        f"move apart; name the other body first, bodies = [{primary!r}, {secondary!r}], in all "
        f"these interfaces, or tie the bodies that {secondary} touches to each other"
    )
