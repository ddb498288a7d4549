"""The numbers that a run of a case can find, by their names, before it runs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from castx.case.bodies import Body
from castx.case.case import Case
from castx.foundry.suction import CUT_OFFS
from castx.input.problems import among
from castx.materials.lookup import find_material
from castx.report.summary.freezing import LAST_LIQUID
from castx.report.summary.risks import FIELD_RISKS
from castx.report.summary.solid import AT_THE_END, RESIDUAL
from castx.results.states.quantities import MARGINS

_OF_A_MARGIN = {f"{MARGINS}{cut_off!r}": "tearing_margin" for cut_off in CUT_OFFS}


@dataclass(frozen=True)
class AnswerKind:
    """A topic of findings, and which runs have it.

    Args:
        topic: of the findings.
        owner: what has it.
        field: that must be written; "" for none.
        mechanical: whether only a run with mechanics has it.
    """

    topic: str
    owner: Literal["casting", "body", "interface", "curve"]
    field: str = ""
    mechanical: bool = False


ANSWER_KINDS = (
    AnswerKind(LAST_LIQUID, "casting"),
    AnswerKind("Worst hot spot", "casting"),
    *(AnswerKind(risk.topic + ending, "casting", _OF_A_MARGIN.get(risk.field, risk.field))
      for risk in FIELD_RISKS for ending in ("", " without bounds")),
    AnswerKind("Kou's index of the alloy", "casting"),
    AnswerKind("Ratio of Clyne and Davies of the alloy", "casting"),
    AnswerKind("Largest gap", "interface", mechanical=True),
    AnswerKind("Largest suction of the melt", "casting", mechanical=True),
    AnswerKind("Largest suction at the wall", "interface", mechanical=True),
    AnswerKind(RESIDUAL, "body", mechanical=True),
    AnswerKind(AT_THE_END, "body", mechanical=True),
    AnswerKind("Distortion", "body", mechanical=True),
    AnswerKind("Force to draw", "body", mechanical=True),
    AnswerKind("Beside its measurement", "curve"),
    AnswerKind("Coherency", "casting"),
    AnswerKind("Bending of thin walls", "body", mechanical=True),
    AnswerKind("Residual stress of thin walls", "casting", mechanical=True),
    AnswerKind("Error of the stress by the mesh", "body", mechanical=True),
    AnswerKind("Error of the heat flux by the mesh", "body"),
)  # fmt: skip
"""All topics that a run on its own may find, in the order of the report."""


def answerable(case: Case, varied: Sequence[str] = ()) -> list[str]:
    """Return the names of all numbers that a run of a case may find, as `Finding.name` has them.

    Not every run finds all of them: a casting that has not frozen has no freezing time.

    Args:
        case: as it is given.
        varied: paths of numbers that runs change, as `--set` takes them.
    """
    return [name for kind in ANSWER_KINDS if not _lacking(kind, case)
            for name in _names(kind, case, varied)]  # fmt: skip


def refusal_of(name: str, case: Case, varied: Sequence[str] = ()) -> str:
    """Return why no run of a case can find a number, with what it can find; "" if it may.

    Args:
        name: of the number.
        case: as it is given.
        varied: paths of numbers that runs change.
    """
    known = answerable(case, varied)
    if name in known:
        return ""
    for kind in ANSWER_KINDS:
        if name in _names(kind, case, varied):
            return f"{_lacking(kind, case)}; {among('', known, what='without it runs answer')}"
    return f"no run answers this; {among(name, known, what='they answer')}"


def _lacking(kind: AnswerKind, case: Case) -> str:
    if kind.mechanical and case.coupling.scheme == "thermal":
        return 'needs mechanics, and coupling.scheme = "thermal" has none'
    if kind.field and kind.field not in case.output.fields:
        return f"needs the field {kind.field}: add it to output.fields"
    return ""


def _names(kind: AnswerKind, case: Case, varied: Sequence[str]) -> list[str]:
    owners: dict[str, list[str]] = {
        "casting": list(_castings(case, varied)),
        "body": [body.name for body in case.bodies],
        "interface": [interface.name for interface in case.interfaces],
        "curve": [measurement.of for measurement in case.measurements],
    }
    return [f"{kind.topic}: {owner}" for owner in owners[kind.owner]]


def _castings(case: Case, varied: Sequence[str]) -> Iterator[str]:
    """Yield the bodies that start liquid, or may when their temperature is another."""
    for index, body in enumerate(case.bodies):
        paths = (f"bodies.{index}.temperature", f"bodies[{index}].temperature")
        if _may_freeze(case, body, any(path.startswith(paths) for path in varied)):
            yield body.name


def _may_freeze(case: Case, body: Body, is_varied: bool) -> bool:
    material = find_material(body.material, case.materials)
    return material.melts and (is_varied or not body.starts_solid(material.description))
