"""What cells in the skin of a casting make of its freezing time, told as a run begins."""

from __future__ import annotations

import logging

from castx.case.case import Case
from castx.case.skin import skins
from castx.domain.mesh import CastingMesh
from castx.domain.summary import MeshSummary, mesh_summary

TOLD, WARNED = 0.05, 0.2
"""Errors of the freezing time from which a run tells of them, and from which it warns."""

_log = logging.getLogger(__name__)


def tell_of_skins(case: Case, mesh: CastingMesh) -> None:
    """Log the skins whose cells may put the freezing time off; collective.

    Args:
        case: the case.
        mesh: of the run; its first rank tells.
    """
    summary = mesh_summary(mesh)
    for error, text in skin_errors(case, summary) if mesh.comm.rank == 0 else ():
        if error >= TOLD:
            _log.log(logging.WARNING if error >= WARNED else logging.INFO, text)


def skin_errors(case: Case, summary: MeshSummary) -> list[tuple[float, str]]:
    """Return the errors of the freezing time by cells in skins, as a share and in words."""
    found = []
    for skin in skins(case, summary.moduli):
        other = next(name for name in skin.interface.split("/") if name != skin.casting)
        height = summary.height(skin.casting, other)
        if height:
            found.append((skin.error(height), skin.text(height)))
    return found
