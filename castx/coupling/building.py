"""Building of the coupled problem from the descriptions of a case."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from mpi4py import MPI

import numpy as np

from castx.arrays import FloatArray
from castx.case.bodies import DARCY, IN_CELLS, Body
from castx.case.boundaries import Boundary
from castx.case.case import Case
from castx.case.interfaces import Interface
from castx.contact.choice import Contact
from castx.contact.kinematics.rigid import RigidBody, rigid_body
from castx.coupling.clamps import refuse_held_clamps, surface_clamps
from castx.coupling.interface import CoupledInterface
from castx.coupling.melt_flow import mush_metal, words_of
from castx.coupling.prescribed import PrescribedBody, PrescribedTemperatures
from castx.coupling.step import CoupledProblem
from castx.coupling.temperatures import Temperatures
from castx.domain.measures import nodal_sum, nodal_volumes
from castx.domain.mesh import CastingMesh
from castx.domain.pairs.node_pairs import NodePairs
from castx.equilibrium.building import MechanicsSettings
from castx.equilibrium.problem import MechanicalProblem
from castx.errors import CaseError, MeshError
from castx.heat.body import HeatBody
from castx.heat.building import heat_exchange, heat_tolerance, initial_state, surface_heats
from castx.heat.interface import HeatExchange
from castx.heat.ledger import Accounts
from castx.heat.problem import HeatProblem
from castx.input.problems import among, show
from castx.materials.granular import GRANULAR
from castx.materials.inelastic import LIQUID_RULES
from castx.materials.lookup import find_material
from castx.materials.material import Material
from castx.materials.thermal_strain import StressFreeState
from castx.mechanics.constitutive.law import ELASTIC, Law
from castx.mechanics.description import MechanicalBody, SurfaceLoad
from castx.mechanics.fixed_directions import SurfaceDisplacement
from castx.solvers.counters import StepCounters
from castx.tables import Table
from castx.transfer.conductance import ConductionLaw


def build_problem(
    case: Case,
    mesh: CastingMesh,
    pairs: dict[str, NodePairs],
    laws: Mapping[str, ConductionLaw] | None = None,
    accounts: Accounts | None = None,
    temperatures: Mapping[str, FloatArray] | None = None,
) -> CoupledProblem:
    """Return the coupled problem of a case.

    Args:
        case: the case.
        mesh: mesh of its bodies.
        pairs: node pairs by the name of the interface.
        laws: of the conduction through interfaces, in place of those of the case.
        accounts: of the heat of the whole run, if it has other stages.
        temperatures: initial ones of the owned nodes by body [°C], if they are known already.

    Raises:
        CaseError: the case cannot be solved as described.
        MeshError: a surface is missing.
    """
    materials = {b.name: find_material(b.material, case.materials) for b in case.bodies}
    scheme = case.coupling.scheme
    contacts = [i for i in case.interfaces if i.contact.method != "none"]
    mechanics, counters = None, StepCounters()
    known = temperatures
    if scheme != "mechanical" and known is None:
        known = initial_state(case.bodies, mesh)
    if scheme != "thermal" and any(b.law != "rigid" for b in case.bodies):
        placed = [pairs[i.name] for i in contacts]
        free = {b.name: _stress_free(b, mesh, materials[b.name], known) for b in case.bodies}
        mechanics = _mechanics(case, mesh, materials, free, contacts, placed, counters)
    own = dict(laws or {})
    _check_laws(case, own)
    exchanges = [heat_exchange(i, pairs[i.name], mesh, own.get(i.name)) for i in case.interfaces]
    heat: Temperatures
    if scheme == "mechanical":
        given = {b.name: PrescribedBody(materials[b.name], _history(b)) for b in case.bodies}
        heat = PrescribedTemperatures(mesh, given, exchanges)
    else:
        assert known is not None
        heat = _heat(case, mesh, materials, exchanges, known, accounts, counters)
    interfaces = [
        CoupledInterface(
            interface.name,
            pairs[interface.name],
            contacts.index(interface) if mechanics is not None and interface in contacts else None,
            _contact(interface).clearance if interface in contacts else 0.0,
        )
        for interface in case.interfaces
    ]
    volumes = {name: nodal_volumes(body, mesh.model) for name, body in mesh.bodies.items()}
    coupling = case.coupling
    return CoupledProblem(
        mesh.comm, heat, mechanics, interfaces, volumes, scheme, coupling.tolerance,
        coupling.passes, counters,
    )  # fmt: skip


def check_surfaces(case: Case, mesh: CastingMesh) -> None:
    """Check that all surfaces named in the case exist, those of later stages included.

    Raises:
        MeshError: one is missing; names the key.
    """
    for place, on in _named_surfaces(case):
        body, _, surface = on.partition("/")
        try:
            mesh.bodies[body].surface_tag(surface)
        except MeshError as error:
            text = f"{place} = {show(on)}: {error}; use one of them, or name it in the mesh"
            raise MeshError(text) from None


def _named_surfaces(case: Case) -> Iterator[tuple[str, str]]:
    """Yield the place in the case and the name of each surface that the user names."""
    for index, boundary in enumerate(case.boundaries):
        yield f"boundaries[{index}].on", boundary.on
    for key in ("feeders", "flat", "round"):
        for index, on in enumerate(getattr(case.foundry, key) or ()):
            yield f"foundry.{key}[{index}]", on
    for number, stage in enumerate(case.stages):
        for index, boundary in enumerate(stage.boundaries):
            yield f"stages[{number}].boundaries[{index}].on", boundary.on
        for index, on in enumerate(stage.spray.on if stage.spray is not None else ()):
            if "/" in on:
                yield f"stages[{number}].spray.on[{index}]", on


def _check_laws(case: Case, laws: Mapping[str, ConductionLaw]) -> None:
    names = [interface.name for interface in case.interfaces]
    for name in laws:
        if name not in names:
            raise CaseError(f"a law for the interface {name!r}; {among(name, names)}")


def _history(body: Body) -> Table:
    return body.temperature_history or Table.constant(_uniform(body))


def _uniform(body: Body) -> float:
    """Return the initial temperature of a body where only one number will do."""
    uniform = body.temperature.uniform
    return math.nan if uniform is None else uniform  # refused where nothing else is known


def _heat(
    case: Case,
    mesh: CastingMesh,
    materials: dict[str, Material],
    exchanges: list[HeatExchange],
    temperatures: Mapping[str, FloatArray],
    accounts: Accounts | None,
    counters: StepCounters,
) -> HeatProblem:
    bodies = [
        HeatBody(
            b.name, materials[b.name], temperatures[b.name], b.heat_source, b.freezing == IN_CELLS
        )
        for b in case.bodies
    ]
    solver = case.solver
    everybody = accounts.bodies if accounts is not None else list(mesh.bodies)
    return HeatProblem(
        mesh, bodies, exchanges, surface_heats(case, everybody),
        tolerance=heat_tolerance(case), linear=solver.linear,  # type: ignore[arg-type]
        options=solver.heat, accounts=accounts, counters=counters,
    )  # fmt: skip


def _mechanics(
    case: Case,
    mesh: CastingMesh,
    materials: dict[str, Material],
    stress_free: dict[str, StressFreeState],
    contacts: list[Interface],
    pairs: list[NodePairs],
    counters: StepCounters,
) -> MechanicalProblem:
    bodies = {
        b.name: _mechanical_body(case, mesh, b, materials[b.name], stress_free[b.name])
        for b in case.bodies
        if b.law != "rigid"
    }
    displacements = prescribed_displacements(case)
    solver = case.solver
    settings = MechanicsSettings(
        solver.linear,
        solver.mechanics_tolerance,
        case.support.mode == "automatic",
        {**solver.mechanics, **{f"bodies_{k}": v for k, v in solver.contact.items()}},
        case.support.by_body(),
    )
    described = [_contact(i) for i in contacts]
    return MechanicalProblem(mesh, bodies, displacements, described, settings, counters, pairs)


def prescribed_displacements(case: Case) -> dict[str, list[SurfaceDisplacement]]:
    """Return the displacement conditions of a case by body."""
    found: dict[str, list[SurfaceDisplacement]] = {b.name: [] for b in case.bodies}
    for boundary in case.boundaries:
        for condition in boundary.displacement:
            found[boundary.body].append(
                SurfaceDisplacement(boundary.surface, condition.direction, condition.value)
            )
    return found


def rigid_bodies(case: Case, mesh: CastingMesh) -> dict[str, RigidBody]:
    """Return the rigid bodies of a case; none without mechanics.

    Raises:
        CaseError: displacement conditions that a rigid body cannot follow.
    """
    if case.coupling.scheme == "thermal":
        return {}
    given = prescribed_displacements(case)
    return {name: rigid_body(name, mesh.model, given[name]) for name in case.rigid_bodies}


def check_clamps(case: Case, mesh: CastingMesh) -> None:
    """Refuse clamps that press on nothing, see `refuse_held_clamps`; collective."""
    refuse_held_clamps(case, mesh, prescribed_displacements(case))


def _contact(interface: Interface) -> Contact:
    wanted = interface.contact
    return Contact(
        interface.secondary,
        interface.primary,
        wanted.method,
        settings=wanted.settings,
        fallback=wanted.fallback,
        pairing=wanted.pairing_rule,
        friction=wanted.friction,
    )


def _stress_free(
    body: Body, mesh: CastingMesh, material: Material, known: Mapping[str, FloatArray] | None
) -> StressFreeState:
    """Return the state without thermal strain that follows from the start of a body; collective."""
    uniform = body.temperature.uniform
    if uniform is not None:
        return StressFreeState.at_start(material, uniform, uniform)
    assert known is not None
    there, owned = mesh.bodies[body.name], known[body.name]
    values = np.zeros(len(there.parent_vertices))
    values[: len(owned)] = owned
    hottest = mesh.comm.allreduce(float(owned.max(initial=-np.inf)), op=MPI.MAX)
    return StressFreeState.at_start(material, nodal_sum(there, values), hottest)


def _solved_material(mesh: CastingMesh, body: Body, material: Material) -> Material:
    """Return the material of a body, without liquid where its formulation has none."""
    if formulation_of(mesh, body) != "displacement" or material.liquid is None:
        return material
    if not body.starts_solid(material.description):
        own = _own_formulation(mesh, body)
        cure = f"use formulation {own!r}"
        if own == "displacement":
            cure = (
                f"in the model {mesh.model!r} it needs triangles and the law {ELASTIC!r}; else "
                "take the model 'generalised-plane-strain', or a material that extends "
                f'{body.material!r} with liquid = "none"'
            )
        raise CaseError(
            f"body {body.name!r} has formulation 'displacement', but its material "
            f"{body.material!r} has a liquid, which is incompressible; {cure}"
        )
    return material.without_liquid()


def _mechanical_body(
    case: Case, mesh: CastingMesh, body: Body, material: Material, stress_free: StressFreeState
) -> MechanicalBody:
    mush = mush_metal(case, body, material, formulation_of(mesh, body))
    material = _solved_material(mesh, body, material)
    if mush is not None:
        material = material.without_shrinkage()
    own = [boundary for boundary in case.boundaries if boundary.body == body.name]
    return MechanicalBody(
        Law(material, stress_free, body.law, body.freezing == IN_CELLS),
        formulation_of(mesh, body),
        body.stabilisation,
        tuple(material.density * g for g in case.loads.gravity) if any(case.loads.gravity) else (),
        tuple(load for boundary in own for load in _loads(boundary)),
        material.liquid is not None,
        clamps=surface_clamps(own, mesh.model),
        mush=mush,
    )


def laws_above_solidus(case: Case, mesh: CastingMesh) -> list[str]:
    """Describe in words how the bodies that melt behave below full solidity.

    Raises:
        CaseError: a body cannot be solved as described.
    """
    if case.coupling.scheme == "thermal":
        return []
    solved = [
        (body, _solved_material(mesh, body, find_material(body.material, case.materials)))
        for body in case.bodies
        if body.law != "rigid"
    ]
    lines = [
        law_above_solidus(body.name, material, poured=body.is_poured(material))
        for body, material in solved
        if material.melts
    ]
    for body in case.bodies:
        if body.feeding == DARCY:
            given = find_material(body.material, case.materials)
            metal = mush_metal(case, body, given, formulation_of(mesh, body))
            lines += [] if metal is None else [words_of(body.name, metal)]
    return lines


def law_above_solidus(body: str, material: Material, *, poured: bool = True) -> str:
    """Describe in words how a melting material behaves below full solidity.

    Args:
        body: its name.
        material: of the body.
        poured: whether it is liquid at the start; a chill melts only if it gets so hot.
    """
    liquid = material.liquid
    if liquid is None:
        return f"{body}: {material.name} keeps its solid's law at every temperature, without liquid"
    name = material.name if poured else f"should it melt, {material.name}"
    flow = "flows with its viscosity"
    if not liquid.is_newtonian:
        flow = f"creeps by {LIQUID_RULES[liquid.model].title}"
    if material.is_isothermal:
        place = f"ahead of its front at {material.solidus:g} °C; its coherency has no meaning there"
        return f"{body}: {name} {flow} {place}"
    return f"{body}: {name} {flow} below a solid fraction of {liquid.coherency:g}"


def formulation_of(mesh: CastingMesh, body: Body) -> str:
    """Return the formulation of a body, by default the usual one of its cells.

    Raises:
        CaseError: cells or model have no such formulation.
    """
    kind, own = mesh.bodies[body.name].kind, _own_formulation(mesh, body)
    formulation = body.formulation or own
    if body.law == GRANULAR and mesh.model == "plane-stress":
        raise CaseError(
            f"body {body.name!r}: the law {GRANULAR!r} has no plane stress; use the model "
            "'generalised-plane-strain', or the law 'rigid'"
        )
    if formulation == "taylor-hood" and own == "mixed":
        return formulation
    if formulation not in (own, "displacement"):
        raise CaseError(
            f"body {body.name!r} has formulation {formulation!r}; with the law {body.law!r} "
            f"{kind.plural} in the model {mesh.model!r} have "
            f"{' or '.join(dict.fromkeys((repr(own), repr('displacement'))))}"
        )
    return formulation


def _own_formulation(mesh: CastingMesh, body: Body) -> str:
    """Return the formulation that a body has by default."""
    simplex = mesh.bodies[body.name].kind.simplex
    if mesh.model == "plane-stress" and (not simplex or body.law != ELASTIC):
        # Nothing locks, since the volume is free; and a pressure of its own may be more than a
        # yielding point can balance out of the plane.
        return "displacement"
    if body.law == GRANULAR:
        # The mean stress yields, at each point by its own strain.
        return "displacement"
    return "mixed" if simplex else "q1p0"


def _loads(boundary: Boundary) -> Iterator[SurfaceLoad]:
    if boundary.pressure is not None:
        yield SurfaceLoad(boundary.surface, pressure=boundary.pressure)
    if boundary.traction is not None:
        yield SurfaceLoad(boundary.surface, traction=boundary.traction)
