"""The ways in which castx refuses or gives up."""


class CaseError(ValueError):
    """The case file, a material or a command line cannot be accepted as it stands."""


class MeshError(ValueError):
    """A mesh does not hold what the case asks of it."""


class StorageError(RuntimeError):
    """The disk does not take results or checkpoints."""


class ConvergenceError(RuntimeError):
    """A nonlinear or linear problem was not solved to its tolerance."""
