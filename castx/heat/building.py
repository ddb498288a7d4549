"""From a case to the parts of its heat problem: conditions, interfaces, temperatures, ledger."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from mpi4py import MPI

import numpy as np
import numpy.typing as npt

from castx.arrays import FloatArray
from castx.case.bodies import Body
from castx.case.case import Case
from castx.case.heat_transfer import InterfaceHeat
from castx.case.initial_temperature import FieldFile, InitialTemperature
from castx.case.interfaces import Interface
from castx.domain.mesh import BodyMesh, CastingMesh
from castx.domain.pairs.node_pairs import NodePairs
from castx.errors import CaseError
from castx.heat.boundaries import SurfaceHeat
from castx.heat.field_files import temperatures_at
from castx.heat.interface import HeatExchange
from castx.heat.ledger import Account, Accounts, accounts_of, divided_places, joined_accounts
from castx.input.problems import among
from castx.input.units import ABSOLUTE_ZERO
from castx.transfer.conductance import ConductionLaw
from castx.transfer.patched import PatchedLaw
from castx.transfer.radiation import facing_factor

FINEST_HEAT, COARSEST_HEAT = 1e-8, 1e-6
"""Tolerances of the heat balance that a case gets unless it names one."""

PASS_SHARE = 1e-3
"""Part of the tolerance of the passes to which they have their heat balanced."""


def surface_heats(case: Case, bodies: Collection[str]) -> list[SurfaceHeat]:
    """Return the heat conditions of a case.

    Args:
        case: the case, or what it asks for during a stage.
        bodies: of the whole run; a surface towards one of them has its name.
    """
    return [
        SurfaceHeat(
            body=boundary.body,
            surface=boundary.surface,
            condition=condition,
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
    divided = divided_places([surface_heats(stage, bodies) for stage in stages])
    renewed = case.stages[-1].renew if case.stages else ()
    parts = [_accounts(stage, bodies, divided) for stage in stages]
    renewals = [Account.renewal(name) for name in renewed]
    return joined_accounts(bodies, [*parts, renewals], divided)


def _accounts(case: Case, bodies: Collection[str], divided: Collection[str]) -> list[Account]:
    names = [body.name for body in case.bodies]
    between = [(interface.secondary, interface.primary) for interface in case.interfaces]
    return accounts_of(names, surface_heats(case, bodies), between, divided)


def heat_exchange(
    interface: Interface,
    pairs: NodePairs,
    mesh: CastingMesh,
    law: ConductionLaw | None = None,
) -> HeatExchange:
    """Return the exchange of heat at an interface.

    Args:
        interface: its description.
        pairs: its node pairs.
        mesh: of all bodies.
        law: of the conduction in place of the one described; radiation stays as described.

    Raises:
        CaseError: a patch holds none of its pairs, or has a name that the mesh lacks; on all ranks.
    """
    heat = interface.heat
    if law is not None:
        factor = _grey_factor(heat) if heat is not None else 0.0
        radiation = np.full(len(pairs.areas), factor) if factor > 0.0 else None
        return HeatExchange(interface.name, pairs, "law", law, radiation)
    if heat is None or heat.declared.exchange == "perfect":
        return HeatExchange(interface.name, pairs, "none" if heat is None else "perfect")
    if heat.declared.exchange == "none" and heat.radiation is None and not heat.patches:
        return HeatExchange(interface.name, pairs, "none")
    part_of = _parts_of_pairs(interface, heat, pairs, mesh)
    grey: FloatArray = np.array([_grey_factor(part) for part in heat.parts])
    laws = [part.conduction_law() for part in heat.parts]
    law = laws[0]
    if heat.patches:
        law = PatchedLaw([(np.flatnonzero(part_of == k), own) for k, own in enumerate(laws)])
    return HeatExchange(interface.name, pairs, "law", law, grey[part_of] if grey.any() else None)


def _parts_of_pairs(
    interface: Interface, heat: InterfaceHeat, pairs: NodePairs, mesh: CastingMesh
) -> npt.NDArray[np.intp]:
    """Return for each pair 0, or the number of its patch counted from 1."""
    part_of = np.zeros(len(pairs.areas), dtype=np.intp)
    for index, patch in reversed(list(enumerate(heat.patches))):
        if patch.on and patch.on not in mesh.marked:
            named = among(patch.on, sorted(mesh.marked), what="the mesh names")
            raise CaseError(
                f"interface {interface.name}: heat.patches[{index}].on = {patch.on!r}: no faces "
                f"between bodies with this name; {named}"
            )
        part_of[patch.contains(pairs.points, mesh.marked)] = index + 1
    for index in range(len(heat.patches)):
        if mesh.comm.allreduce(int(np.count_nonzero(part_of == index + 1))) == 0:
            raise CaseError(
                f"interface {interface.name}: heat.patches[{index}] adds no node: "
                "earlier patches already cover its place, or it is off the interface; check its "
                "place (within in m)"
            )
    return part_of


def _grey_factor(heat: InterfaceHeat) -> float:
    if heat.radiation is None:
        return 0.0
    factor = facing_factor if heat.curved is None else heat.curved.facing_factor
    return factor(heat.radiation.emissivities)


def initial_temperatures(
    description: InitialTemperature, body: BodyMesh, comm: MPI.Intracomm
) -> FloatArray:
    """Return the temperatures of the owned nodes of a body [°C], shape (owned,); collective.

    A file is read on rank 0, so that every number of ranks gives the same temperatures.

    Raises:
        CaseError: the file cannot serve, or a formula gives no temperature; on all ranks.
    """
    points = body.points[: body.nodes.dofmap.index_map.size_local]
    if description.file is None:
        return _checked(description, body.name, description.at(points), comm)
    return _from_rank_zero(description.file, body, points, comm)


def _checked(
    description: InitialTemperature, body: str, found: FloatArray, comm: MPI.Intracomm
) -> FloatArray:
    """Return temperatures of the owned nodes unless one of them is none; collective."""
    wrong = int(np.count_nonzero(~(np.isfinite(found) & (found >= ABSOLUTE_ZERO))))
    wrong = comm.allreduce(wrong)
    if wrong:
        text = "is not finite or below absolute zero (coordinates in m, result in °C)"
        raise CaseError(f"temperature of {body!r}: {description.text} {text} at {wrong} nodes")
    return found


def initial_state(bodies: Sequence[Body], mesh: CastingMesh) -> dict[str, FloatArray]:
    """Return the initial temperatures of the owned nodes of bodies [°C] by name; collective.

    Raises:
        CaseError: a file cannot serve; on all ranks.
    """
    return {
        body.name: initial_temperatures(body.temperature, mesh.bodies[body.name], mesh.comm)
        for body in bodies
    }


def _from_rank_zero(
    file: FieldFile, body: BodyMesh, points: FloatArray, comm: MPI.Intracomm
) -> FloatArray:
    gathered = comm.gather(points)
    parts, message = None, None
    if gathered is not None:
        try:
            values = temperatures_at(file, np.concatenate(gathered))
            parts = np.split(values, np.cumsum([len(part) for part in gathered])[:-1])
        except CaseError as error:
            message = f"initial temperature of {body.name!r}: {error}"
    message = comm.bcast(message)
    if message is not None:
        raise CaseError(message)
    return np.asarray(comm.scatter(parts))


def heat_tolerance(case: Case) -> float:
    """Return the relative tolerance of the heat balance of a case.

    Passes leave resistances unsettled by `coupling.tolerance`: what is much finer is lost in them.
    """
    given, coupling = case.solver.heat_tolerance, case.coupling
    if not isinstance(given, str):
        return given
    passes = coupling.scheme == "iterated"
    share = PASS_SHARE * coupling.tolerance if passes else 0.0
    return min(max(share, FINEST_HEAT), COARSEST_HEAT)
