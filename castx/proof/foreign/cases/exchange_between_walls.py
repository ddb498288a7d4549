"""X1: two plates that exchange heat, steady."""

from __future__ import annotations

from mpi4py import MPI

from castx.proof.foreign.declaration import ForeignCase, Number
from castx.proof.verification.heat.plates import Plates
from castx.proof.verification.states import profile, states


def run(comm: MPI.Intracomm) -> tuple[Number, ...]:
    """Return the temperatures of both walls."""
    for state in states(comm, Plates().case(0.055)):
        cold = profile(state, "mould", "temperature")[1][-1]
        hot = profile(state, "casting", "temperature")[1][0]
    return (
        Number("T at x = 0.495 m, end", 166.442953, float(cold), 166.4429530, "°C", 1e-7, 200.0),
        Number("T at x = 0.505 m, end", 233.557047, float(hot), 233.5570470, "°C", 1e-7, 200.0),
    )


CASES = (
    ForeignCase(
        number="X1",
        title="Exchange between two walls",
        program="code_aster",
        path="TTLP100, V4.23.100 (reference problem and solution)",
        exact="thermal resistances in series, slope h 200/(λ + h (l1 + l2))",
        remark="The reference is analytical; linear elements are exact on it.",
        run=run,
    ),
)
