"""The ways by which heat enters and leaves bodies, and the names of their totals."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from castx.heat.boundaries import FLUXES, SurfaceHeat
from castx.heat.interface import MECHANISMS


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
        """Return the account of what a new casting brings more than the one it replaces took."""
        return cls((f"{body}.renewal",), (), body)


@dataclass(frozen=True)
class Accounts:
    """The accounts of a whole run, of which one stage may use a part.

    Attributes:
        bodies: all bodies.
        entries: the accounts, each once.
    """

    bodies: tuple[str, ...]
    entries: tuple[Account, ...]


def joined_accounts(bodies: Sequence[str], parts: Iterable[Iterable[Account]]) -> Accounts:
    """Return the accounts of several stages, each once."""
    found = dict.fromkeys(account for part in parts for account in part)
    return Accounts(tuple(bodies), tuple(found))


def accounts_of(
    bodies: Sequence[str],
    surfaces: Sequence[SurfaceHeat],
    interfaces: Sequence[tuple[str, str]],
) -> list[Account]:
    """Return the accounts of a heat problem in the order of its flows.

    Args:
        bodies: of the problem.
        surfaces: its heat conditions.
        interfaces: secondary and primary bodies that exchange heat.
    """
    accounts = [Account.source(name) for name in bodies]
    accounts += [Account.dissipation(name) for name in bodies]
    ordered = [s for s in surfaces if s.kind in FLUXES]
    ordered += [s for s in surfaces if s.kind == "temperature"]
    places = [condition.place for condition in ordered]
    for condition in ordered:
        mechanism = condition.kind if places.count(condition.place) > 1 else ""
        accounts.append(Account.through(condition.place, mechanism, condition.body))
    for secondary, primary in interfaces:
        place = f"{secondary}/{primary}"
        accounts += [Account.through(place, way, primary, secondary) for way in MECHANISMS]
    return accounts
