"""A verification at the coarsest of its levels."""

from __future__ import annotations

from mpi4py import MPI

from castx.proof.verification.verification import Outcome, Resolution, Verification


def coarse_run(
    verification: Verification, comm: MPI.Intracomm, level: Resolution | None = None
) -> Outcome:
    """Return the outcome at a level, by default the coarsest; all answers within their tolerance.

    Tolerances grow with the size, as in a short check.
    """
    level = level or verification.quick[0]
    outcome = verification.run(level, comm)
    allowed = verification.allowance(level)
    missed = [answer for answer in outcome.answers if answer.error > allowed * answer.tolerance]
    assert not missed
    assert 0 <= outcome.norm < 2  # a share, or kelvins
    for curve in outcome.comparison.curves:
        assert len(curve.x) == len(curve.computed) > 2 and len(curve.exact_x) == len(curve.exact)
    return outcome
