"""From the surfaces of a case to heat conditions, and to the ways of heat of a whole run."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from castx.case.case import Case
from castx.heat.accounts import Account, Accounts, accounts_of, joined_accounts
from castx.heat.boundaries import SurfaceHeat


def surface_heats(case: Case, bodies: Collection[str]) -> list[SurfaceHeat]:
    """Return the heat conditions of a case.

    Args:
        case: the case, or what it asks for during a stage.
        bodies: of the whole run; a surface towards one of them bears its name.
    """
    return [
        SurfaceHeat(
            body=boundary.body,
            surface=boundary.surface,
            kind=condition.type,  # type: ignore[arg-type]
            value=condition.value,
            coefficient=condition.coefficient,
            ambient=condition.ambient,
            emissivity=condition.emissivity,
            bare=boundary.surface in bodies,
        )
        for boundary in case.boundaries
        for condition in boundary.heat
    ]


def run_accounts(case: Case, stages: Sequence[Case]) -> Accounts:
    """Return the accounts of all stages of a case.

    Args:
        case: the case.
        stages: what it asks for during each stage.
    """
    bodies = [body.name for body in case.bodies]
    renewed = case.stages[-1].renew if case.stages else ()
    parts = [_accounts(stage, bodies) for stage in stages]
    return joined_accounts(bodies, [*parts, [Account.renewal(name) for name in renewed]])


def _accounts(case: Case, bodies: Collection[str]) -> list[Account]:
    names = [body.name for body in case.bodies]
    between = [(interface.secondary, interface.primary) for interface in case.interfaces]
    return accounts_of(names, surface_heats(case, bodies), between)
