"""From the surfaces of a case to heat conditions, and to the ways of heat of a whole run."""

from __future__ import annotations

from collections.abc import Collection

from castx.accounts import Account, Accounts, accounts_of, joined_accounts
from castx.case import Case
from castx.heat_boundaries import SurfaceHeat
from castx.schedule import Schedule
from castx.stage_cases import Surfaces, stage_case


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


def run_accounts(case: Case, surfaces: Surfaces) -> Accounts:
    """Return the accounts of all stages of a case.

    Args:
        case: the case.
        surfaces: of its mesh.

    Raises:
        CaseError: a stage cannot be run as described.
    """
    bodies = [body.name for body in case.bodies]
    stages = Schedule(case.stages, case.time.end).stages
    parts = [_accounts(stage_case(case, number, surfaces), bodies) for number in range(stages)]
    renewed = case.stages[-1].renew if case.stages else ()
    return joined_accounts(bodies, [*parts, [Account.renewal(name) for name in renewed]])


def _accounts(case: Case, bodies: Collection[str]) -> list[Account]:
    names = [body.name for body in case.bodies]
    between = [(interface.secondary, interface.primary) for interface in case.interfaces]
    return accounts_of(names, surface_heats(case, bodies), between)
