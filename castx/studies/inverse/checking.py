"""Studies of a case file refused before their first run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from castx.studies.asked.identify import Identify
from castx.studies.asked.optimise import Optimise
from castx.studies.asked.reading import studies_of
from castx.studies.asked.vary import Vary
from castx.studies.inverse.model import refuse_unidentifiable
from castx.studies.vary import refuse_unusable


def refuse_useless_studies(case_file: Path, overrides: Sequence[str] = ()) -> list[str]:
    """Return the names of the studies of a case file that can begin with it.

    Args:
        case_file: the case.
        overrides: values that replace those of the file.

    Raises:
        CaseError: one of them cannot be accepted, varies or seeks what the case does not have or
            take, or has curves that do not suit it.
    """
    found = studies_of(case_file, overrides)
    for name, study in found.items():
        if isinstance(study, Vary | Optimise):
            refuse_unusable(case_file, overrides, study.inputs, name)
        elif isinstance(study, Identify):
            beside = study.relative_to(case_file.resolve().parent)
            refuse_unidentifiable(case_file, overrides, beside)
    return list(found)
