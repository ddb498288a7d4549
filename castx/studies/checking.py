"""Studies of a case file refused before their first run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from castx.studies.asked.optimise import Optimise
from castx.studies.asked.reading import KINDS, read_study, refuse_wrong_studies
from castx.studies.asked.vary import Vary
from castx.studies.vary import refuse_unusable


def refuse_useless_studies(case_file: Path, overrides: Sequence[str] = ()) -> list[str]:
    """Return the names of the studies of a case file that can begin with it.

    Args:
        case_file: the case.
        overrides: values that replace those of the file.

    Raises:
        CaseError: one of them cannot be accepted, or varies what the case does not have or take.
    """
    found = refuse_wrong_studies(case_file, overrides)
    for name in found:
        study = read_study(case_file, KINDS[name], overrides)
        if isinstance(study, Vary | Optimise):
            refuse_unusable(case_file, overrides, study.inputs, name)
    return found
