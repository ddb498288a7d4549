"""Errors: wrong cases and meshes, full disks, problems that do not converge."""


class CaseError(ValueError):
    """The case file, a material or a command line cannot be accepted as it stands."""


class MeshError(ValueError):
    """A mesh cannot be made, or does not fit the case."""


class StorageError(RuntimeError):
    """Results or checkpoints cannot be written."""


class ConvergenceError(RuntimeError):
    """A nonlinear or linear problem was not solved to its tolerance.

    Args:
        message: the failure, its place and its cause.
        problem: name of the failed problem in `castx.solvers.diagnosis`, or "".
    """

    def __init__(self, message: str, problem: str = "") -> None:
        super().__init__(message)
        self.problem = problem


class UnsettledFit(ConvergenceError):
    """A fit by many runs has not settled; there is no state from which it could go on."""


class Interrupted(KeyboardInterrupt):
    """All ranks stop together between two tries; the state of the last accepted step is whole."""
