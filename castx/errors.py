"""The ways in which castx refuses or gives up."""


class CaseError(ValueError):
    """The case file, a material or a command line cannot be accepted as it stands."""


class MeshError(ValueError):
    """A mesh does not hold what the case asks of it."""


class StorageError(RuntimeError):
    """The disk does not take results or checkpoints."""


class ConvergenceError(RuntimeError):
    """A nonlinear or linear problem was not solved to its tolerance.

    Args:
        message: what happened, where and why.
        problem: the problem that failed, by a name of `castx.solvers.diagnosis`; "" if it is
            none of them.
    """

    def __init__(self, message: str, problem: str = "") -> None:
        super().__init__(message)
        self.problem = problem


class Interrupted(KeyboardInterrupt):
    """All ranks stop together between two tries; the state of the last accepted step is whole."""
