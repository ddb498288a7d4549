"""Types of numpy arrays."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
IntArray = npt.NDArray[np.int32]
"""Numbers on this rank, and what MPI and PETSc take as 32-bit numbers."""
LongArray = npt.NDArray[np.int64]
"""Global numbers."""
