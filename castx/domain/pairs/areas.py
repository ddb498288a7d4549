"""Areas of both sides of interfaces whose meshes do not match."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mpi4py import MPI

from castx.case.interfaces import Interface
from castx.domain.pairs.node_pairs import NodePairs
from castx.input.units import plain_text

DIFFERENCE = 0.05
"""Share of the larger area by which those of both sides differ before castx warns."""


def area_text(pairs: NodePairs, comm: MPI.Intracomm) -> str:
    """Return the areas of both sides of an interface in words; collective.

    Args:
        pairs: of the interface, whose sides have areas of their own.
        comm: the ranks.
    """
    secondary, primary = _areas(pairs, comm)
    of_one, of_other = (f"{plain_text(1e4 * area)} cm²" for area in (secondary, primary))
    return f"{of_one} of {pairs.secondary} face {of_other} of {pairs.primary}"


def area_warnings(
    interfaces: Sequence[Interface], pairs: Mapping[str, NodePairs], comm: MPI.Intracomm
) -> list[str]:
    """Return the warnings of interfaces whose sides should be equally large; collective.

    Across a wide gap of cylinders or spheres, `curved`, they are not.

    Args:
        interfaces: of the case.
        pairs: of each interface by its name.
        comm: the ranks.
    """
    plane = [one.name for one in interfaces if one.heat is None or one.heat.curved is None]
    return [text for name in plane if (text := area_warning(pairs[name], comm))]


def area_warning(pairs: NodePairs, comm: MPI.Intracomm) -> str:
    """Return a warning where the areas of both sides differ, else an empty text; collective.

    Args:
        pairs: of the interface.
        comm: the ranks.
    """
    if pairs.primary_area is None:
        return ""
    areas = _areas(pairs, comm)
    difference = 1.0 - min(areas) / max(areas)
    if difference <= DIFFERENCE:
        return ""
    return (
        f"interface {pairs.name}: the areas of both sides differ by {100 * difference:.0f} %, "
        f"{area_text(pairs, comm)}; refine the mesh at the edges, or see whether "
        "contact.search_distance reaches what should touch, and nothing else"
    )


def _areas(pairs: NodePairs, comm: MPI.Intracomm) -> tuple[float, float]:
    secondary = float(comm.allreduce(float(pairs.areas.sum()), op=MPI.SUM))
    return secondary, secondary if pairs.primary_area is None else pairs.primary_area
