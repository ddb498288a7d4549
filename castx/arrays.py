"""Types of numpy arrays."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
IntArray = npt.NDArray[np.int32]
"""Local numbers, and numbers that MPI and PETSc take with 32 bits."""
LongArray = npt.NDArray[np.int64]
"""Global numbers."""
