"""Book-keeping of heat: what each body holds and what went through each surface and interface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from castx.tables import FloatArray


@dataclass(frozen=True)
class Account:
    """One way by which heat enters or leaves bodies.

    Attributes:
        name: of the total: "mould/outside.heat", "casting/mould.heat", "casting.source".
        to: number of the body that the heat enters.
        origin: number of the body it comes from; None from outside.
    """

    name: str
    to: int
    origin: int | None = None


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
        self._shares = np.zeros((len(bodies), len(accounts)))
        for column, account in enumerate(accounts):
            self._shares[account.to, column] += 1.0
            if account.origin is not None:
                self._shares[account.origin, column] -= 1.0

    def book(self, enthalpy: FloatArray, heat: FloatArray, moved: float) -> None:
        """Add what a sub-step moved to the trial state.

        Args:
            enthalpy: of the bodies at its end [J].
            heat: through the accounts [J].
            moved: heat that changed place in all, the measure of errors [J].
        """
        self._trial[: len(self._bodies)] = enthalpy
        self._trial[len(self._bodies) : -1] += heat
        self._trial[-1] += moved

    def commit(self) -> None:
        """Make the trial state the committed one."""
        self._committed[:] = self._trial

    def rewind(self) -> None:
        """Forget the trial state."""
        self._trial[:] = self._committed

    def totals(self) -> dict[str, float]:
        """Return the committed numbers by name.

        "BODY.enthalpy" [J], zero for the solid at 0 °C; "BODY.heat_in" [J], through all mechanisms;
        the accounts by their names [J]; "energy_error", the largest error of the balance of a body
        or of all, relative to the heat moved in all.
        """
        bodies = len(self._bodies)
        enthalpy, heat, moved = (
            self._committed[:bodies],
            self._committed[bodies:-1],
            self._committed[-1],
        )
        heat_in = self._shares @ heat
        errors = enthalpy - self._start - heat_in
        largest = max(np.abs(errors).max(), abs(errors.sum()))
        totals = {}
        for name, stored, received in zip(self._bodies, enthalpy, heat_in, strict=True):
            totals[f"{name}.enthalpy"] = float(stored)
            totals[f"{name}.heat_in"] = float(received)
        for account, value in zip(self._accounts, heat, strict=True):
            totals[account.name] = totals.get(account.name, 0.0) + float(value)
        totals["energy_error"] = float(largest / moved) if moved > 0.0 else 0.0
        return totals
