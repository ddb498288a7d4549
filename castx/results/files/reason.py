"""Why a run ended, in the words of its record."""

from __future__ import annotations

from enum import StrEnum

from castx.errors import ConvergenceError


class Reason(StrEnum):
    """Why a run ended; `running` stands in the record until it has."""

    RUNNING = "running"
    FINISHED = "finished"
    NOT_CONVERGED = "not converged"
    INTERRUPTED = "interrupted"
    FAILED = "failed"

    @classmethod
    def of(cls, error: BaseException | None) -> Reason:
        """Return the reason that belongs to the exception that ended a run, if any did."""
        match error:
            case None:
                return cls.FINISHED
            case ConvergenceError():
                return cls.NOT_CONVERGED
            case KeyboardInterrupt():
                return cls.INTERRUPTED
            case _:
                return cls.FAILED
