"""Book-keeping of heat: the accounts by which it enters and leaves bodies, and their contents."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.heat.body import ThermalBody
from castx.heat.boundaries import SurfaceHeat
from castx.heat.interface import MECHANISMS
from castx.stateful import Arrays, Saved


@dataclass(frozen=True)
class Account:
    """One way by which heat enters or leaves bodies.

    Attributes:
        energy: names of the totals that count its heat: "mould/outside.heat".
        power: names of the totals that count its rate: "mould/outside.power".
        to: the body that the heat enters.
        origin: the body it comes from; None from outside.
    """

    energy: tuple[str, ...]
    power: tuple[str, ...]
    to: str
    origin: str | None = None

    @classmethod
    def through(cls, place: str, mechanism: str, to: str, origin: str | None = None) -> Account:
        """Return the account of a surface or an interface, or of one mechanism there.

        Args:
            place: "body/surface" or "secondary/primary".
            mechanism: its own totals are kept beside those of the place; "": there is only one.
            to: the body that the heat enters.
            origin: the body it comes from; None from outside.
        """
        energy, power = f"{place}.heat", f"{place}.power"
        if not mechanism:
            return cls((energy,), (power,), to, origin)
        return cls((energy, f"{energy}.{mechanism}"), (power, f"{power}.{mechanism}"), to, origin)

    @classmethod
    def source(cls, body: str) -> Account:
        """Return the account of the heat source inside a body."""
        return cls((f"{body}.source",), (f"{body}.power.source",), body)

    @classmethod
    def dissipation(cls, body: str) -> Account:
        """Return the account of the heat that plastic work leaves in a body."""
        return cls((f"{body}.dissipation",), (f"{body}.power.dissipation",), body)

    @classmethod
    def renewal(cls, body: str) -> Account:
        """Return the account of the heat of a new casting minus the heat of the one before."""
        return cls((f"{body}.renewal",), (), body)


@dataclass(frozen=True)
class Accounts:
    """The accounts of a whole run, of which one stage may use a part.

    Attributes:
        bodies: all bodies.
        entries: the accounts, each once.
        divided: places of surfaces whose heat every stage books by type.
    """

    bodies: tuple[str, ...]
    entries: tuple[Account, ...]
    divided: frozenset[str] = frozenset()


def joined_accounts(
    bodies: Sequence[str],
    parts: Iterable[Iterable[Account]],
    divided: frozenset[str] = frozenset(),
) -> Accounts:
    """Return the accounts of several stages, each once."""
    found = dict.fromkeys(account for part in parts for account in part)
    return Accounts(tuple(bodies), tuple(found), divided)


def divided_places(stages: Iterable[Sequence[SurfaceHeat]]) -> frozenset[str]:
    """Return the places of surfaces with several conditions at once, or one type after another.

    Every stage books their heat by type, so that the parts add up to the whole.

    Args:
        stages: the heat conditions of each stage.
    """
    found, types = set[str](), defaultdict[str, set[str]](set)
    for surfaces in stages:
        passing = [surface for surface in surfaces if _passes_heat(surface)]
        places = [surface.place for surface in passing]
        found |= {place for place in places if places.count(place) > 1}
        for surface in passing:
            types[surface.place].add(surface.condition.type)
    return frozenset(found | {place for place, own in types.items() if len(own) > 1})


def _passes_heat(surface: SurfaceHeat) -> bool:
    return surface.gives_flux or surface.gives_temperature


def accounts_of(
    bodies: Sequence[str],
    surfaces: Sequence[SurfaceHeat],
    interfaces: Sequence[tuple[str, str]],
    divided: Collection[str],
) -> list[Account]:
    """Return the accounts of a heat problem in the order of its flows.

    Args:
        bodies: of the problem.
        surfaces: its heat conditions.
        interfaces: secondary and primary bodies that exchange heat.
        divided: places of surfaces whose heat is booked by type.
    """
    accounts = [Account.source(name) for name in bodies]
    accounts += [Account.dissipation(name) for name in bodies]
    ordered = [surface for surface in surfaces if surface.gives_flux]
    ordered += [surface for surface in surfaces if surface.gives_temperature]
    for surface in ordered:
        mechanism = surface.condition.type if surface.place in divided else ""
        accounts.append(Account.through(surface.place, mechanism, surface.body))
    for secondary, primary in interfaces:
        place = f"{secondary}/{primary}"
        accounts += [Account.through(place, way, primary, secondary) for way in MECHANISMS]
    return accounts


class Ledger:
    """Heat by body and by mechanism since the start, full turn when axisymmetric [J].

    Numbers are the sums over all ranks. Trial numbers count only after `commit`.

    Args:
        run: bodies and accounts of the whole run, which has a stage after the other.
        bodies: the bodies of the present stage; contents of others do not change.
        own: accounts of the present stage, in the order in which their heat is booked.
        enthalpy: of the bodies of the stage at the start [J].
    """

    def __init__(
        self, run: Accounts, bodies: Sequence[str], own: Sequence[Account], enthalpy: FloatArray
    ) -> None:
        self._bodies, self._accounts = run.bodies, run.entries
        self._rows = np.array([run.bodies.index(name) for name in bodies])
        self._columns = np.array([run.entries.index(account) for account in own], dtype=np.intp)
        self._start = np.zeros(len(run.bodies))
        self._start[self._rows] = enthalpy
        # Rows of the state: enthalpies of the bodies, heat of the accounts, heat moved in all.
        self._committed = np.concatenate((self._start, np.zeros(len(run.entries) + 1)))
        self._trial = self._committed.copy()
        self._duration = 0.0
        self._power = np.zeros(len(run.entries))
        self._shares = np.zeros((len(run.bodies), len(run.entries)))
        for column, account in enumerate(run.entries):
            self._shares[run.bodies.index(account.to), column] += 1.0
            if account.origin is not None:
                self._shares[run.bodies.index(account.origin), column] -= 1.0

    @property
    def ways(self) -> int:
        """Number of accounts of the present stage."""
        return len(self._columns)

    def renew(self, enthalpy: FloatArray) -> None:
        """Book the contents of bodies that new ones have replaced.

        Args:
            enthalpy: of the bodies of the stage [J].
        """
        heat = self._trial[len(self._bodies) : -1]
        for row, stored in zip(self._rows, enthalpy, strict=True):
            account = Account.renewal(self._bodies[row])
            if account in self._accounts:
                heat[self._accounts.index(account)] += stored - self._trial[row]
        self._trial[self._rows] = enthalpy

    def book(self, enthalpy: FloatArray, heat: FloatArray, moved: float, duration: float) -> None:
        """Add the heat of a sub-step to the trial state.

        Args:
            enthalpy: of the bodies of the stage at its end [J].
            heat: through its accounts [J].
            moved: heat that changed place in all, the measure of errors [J].
            duration: of the sub-step [s].
        """
        self._trial[self._rows] = enthalpy
        np.add.at(self._trial[len(self._bodies) : -1], self._columns, heat)
        self._trial[-1] += moved
        self._duration += duration

    def commit(self) -> None:
        """Accept the trial state."""
        if self._duration > 0.0:
            change = self._trial - self._committed
            self._power[:] = change[len(self._bodies) : -1] / self._duration
        self._committed[:] = self._trial
        self._duration = 0.0

    def rewind(self) -> None:
        """Discard the trial state."""
        self._trial[:] = self._committed
        self._duration = 0.0

    def saved(self) -> dict[str, Saved]:
        """Return the committed numbers."""
        state = {"start": self._start, "state": self._committed, "power": self._power}
        return {name: Saved(values.copy()) for name, values in state.items()}

    def restore(self, arrays: Arrays) -> None:
        """Restore committed numbers."""
        self._start[:], self._power[:] = arrays["start"], arrays["power"]
        self._committed[:] = arrays["state"]
        self.rewind()

    def totals(self) -> dict[str, float]:
        """Return the committed numbers by name.

        "BODY.enthalpy" [J], zero for the solid at 0 °C; "BODY.heat_in" [J], what new bodies bring
        included, and "BODY.power" [W], through all mechanisms; the accounts by their names: heat
        [J], and power [W], the mean over the last step; "energy_error", the largest error of the
        balance of a body or of all, relative to the heat moved in all.
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


class HeatBooks:
    """Book-keeping of a stage: the heat of its bodies, summed over all ranks.

    Args:
        comm: all ranks.
        bodies: of the stage.
        own: accounts of the stage, in the order in which their heat is booked.
        run: bodies and accounts of the whole run; None: those of the stage.
    """

    def __init__(
        self,
        comm: MPI.Intracomm,
        bodies: Sequence[ThermalBody],
        own: Sequence[Account],
        run: Accounts | None,
    ) -> None:
        self._comm, self._bodies = comm, bodies
        names = [body.name for body in bodies]
        run = run or joined_accounts(names, [own])
        self.ledger = Ledger(run, names, own, self._stored_heat())

    def _stored_heat(self) -> FloatArray:
        return self._sums(np.array([body.stored_heat() for body in self._bodies]))

    def _sums(self, values: FloatArray) -> FloatArray:
        """Return the sums over all ranks, the same bits on each."""
        return np.asarray(sum(self._comm.allgather(values)))

    def begin_stage(self, equalise: Callable[[], FloatArray]) -> None:
        """Book the heat of renewed bodies, and that which perfect contact exchanges at once.

        Args:
            equalise: brings nodes in perfect contact to one temperature; returns the heat through
                each interface on this rank [J].
        """
        self.ledger.renew(self._stored_heat())
        evened = equalise()
        through = np.zeros((len(evened), len(MECHANISMS)))
        through[:, 0] = evened
        heat = self._sums(np.append(np.zeros(self.ledger.ways - through.size), through))
        self.ledger.book(self._stored_heat(), heat, float(np.abs(heat).sum()), 0.0)

    def book(self, flows: FloatArray, moved: float, duration: float) -> None:
        """Book a sub-step.

        Args:
            flows: rates of heat through the accounts of the stage on this rank [W].
            moved: rate of the heat that changes place in all [W].
            duration: of the sub-step [s].
        """
        heat = duration * self._sums(flows)
        self.ledger.book(self._stored_heat(), heat, duration * moved, duration)
