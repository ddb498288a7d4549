"""Reason for which a run ended, by the exception that ended it."""

import pytest

from castx.errors import ConvergenceError, Interrupted, StorageError
from castx.results.files.reason import Reason


@pytest.mark.serial
@pytest.mark.parametrize(
    "error, reason",
    [
        (None, "finished"),
        (ConvergenceError("no solution"), "not converged"),
        (Interrupted("stopped"), "interrupted"),
        (KeyboardInterrupt(), "interrupted"),
        (StorageError("full"), "failed"),
    ],
)
def test_the_end_of_a_run_has_a_reason(error, reason):
    assert Reason.of(error) == reason
