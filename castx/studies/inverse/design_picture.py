"""design.png: the places where sensors might lie, on the bodies, those that are chosen numbered."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from mpi4py import MPI

from castx.case.case import Case
from castx.case.output import Probe
from castx.domain.mesh import CastingMesh, build_mesh
from castx.domain.pairs.pairing import case_pairs
from castx.report.exploded import Mark, write_picture
from castx.report.shells import shells_of
from castx.results.probes import buried_place
from castx.studies.asked.candidates import CandidateSensor

PICTURE = "design.png"


def draw_design(
    case: Case,
    candidates: Sequence[CandidateSensor],
    order: Sequence[str],
    comm: MPI.Intracomm,
    file: Path,
) -> None:
    """Draw bodies with all candidates at their depths into a file.

    Args:
        case: the case.
        candidates: places where a sensor might lie.
        order: names of those that are chosen; their number stands before their name.
        comm: of one rank.
        file: PNG, SVG or PDF.

    Raises:
        CaseError: a candidate lies outside its body, or the picture cannot be drawn or written.
        MeshError: the mesh lacks what the case asks of it.
    """
    mesh = build_mesh(case.geometry, [body.name for body in case.bodies], comm)
    names = [interface.name for interface in case.interfaces]
    marks = marks_of(case, mesh, candidates, order)
    write_picture(shells_of(mesh, names), case.geometry.model != "3d", file, marks)


def marks_of(
    case: Case, mesh: CastingMesh, candidates: Sequence[CandidateSensor], order: Sequence[str]
) -> list[Mark]:
    """Return the candidates where they lie; see `draw_design`."""
    pairs = case_pairs(mesh, case.interfaces)
    found = []
    for one in candidates:
        at = one.at
        if one.below is not None:
            probe = Probe.read(one.probes(0.0)[0])
            nodes = mesh.bodies[one.body].nodes.tabulate_dof_coordinates()
            at = tuple(buried_place(probe, mesh, pairs).interpolate(nodes)[: len(one.at)])
        number = f"{order.index(one.name) + 1}. " if one.name in order else ""
        found.append(Mark(number + one.name, one.body, at))
    return found
