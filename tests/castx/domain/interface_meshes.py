"""Meshes whose two bodies meet at edges, corners and curved sides, made by generators."""

from castx.domain.pairs.pairing import Facing, pairs_of
from tests.elastic_bodies import generated

NAMES = ("casting", "mould")


def pairs_by(rule, mesh, secondary, primary):
    """Return the pairs of two bodies by a rule."""
    return pairs_of(mesh, [Facing(secondary, primary, rule)])[0]


def box(comm, model, cells):
    sides = [0.04, 0.02, 0.03] if model == "3d" else [0.04, 0.02]
    return generated(
        comm, model, "box_in_mould", NAMES, box=sides, wall=0.01, size=0.01, lid=True, cells=cells
    )


def cup(comm, model, **arguments):
    return generated(
        comm, model, "cylinder_in_mould", NAMES,
        radius=0.03, height=0.04, wall=0.01, floor=0.01, size=0.009, **arguments,
    )  # fmt: skip


MESHES = {
    "box": lambda comm: box(comm, "plane-strain", "simplices"),
    "box, quadrilaterals": lambda comm: box(comm, "plane-strain", "quadrilaterals"),
    "box in space": lambda comm: box(comm, "3d", "simplices"),
    "box in space, hexahedra": lambda comm: box(comm, "3d", "quadrilaterals"),
    "cup": lambda comm: cup(comm, "axisymmetric"),
    "cup in space": lambda comm: cup(comm, "3d", sector="quarter"),
}
