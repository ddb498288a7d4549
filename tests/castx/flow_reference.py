"""J2 viscoplasticity once more, in 3 × 3 tensors and rates: what the return mapping must tend to.

Nothing here knows the return mapping or `castx.materials.flow`. The rate of each flow rule is
written once more in the test file of the rule, `tests/castx/materials/flow_rules/test_NAME.py`:

    rate(f, values, temperature)    rate [1/s] under an overstress [Pa], plain numbers
    drawn(draw, stress, rate, temperature)    values of its keys that flow at a rate under a stress
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from types import ModuleType

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, root

from castx.materials.inelastic import FLOW_RULES

PROJECT = Path(__file__).parents[2]
PLASTIC_FLOW = "plastic"
LAWS = (PLASTIC_FLOW, *FLOW_RULES)
"""What a solid may do: flow independently of the rate, or by a flow rule."""

PLACES = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))

Tensor = np.ndarray


def file_of(law: str) -> str:
    """Return the path of the test file of a flow rule."""
    return f"tests/castx/materials/flow_rules/test_{law.replace('-', '_')}.py"


TEST_FILES = {
    law: import_module(file_of(law).removesuffix(".py").replace("/", "."))
    for law in FLOW_RULES
    if (PROJECT / file_of(law)).is_file()
}
"""The test files that there are, by the flow rule."""


def reference(law: str) -> ModuleType:
    """Return the test file of a flow rule; a test fails without it, or what it must hold."""
    file, needs = file_of(law), "it needs rate and drawn, as tests/castx/flow_reference.py says"
    assert law in TEST_FILES, f"the flow rule {law!r} has no test file {file}: write it; {needs}"
    missing = [name for name in ("rate", "drawn") if not hasattr(TEST_FILES[law], name)]
    assert not missing, f"{file} has no {' and no '.join(missing)}; {needs}"
    return TEST_FILES[law]


@dataclass(frozen=True)
class Numbers:
    """A material at one temperature [°C]; `law` as in a case file, or "plastic"."""

    law: str
    shear_modulus: float = 26e9
    yield_stress: float = 0.0
    linear: float = 0.0
    saturation: float = 0.0
    saturation_rate: float = 1.0
    kinematic: float = 0.0
    values: dict[str, float] = field(default_factory=dict)
    temperature: float = 300.0

    @property
    def keys(self) -> dict:
        """The keys of the case format that a material needs."""
        shared = {"young_modulus": 2.6 * self.shear_modulus, "poisson_ratio": 0.3}
        if not self.yields:
            return shared | {"law": self.law, **self.values}
        hardening = {
            "linear": self.linear,
            "saturation": self.saturation,
            "rate": self.saturation_rate,
        }
        solid = shared | {
            "yield_stress": self.yield_stress,
            "hardening": hardening,
            "kinematic_hardening": self.kinematic,
        }
        return solid | ({} if self.law == PLASTIC_FLOW else {"law": self.law, **self.values})

    @property
    def yields(self) -> bool:
        """Whether the material has a yield stress and hardens."""
        return self.law == PLASTIC_FLOW or FLOW_RULES[self.law].threshold

    @property
    def back_modulus(self) -> float:
        return self.kinematic if self.yields else 0.0

    def hardening(self, equivalent: float) -> float:
        if not self.yields:
            return 0.0
        return self.linear * equivalent + self.saturation * (
            1.0 - np.exp(-self.saturation_rate * equivalent)
        )

    def hardening_slope(self, equivalent: float) -> float:
        return self.linear + self.saturation * self.saturation_rate * np.exp(
            -self.saturation_rate * equivalent
        )

    def overstress(self, q: float, equivalent: float) -> float:
        threshold = self.yield_stress if self.yields else 0.0
        return q - threshold - self.hardening(equivalent)

    def rate(self, f: float) -> float:
        """Rate of the equivalent viscoplastic strain."""
        return float(reference(self.law).rate(max(f, 0.0), self.values, self.temperature))

    def driving_stress(self, rate: float) -> float:
        """Overstress at which the material flows at a rate, the inverse of `rate`."""
        if self.law == PLASTIC_FLOW or rate <= 0.0:
            return 0.0
        goal = np.log(rate)

        def excess(logarithm: float) -> float:
            with np.errstate(divide="ignore"):
                return float(np.log(self.rate(np.exp(logarithm))) - goal)

        low, high = np.log(1e6), np.log(1e6)
        while excess(low) > 0.0:
            low -= 2.0
        while excess(high) < 0.0:
            high += 2.0
        return float(np.exp(brentq(excess, low, high, xtol=1e-14, rtol=1e-15)))


def tensor(components: np.ndarray) -> Tensor:
    """Return the 3 × 3 tensor of 4 or 6 components."""
    result = np.zeros((3, 3))
    for (i, j), value in zip(PLACES, components, strict=False):
        result[i, j] = result[j, i] = value
    return result


def components(full: Tensor, number: int = 6) -> np.ndarray:
    return np.array([full[place] for place in PLACES[:number]])


def norm(full: Tensor) -> float:
    return float(np.sqrt(np.tensordot(full, full)))


def implicit_step(
    numbers: Numbers, trial: Tensor, back: Tensor, equivalent: float, step: float, guess: tuple
) -> tuple[Tensor, float]:
    """Return stress and increment that fulfil all tensor equations of an implicit Euler step.

    The search starts from a guess of both.
    """
    unit, strain = norm(trial - back), guess[1]
    hk = numbers.back_modulus

    def residual(unknown: np.ndarray) -> np.ndarray:
        stress, beta = tensor(unknown[:6]) * unit, tensor(unknown[6:12]) * unit
        increment = unknown[12] * strain
        q = np.sqrt(1.5) * norm(stress - beta)
        flow = 1.5 * increment * (stress - beta) / q
        f = numbers.overstress(q, equivalent + increment)
        return np.concatenate(
            (
                components(stress - trial + 2.0 * numbers.shear_modulus * flow) / unit,
                components(beta - back - 2.0 / 3.0 * hk * flow) / unit,
                [(f - numbers.driving_stress(increment / step)) / unit],
            )
        )

    direction = (trial - back) / norm(trial - back)
    beta = back + np.sqrt(2.0 / 3.0) * hk * guess[1] * direction
    start = np.concatenate(
        (components(guess[0]) / unit, components(beta) / unit, [guess[1] / strain])
    )
    found = root(residual, start, tol=1e-15)
    assert np.abs(residual(found.x)).max() < 1e-12
    return tensor(found.x[:6]) * unit, float(found.x[12] * strain)


def integrate(
    at: Callable[[float], Numbers], strain: Callable[[float], Tensor], end: float
) -> tuple[Tensor, float]:
    """Return deviatoric stress and ξ at the end of a strain path, to a relative 1e-10.

    Strains are integrated more closely, since stresses come from small differences of them.

    The plastic law flows at the rate that keeps f = 0, from the event f = 0 on.

    Args:
        at: the material over time [s], whose temperature may change.
        strain: deviatoric, over time.
        end: [s].
    """

    def stresses(time: float, state: np.ndarray) -> tuple[Tensor, Tensor]:
        """Return s and s − β."""
        flowed, numbers = tensor(state[:6]), at(time)
        stress = 2.0 * numbers.shear_modulus * (strain(time) - flowed)
        return stress, stress - 2.0 / 3.0 * numbers.back_modulus * flowed

    def overstress(time: float, state: np.ndarray) -> float:
        return at(time).overstress(np.sqrt(1.5) * norm(stresses(time, state)[1]), state[6])

    def flow(time: float, state: np.ndarray) -> np.ndarray:
        shifted = stresses(time, state)[1]
        direction = np.sqrt(1.5) * components(shifted) / max(norm(shifted), 1e-300)
        return rate(time, state) * np.append(direction, 1.0)

    def viscous(time: float, state: np.ndarray) -> float:
        return at(time).rate(overstress(time, state))

    def plastic(time: float, state: np.ndarray) -> float:
        h, numbers = 1e-4 * end, at(time)
        near, far = (
            overstress(time + k * h, state) - overstress(time - k * h, state) for k in (1, 2)
        )
        loading = (8.0 * near - far) / (12.0 * h)
        elastic = 3.0 * numbers.shear_modulus + numbers.back_modulus
        return max(loading / (elastic + numbers.hardening_slope(state[6])), 0.0)

    accuracy = {"rtol": 1e-11, "atol": 1e-16, "method": "LSODA"}
    rate, state, begin = viscous, np.zeros(7), 0.0
    if at(0.0).law == "plastic":
        rate, accuracy["method"] = plastic, "DOP853"
        overstress.terminal, overstress.direction = True, 1.0  # type: ignore[attr-defined]
        elastic = solve_ivp(
            lambda time, state: np.zeros(7), (0.0, end), state, events=overstress, **accuracy
        )
        begin, state = elastic.t[-1], elastic.y[:, -1]
    if begin < end:
        state = solve_ivp(flow, (begin, end), state, **accuracy).y[:, -1]
    return stresses(end, state)[0], float(state[6])
