"""The case of one stage: its bodies and the conditions on them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from castx.case.boundaries import CONDITIONS, FREE, FREE_CLAMP, Boundary, HeatCondition
from castx.case.case import Case
from castx.case.stages import Spray, Stage
from castx.errors import CaseError
from castx.meshes.model import SYMMETRY
from castx.transfer.conditions.convection import CONDITION as CONVECTION

Surfaces = Mapping[str, Sequence[str]]
"""Names of the surfaces of each body; those towards another body bear its name."""


def stage_case(case: Case, number: int, surfaces: Surfaces) -> Case:
    """Return the case of one stage.

    Args:
        case: the whole case.
        number: of the stage; 0 is the start.
        surfaces: of the mesh.

    Raises:
        CaseError: a spray has no surface to cool.
    """
    present = [body.name for body in case.bodies]
    boundaries = replaced(case.boundaries, [])  # of one surface, as one
    for index, stage in enumerate(case.stages[:number]):
        present = [name for name in present if name not in stage.remove]
        boundaries = replaced(boundaries, stage.boundaries)
        if stage.spray is not None:
            wet = sprayed_surfaces(stage, index, present, surfaces)
            boundaries = replaced(boundaries, [_cooled(on, stage.spray) for on in wet])
    return case.model_copy(
        update={
            "bodies": tuple(body for body in case.bodies if body.name in present),
            "interfaces": tuple(i for i in case.interfaces if set(i.bodies) <= set(present)),
            "boundaries": tuple(b for b in _released(boundaries, case) if b.body in present),
        }
    )


def replaced(old: Iterable[Boundary], new: Iterable[Boundary]) -> list[Boundary]:
    """Return boundaries in which later conditions replace earlier ones of the same kind."""
    found: dict[str, Boundary] = {}
    for boundary in (*old, *new):
        given = {key: getattr(boundary, key) for key in CONDITIONS if getattr(boundary, key)}
        found[boundary.on] = found.get(boundary.on, boundary).model_copy(update=given)
    for on, boundary in found.items():
        if FREE in boundary.displacement:
            found[on] = boundary.model_copy(update={"displacement": ()})
    return list(found.values())


def _released(boundaries: Iterable[Boundary], case: Case) -> list[Boundary]:
    """Return boundaries with all surfaces that are clamped in some stage, at least without force.

    So that results have the same columns in all stages.
    """
    later = [boundary for stage in case.stages for boundary in stage.boundaries]
    clamps = {
        boundary.on: boundary.clamp.released
        for boundary in (*later[::-1], *case.boundaries)
        if boundary.clamp is not None and boundary.clamp is not FREE_CLAMP
    }
    found = {on: Boundary(on=on, clamp=clamp) for on, clamp in clamps.items()}
    for boundary in boundaries:
        open_now = boundary.clamp is None or boundary.clamp is FREE_CLAMP
        update = {"clamp": clamps.get(boundary.on)} if open_now else {}
        found[boundary.on] = boundary.model_copy(update=update)
    return list(found.values())


def sprayed_surfaces(
    stage: Stage, index: int, present: Sequence[str], surfaces: Surfaces
) -> list[str]:
    """Return the surfaces "body/surface" that a spray cools, without those with other conditions.

    Args:
        stage: with a spray.
        index: of the stage in the list of the case, for messages.
        present: bodies that are there during the stage.
        surfaces: of the mesh.

    Raises:
        CaseError: there is none.
    """
    assert stage.spray is not None
    named = stage.spray.on or tuple(present)
    bare = not stage.spray.on
    found: list[str] = []
    for name in named:
        if "/" in name:
            found.append(name)
            continue
        for surface in surfaces[name]:
            left = surface in surfaces and surface not in present
            outer = surface not in surfaces and not surface.startswith(SYMMETRY)
            if left or (outer and not bare):
                found.append(f"{name}/{surface}")
    own = [boundary.on for boundary in stage.boundaries if boundary.heat]
    found = [on for on in dict.fromkeys(found) if on not in own]
    if not found:
        raise CaseError(
            f"stages[{index}].spray: no removed body has left a surface bare; name the surfaces "
            'or bodies to cool: on = ["casting"]'
        )
    return found


def _cooled(on: str, spray: Spray) -> Boundary:
    cooling = HeatCondition.read(
        {"type": CONVECTION.name, "coefficient": spray.coefficient, "ambient": spray.ambient}
    )
    return Boundary(on=on, heat=(cooling,))
