"""Book-keeping of heat: what each body holds and what went through each surface and interface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from castx.saved import Arrays, Saved
from castx.tables import FloatArray


@dataclass(frozen=True)
class Account:
    """One way by which heat enters or leaves bodies.

    Attributes:
        energy: names of the totals that count its heat: "mould/outside.heat".
        power: names of the totals that count its rate: "mould/outside.power".
        to: number of the body that the heat enters.
        origin: number of the body it comes from; None from outside.
    """

    energy: tuple[str, ...]
    power: tuple[str, ...]
    to: int
    origin: int | None = None

    @classmethod
    def through(cls, place: str, mechanism: str, to: int, origin: int | None = None) -> Account:
        """Return the account of a surface or an interface, or of one mechanism there.

        Args:
            place: "body/surface" or "secondary/primary".
            mechanism: its own totals are kept beside those of the place; "": there is only one.
            to: number of the body that the heat enters.
            origin: number of the body it comes from; None from outside.
        """
        energy, power = f"{place}.heat", f"{place}.power"
        if not mechanism:
            return cls((energy,), (power,), to, origin)
        return cls((energy, f"{energy}.{mechanism}"), (power, f"{power}.{mechanism}"), to, origin)

    @classmethod
    def source(cls, body: str, to: int) -> Account:
        """Return the account of the heat source inside a body."""
        return cls((f"{body}.source",), (f"{body}.power.source",), to)

    @classmethod
    def dissipation(cls, body: str, to: int) -> Account:
        """Return the account of the heat that plastic work leaves in a body."""
        return cls((f"{body}.dissipation",), (f"{body}.power.dissipation",), to)


class Ledger:
    """Heat by body and by mechanism since the start, full turn when axisymmetric [J].

    Numbers are the sums over all ranks. Trial numbers count only after `commit`.

    Args:
        bodies: names of the bodies.
        accounts: ways of the heat.
        enthalpy: of the bodies at the start.
    """

    def __init__(
        self, bodies: Sequence[str], accounts: Sequence[Account], enthalpy: FloatArray
    ) -> None:
        self._bodies = tuple(bodies)
        self._accounts = tuple(accounts)
        self._start = enthalpy.copy()
        # Rows of the state: enthalpies of the bodies, heat of the accounts, heat moved in all.
        self._committed = np.concatenate((enthalpy, np.zeros(len(accounts) + 1)))
        self._trial = self._committed.copy()
        self._duration = 0.0
        self._power = np.zeros(len(accounts))
        self._shares = np.zeros((len(bodies), len(accounts)))
        for column, account in enumerate(accounts):
            self._shares[account.to, column] += 1.0
            if account.origin is not None:
                self._shares[account.origin, column] -= 1.0

    def book(self, enthalpy: FloatArray, heat: FloatArray, moved: float, duration: float) -> None:
        """Add what a sub-step moved to the trial state.

        Args:
            enthalpy: of the bodies at its end [J].
            heat: through the accounts [J].
            moved: heat that changed place in all, the measure of errors [J].
            duration: of the sub-step [s].
        """
        self._trial[: len(self._bodies)] = enthalpy
        self._trial[len(self._bodies) : -1] += heat
        self._trial[-1] += moved
        self._duration += duration

    def commit(self) -> None:
        """Make the trial state the committed one."""
        if self._duration > 0.0:
            change = self._trial - self._committed
            self._power[:] = change[len(self._bodies) : -1] / self._duration
        self._committed[:] = self._trial
        self._duration = 0.0

    def rewind(self) -> None:
        """Forget the trial state."""
        self._trial[:] = self._committed
        self._duration = 0.0

    def saved(self) -> dict[str, Saved]:
        """Return the committed numbers."""
        state = {"start": self._start, "state": self._committed, "power": self._power}
        return {name: Saved(values.copy()) for name, values in state.items()}

    def restore(self, arrays: Arrays) -> None:
        """Take back committed numbers."""
        self._start[:], self._power[:] = arrays["start"], arrays["power"]
        self._committed[:] = arrays["state"]
        self.rewind()

    def totals(self) -> dict[str, float]:
        """Return the committed numbers by name.

        "BODY.enthalpy" [J], zero for the solid at 0 °C; "BODY.heat_in" [J] and "BODY.power" [W],
        through all mechanisms; the accounts by their names: heat [J], and power [W], the mean over
        the last step; "energy_error", the largest error of the balance of a body or of all,
        relative to the heat moved in all.
        """
        bodies = len(self._bodies)
        enthalpy, heat, moved = (
            self._committed[:bodies],
            self._committed[bodies:-1],
            self._committed[-1],
        )
        heat_in, power_in = self._shares @ heat, self._shares @ self._power
        errors = enthalpy - self._start - heat_in
        largest = max(np.abs(errors).max(), abs(errors.sum()))
        totals: dict[str, float] = {}
        for k, name in enumerate(self._bodies):
            totals[f"{name}.enthalpy"] = float(enthalpy[k])
            totals[f"{name}.heat_in"] = float(heat_in[k])
            totals[f"{name}.power"] = float(power_in[k])
        for account, energy, power in zip(self._accounts, heat, self._power, strict=True):
            for names, value in ((account.energy, energy), (account.power, power)):
                for name in names:
                    totals[name] = totals.get(name, 0.0) + float(value)
        totals["energy_error"] = float(largest / moved) if moved > 0.0 else 0.0
        return totals
