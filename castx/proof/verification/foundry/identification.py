"""F7: how well samples of a cooling body tell its heat-transfer coefficient.

T = T_a + (T_0 − T_a) e^(−ht/C): ∂T/∂ ln h = −(T_0 − T_a) τ e^(−τ) with τ = ht/C, ∂T/∂T_0 = e^(−τ).
With N samples of deviation σ the information of both is a matrix of three sums, inverted by
Cramer's rule; of one sample sd(ln h) = σ e^τ/(τ (T_0 − T_a)), least at τ = 1. Sums over evenly
spaced samples are geometric: Σ q^k, Σ k q^k, Σ k² q^k in closed form.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.foundry.identification.covariance import correlation, deviations
from castx.foundry.identification.descent import SETTLED
from castx.foundry.identification.fit import Unknown, fit
from castx.foundry.identification.lumped import LumpedCooling
from castx.proof.verification.verification import (
    MESHLESS,
    Answer,
    Comparison,
    Curve,
    Outcome,
    Resolution,
    Verification,
    fine,
)

BODY = LumpedCooling(2.6e4, 500.0, 600.0, 100.0)
SAMPLES, NOISE = 60, 1.0
"""One sample a second from 1 s on; standard deviation [K]."""


def sums() -> tuple[float, float, float]:
    """Return Σ q^k, Σ k q^k and Σ k² q^k for k from 1 to the number of samples, q = e^(−2h/C)."""
    q, n = float(np.exp(-2 * BODY.coefficient / BODY.capacity)), SAMPLES
    none = q * (1 - q**n) / (1 - q)
    one = q * (1 - (n + 1) * q**n + n * q ** (n + 1)) / (1 - q) ** 2
    whole = 1 + q - (n + 1) ** 2 * q**n + (2 * n**2 + 2 * n - 1) * q ** (n + 1)
    return none, one, q * (whole - n**2 * q ** (n + 2)) / (1 - q) ** 3


def uncertainty() -> tuple[float, float, float, float]:
    """Return sd(ln h) if T_0 is known; sd(ln h), sd(T_0) [K] and their correlation if not."""
    none, one, two = sums()
    rise, rate = BODY.start - BODY.ambient, BODY.coefficient / BODY.capacity
    squares, mixed = (rise * rate) ** 2 * two, -rise * rate * one
    determinant = squares * none - mixed**2
    both = (NOISE * np.sqrt(none / determinant), NOISE * np.sqrt(squares / determinant))
    return NOISE / np.sqrt(squares), *both, -mixed / np.sqrt(squares * none)


def by_one(time: FloatArray) -> FloatArray:
    """Return sd(ln h) from one sample."""
    tau = BODY.coefficient * np.asarray(time) / BODY.capacity
    return np.asarray(NOISE * np.exp(tau) / (tau * (BODY.start - BODY.ambient)))


def found_by_one(time: float) -> float:
    """Return sd(ln h) from one sample by the covariance."""
    return float(deviations(BODY.covariance(np.array([time]), NOISE))[0])


def fitted(time: FloatArray) -> float:
    """Return h by a fit to samples without noise, from four times as much [W/m²/K]."""

    def model(values: Mapping[str, float]) -> FloatArray:
        body = replace(BODY, coefficient=values["h"])
        return body.temperature(time)

    unknown = Unknown("h", 4.0 * BODY.coefficient, 0.01, positive=True)
    return fit(model, BODY.temperature(time), np.array(NOISE), [unknown]).values["h"]


def compare(at: Resolution, comm: MPI.Intracomm) -> Outcome:
    """Evaluate the covariances beside their closed forms."""
    time: FloatArray = np.arange(1, SAMPLES + 1, dtype=np.float64)
    alone, with_start, start, correlated = uncertainty()
    both = BODY.covariance(time, NOISE, start_known=False)
    known = deviations(BODY.covariance(time, NOISE))[0]
    logarithm, warm = deviations(both)
    best = BODY.capacity / BODY.coefficient
    answers = (
        Answer.relative("deviation of ln h, start known", known, alone, "", 1e-9),
        Answer.relative("deviation of ln h, start unknown", logarithm, with_start, "", 1e-9),
        Answer.relative("deviation of the start", warm, start, "K", 1e-9),
        Answer.relative("correlation of both", correlation(both)[0, 1], correlated, "", 1e-9),
        Answer.relative("best time of one sample", BODY.best_time, best, "s", 1e-12),
        Answer.relative("deviation of ln h from this sample", found_by_one(BODY.best_time),
                        float(by_one(np.array(best))), "", 1e-9),
        Answer.relative("coefficient by a fit without noise", fitted(time), BODY.coefficient,
                        "W/m²/K", SETTLED * alone),
    )  # fmt: skip
    times: FloatArray = np.linspace(15.0, 180.0, 34, dtype=np.float64)
    line = fine(15.0, 180.0)
    found = np.array([found_by_one(float(t)) for t in times])
    curve = Curve("one sample", times, 100 * found, line, 100 * by_one(line))
    return Outcome(
        answers,
        max(answer.error for answer in answers),
        Comparison("time of the sample [s]", "deviation of the coefficient [%]", (curve,)),
    )


VERIFICATION = Verification(
    number="F7",
    title="How well samples of a cooling body tell its coefficient",
    formula="C = (Jᵀ J/σ²)⁻¹, J = (−(T_0 − T_a) τ e^(−τ), e^(−τ)), τ = h t/C; sums of q^k, k q^k "
    "and k² q^k in closed form, two parameters by Cramer's rule; one sample is best at τ = 1",
    source="A. Tarantola, Inverse Problem Theory (2005), section 3.2; geometric sums",
    run=compare,
    levels=MESHLESS,
    quick=MESHLESS,
    refined="nothing",
)
