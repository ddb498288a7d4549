"""Pairs without a row of their own: other pairs of their node hold their direction.

Where a die parts at a face of the casting, the nodes there face both halves along one normal, and a
node of the casting has room for one of the two gaps. The other half is held through the first one
if both are tied or rigid; else it may penetrate there. A node at a corner where more faces meet
than it has components of displacement has no room for the last ones either, whatever they belong
to.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from mpi4py import MPI

import numpy as np

from castx.arrays import BoolArray, FloatArray, IntArray
from castx.case.interfaces import Interface
from castx.contact.kinematics.node_rows import NodeRows
from castx.contact.kinematics.placement import GRAZING
from castx.domain.pairs.node_pairs import NodePairs
from castx.stateful import occurrence

RIGID = "rigid bodies"
"""Name under which all of them stand together."""


def hidden_pair_warnings(
    interfaces: Sequence[Interface],
    pairs: Mapping[str, NodePairs],
    rigid: Collection[str],
    comm: MPI.Intracomm,
) -> list[str]:
    """Return warnings for each interface of which pairs carry no force; collective.

    Args:
        interfaces: of the case.
        pairs: of each interface by its name.
        rigid: names of rigid bodies.
        comm: the ranks.
    """
    together = _moving_together(interfaces, rigid)
    met: dict[str, _Met] = {}
    warnings = []
    for interface in interfaces:
        if interface.contact.method in ("none", "tied") or interface.secondary in rigid:
            continue
        own = pairs[interface.name]
        if own.secondary not in met:
            all_of = [p for p in pairs.values() if p.secondary == own.secondary]
            nodes = 1 + max(int(p.secondary_local.max(initial=-1)) for p in all_of)
            met[own.secondary] = _Met(nodes, own.points.shape[1])
        hidden, parting = met[own.secondary].hidden(own, together.get(own.primary, own.primary))
        total = comm.allreduce(len(own.areas))
        for which, reason in ((parting, _parting), (~parting, _crowded)):
            places = np.concatenate(comm.allgather(own.points[hidden[which]]))
            if len(places):
                warnings.append(_text(interface, places, total) + reason(*interface.bodies))
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


class _Met:
    """Rows of the pairs at the nodes of a body, and the groups that they face.

    Args:
        nodes: local nodes that have pairs.
        dimension: number of displacement components.
    """

    def __init__(self, nodes: int, dimension: int) -> None:
        self._rows = NodeRows.none(nodes, dimension)
        self._groups = np.full((nodes, dimension), "", dtype=object)

    def hidden(self, pairs: NodePairs, group: str) -> tuple[IntArray, BoolArray]:
        """Return the pairs without room at their node, and the part of them held by another group.

        The others take the room. A pair that faces a group along a row of the same group is held by
        this row.
        """
        order = occurrence(pairs.secondary_local)
        hidden = [np.zeros(0, dtype=np.int32)]
        for k in range(int(order.max(initial=-1)) + 1):
            here = np.flatnonzero(order == k).astype(np.int32)
            nodes, normals = pairs.secondary_local[here], pairs.normals[here]
            slots = self._rows.try_add(nodes, normals, GRAZING)
            placed = slots >= 0
            self._groups[nodes[placed], slots[placed]] = group
            along = np.abs(np.einsum("nki,ni->nk", self._rows.rows[nodes], normals))
            held = (along > 1.0 - GRAZING**2) & (self._groups[nodes] == group)
            hidden.append(here[~placed & ~held.any(axis=1)])
        found = np.concatenate(hidden)
        others = self._groups[pairs.secondary_local[found]]
        return found, np.asarray(((others != group) & (others != "")).any(axis=1), dtype=np.bool_)


def _text(interface: Interface, places: FloatArray, total: int) -> str:
    order = np.lexsort(np.round(places, 9).T)
    place = ", ".join(f"{x:g}" for x in np.round(places[order[0]], 9) + 0.0)
    return (
        f"interface {interface.name}: {len(places)} of {total} pairs carry no force, the first at "
        f"({place}) m: "
    )


def _parting(secondary: str, primary: str) -> str:
    return (
        f"{secondary} touches several bodies there along one normal, and they can "
        f"move apart; name the other body first, bodies = [{primary!r}, {secondary!r}], in all "
        f"these interfaces, or tie the bodies that {secondary} touches to each other"
    )


def _crowded(secondary: str, primary: str) -> str:
    return (
        f"{secondary} touches more faces there than a node can be held by; while the others are "
        f"closed nothing is missing, and it may enter {primary} a little once they open; take "
        "smaller elements there, or round the edge, if that place matters"
    )
