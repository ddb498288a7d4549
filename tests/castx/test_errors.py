"""The kinds of errors: what the user can mend, what the disk refuses, what does not converge."""

import pickle

import pytest

from castx.errors import CaseError, ConvergenceError, MeshError, StorageError

pytestmark = pytest.mark.serial


def test_errors_of_one_kind_are_not_taken_for_another():
    """A step that fails is cut; a wrong case, mesh or disk must not end in smaller steps."""
    kinds = (CaseError, MeshError, StorageError, ConvergenceError)
    for kind in kinds:
        assert not any(issubclass(kind, other) for other in kinds if other is not kind)
    assert issubclass(CaseError, ValueError) and issubclass(MeshError, ValueError)
    assert not issubclass(ConvergenceError, ValueError)


def test_a_convergence_error_names_its_problem_on_other_ranks_too():
    error = ConvergenceError("no balance at 3 s", "heat")
    copy = pickle.loads(pickle.dumps(error))
    assert (str(copy), copy.problem) == ("no balance at 3 s", "heat")
    assert ConvergenceError("lost").problem == ""
