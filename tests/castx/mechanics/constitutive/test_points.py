"""Bodies that flow: Jacobian, plane stress, cycles, freezing, what trial steps leave behind."""

from __future__ import annotations

from functools import partial
from typing import Any, NamedTuple

import numpy as np
import pytest

from castx.arrays import FloatArray
from castx.equilibrium.problem import MechanicalProblem
from castx.materials.flow import PLASTIC, VISCOPLASTIC
from castx.materials.inelastic import FLOW_RULES
from castx.mechanics.body import BodyMechanics
from castx.mechanics.constitutive.law import ELASTIC, Law
from castx.mechanics.constitutive.points import MaterialPoints
from castx.mechanics.constitutive.response import respond
from castx.mechanics.description import MechanicalBody
from castx.mechanics.fixed_directions import SurfaceDisplacement
from castx.tables import Table
from tests.castx.flow_reference import reference
from tests.elastic_bodies import (
    STRESS_FREE,
    elastic,
    everywhere,
    fixed,
    generated,
    heat,
    motion,
    places,
    problem,
    stresses,
)

pytestmark = pytest.mark.sampled

YOUNG, POISSON, YIELD = 60e9, 0.33, 60e6
LENGTH, WIDTH = 0.02, 0.01
MELTING = {
    "solidus": 560.0, "liquidus": 610.0, "latent_heat": 4e5,
    "liquid": {"viscosity": 2e6, "coherency": 0.6},
}  # fmt: skip
NORTON_LIQUID = {
    "model": "norton", "coefficient": 1e-22, "exponent": 3.0, "coherency": 0.6,
}  # fmt: skip
LAWS: dict[str, tuple[str, dict[str, Any], float]] = {
    "plastic": (PLASTIC, {"hardening": 1e9, "kinematic_hardening": 2e9}, 1.0),
    "saturating": (
        VISCOPLASTIC,
        {"hardening": {"saturation": 30e6, "rate": 50.0}, "viscosity": 1e8, "exponent": 4.0},
        1.0,
    ),
    "mixture": (PLASTIC, {"hardening": 1e9, **MELTING}, 0.9),
    "creeping liquid": (PLASTIC, {**MELTING, "liquid": NORTON_LIQUID}, 0.2),
    "born": (ELASTIC, MELTING, 0.8),
}
"""Name of the law, properties and solid fraction of the step."""
LAWS |= {
    name: (VISCOPLASTIC, {"law": name, **rule.example}, 1.0) for name, rule in FLOW_RULES.items()
}


class Kind(NamedTuple):
    """Model, formulation, stabilisation and cells."""

    model: str
    formulation: str = "mixed"
    stabilisation: str = "osgs"

    @property
    def cells(self) -> str:
        return "quadrilaterals" if self.formulation == "q1p0" else "simplices"


MODELS = ("plane-strain", "generalised-plane-strain", "axisymmetric", "3d")
KINDS = [
    *(Kind(model, "mixed", stabilisation) for model in MODELS for stabilisation in ("osgs", "gls")),
    *(Kind(model, formulation) for model in MODELS for formulation in ("displacement", "q1p0")),
    Kind("plane-stress", "displacement"),
]


def slab(comm, kind: Kind, size: float = 0.005) -> Any:
    depth = {"depth": WIDTH} if kind.model == "3d" else {}
    return generated(
        comm, kind.model, "slab", ["casting"], length=LENGTH, width=WIDTH, size=size,
        cells=kind.cells, **depth,
    )  # fmt: skip


def described(kind: Kind, law: str, properties: dict[str, Any], **more: Any) -> MechanicalBody:
    given = {"yield_stress": YIELD, "expansion": 2e-5, **properties}
    metal = elastic(YOUNG, POISSON, **given)
    return MechanicalBody(
        Law(metal, STRESS_FREE, law), formulation=kind.formulation,
        stabilisation=kind.stabilisation, **more,
    )  # fmt: skip


def random_field(part: BodyMechanics, seed: float) -> FloatArray:
    """Return values at the local unknowns that depend on their places only."""
    points = part.mesh.nodes.tabulate_dof_coordinates() / LENGTH
    phase = 1.0 + points @ [13.1, 17.3, 23.9]
    return np.sin(seed * (phase[:, None] + 4.3 * np.arange(part.block_size)) ** 1.3).ravel()


def in_state(part: BodyMechanics, solid_fraction: float, amplitude: float, seed: float) -> None:
    """Move the body at random, in a step at temperatures that differ from place to place."""
    nodes = len(part.mesh.parent_vertices)
    temperature = 500 + 50 * np.abs(random_field(part, seed + 0.1)[:nodes])
    part.update_state(temperature, np.full(nodes, solid_fraction), 0.5)
    part.solution.x.array[:] = amplitude * random_field(part, seed)


@pytest.mark.serial  # the other tests would not converge on several ranks with a wrong one
@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("kind", KINDS, ids="-".join)
def test_jacobian_is_the_derivative_of_the_residual(comm, kind, name):
    law, properties, fraction = LAWS[name]
    if "liquid" in properties and kind.formulation == "displacement":
        pytest.skip("a body of displacements alone has no liquid")
    part = BodyMechanics(
        slab(comm, kind).bodies["casting"], kind.model, described(kind, law, properties)
    )
    amplitude = 3e-5
    in_state(part, fraction, amplitude, 1.7)
    part.commit()
    in_state(part, fraction, amplitude, 1.1)
    here, direction = part.solution.x.array.copy(), random_field(part, 2.3)

    def residual(share: float) -> FloatArray:
        part.solution.x.array[:] = here + share * direction
        return part.residual()

    h = 1e-3 * amplitude
    difference = (8 * (residual(h) - residual(-h)) - (residual(2 * h) - residual(-2 * h))) / 12 / h
    residual(0.0)
    if law != ELASTIC and fraction > 0.6:
        assert np.mean(part.material.response.work > 0) > 0.75
    A = part.formulation.forms.create_jacobian()
    part.formulation.assemble_jacobian(A)
    x, y = A.createVecs()
    x.array[:] = direction[: x.getLocalSize()]
    A.mult(x, y)
    product = y.array_r.copy()
    for add_product in part.formulation.products():
        add_product(x.array_r, product)
    scale = comm.allreduce(np.abs(product).max(initial=0.0), op=max)
    np.testing.assert_allclose(difference, product, atol=1e-6 * scale, rtol=0)
    assert A.isSymmetric(1e-6 * scale)
    for item in (A, x, y):
        item.destroy()


PATH = [(0.0, 0.0), (2e-3, -1e-3), (3e-3, 2e-3), (-1e-3, 1e-3), (-2e-3, -3e-3)]
"""Strains along and across a sheet."""


def sheet(comm, kind: Kind, law: str, properties: dict[str, Any]) -> list[FloatArray]:
    """Return the stresses of a sheet, its faces free, after each leg of `PATH` in four steps."""
    along, across = (
        Table.from_points([[float(k), size * strain[i]] for k, strain in enumerate(PATH)])
        for i, size in enumerate((LENGTH, WIDTH))
    )
    held = [fixed("wall"), fixed("bottom")] + ([fixed("back")] if kind.model == "3d" else [])
    moved = [
        SurfaceDisplacement("far", "x", along), SurfaceDisplacement("top", "y", across),
    ]  # fmt: skip
    made = problem(
        slab(comm, kind, 0.01), {"casting": described(kind, law, properties)},
        {"casting": held + moved},
    )  # fmt: skip
    found = []
    for k in range(1, 4 * len(PATH) - 3):
        heat(made, STRESS_FREE, step=0.25)
        made.equilibrium.solve(k / 4)
        made.equilibrium.commit()
        if k % 4 == 0:
            stress = stresses(comm, made, "casting")
            np.testing.assert_allclose(stress, np.tile(stress[0], (len(stress), 1)), atol=1.0)
            found.append(stress[0])
    return found


@pytest.mark.parametrize("name", ["plastic", "saturating"])
def test_plane_stress_is_a_sheet_in_space(comm, name):
    law, properties, _ = LAWS[name]
    plane = sheet(comm, Kind("plane-stress", "displacement"), law, properties)
    for kind in (Kind("3d"), Kind("3d", "q1p0"), Kind("3d", "displacement")):
        for flat, solid in zip(plane, sheet(comm, kind, law, properties), strict=True):
            assert np.abs(solid[2]) < 1.0
            np.testing.assert_allclose(flat, solid, atol=1e-6 * np.abs(solid).max())


def test_equal_biaxial_tension(comm):
    """σ_Y + H ξ = σ with ε = (1 - ν) σ/E + ξ/2: the sheet thins by ξ."""
    hardening, strain = 2e9, 4e-3
    kind = Kind("plane-stress", "displacement")
    flowing = described(kind, PLASTIC, {"hardening": hardening})
    made = problem(
        slab(comm, kind, 0.01), {"casting": flowing},
        {"casting": [fixed("wall"), fixed("bottom"), fixed("far", "x", LENGTH * strain),
                     fixed("top", "y", WIDTH * strain)]},
    )  # fmt: skip
    made.equilibrium.solve(0.0)
    flowed = (strain - (1 - POISSON) * YIELD / YOUNG) / (0.5 + (1 - POISSON) * hardening / YOUNG)
    expected = YIELD + hardening * flowed
    stress = stresses(comm, made, "casting")
    np.testing.assert_allclose(stress[:, :2], expected, rtol=1e-8)
    np.testing.assert_allclose(stress[:, 2:], 0.0, atol=1.0)
    np.testing.assert_allclose(made.bodies["casting"].plastic_strain(), flowed, rtol=1e-8)


def cycled(comm, kind: Kind, properties: dict[str, Any], strains: list[float]) -> FloatArray:
    """Return the stress of a bar, free at its sides, after each elongation."""
    table = Table.from_points([[float(k), LENGTH * e] for k, e in enumerate([0.0, *strains])])
    held = [fixed("wall"), fixed("bottom"), SurfaceDisplacement("far", "x", table)]
    made = problem(
        slab(comm, kind, 0.01), {"casting": described(kind, PLASTIC, properties)}, {"casting": held}
    )
    found = []
    for k in range(1, len(strains) + 1):
        heat(made, STRESS_FREE)
        made.equilibrium.solve(float(k))
        made.equilibrium.commit()
        found.append(stresses(comm, made, "casting")[0, 0])
    return np.array(found)


@pytest.mark.parametrize(
    "kind",
    [Kind("plane-stress", "displacement"), Kind("generalised-plane-strain"),
     Kind("generalised-plane-strain", "q1p0")],
    ids="-".join,
)  # fmt: skip
@pytest.mark.parametrize("kinematic", [True, False], ids=["kinematic", "isotropic"])
def test_a_cycled_bar(comm, kind, kinematic):
    """Bauschinger: yielding back begins 2 σ_Y below the peak, or as far below zero as it was above.

    Both harden with E_t = E H/(E + H).
    """
    hardening, peak = 5e9, 5e-3
    properties = {"kinematic_hardening" if kinematic else "hardening": hardening}
    tangent = YOUNG * hardening / (YOUNG + hardening)
    top = YIELD + tangent * (peak - YIELD / YOUNG)
    back = top - 2 * YIELD if kinematic else -top
    turn = peak - (top - back) / YOUNG
    bottom = back + tangent * (-peak - turn)
    again = bottom + 2 * YIELD if kinematic else -bottom
    turned = -peak + (again - bottom) / YOUNG
    strains = [YIELD / YOUNG, peak, turn, -peak, turned, turned + 2e-3]
    expected = [YIELD, top, back, bottom, again, again + tangent * 2e-3]
    found = cycled(comm, kind, properties, strains)
    np.testing.assert_allclose(found, expected, rtol=1e-7)


@pytest.mark.parametrize("name", FLOW_RULES)
def test_a_pulled_bar_flows_at_its_rate(comm, name):
    """Stretched at a constant rate until it is steady: the stress of flow at this rate."""
    rate, step, steps, temperature = 1e-3, 2.0, 12, 500.0
    rule = FLOW_RULES[name]
    kind = Kind("generalised-plane-strain")
    pull = Table.from_points([[0.0, 0.0], [steps * step, LENGTH * rate * steps * step]])
    held = [fixed("wall"), fixed("bottom"), SurfaceDisplacement("far", "x", pull)]
    flowing = described(kind, VISCOPLASTIC, {"law": name, "expansion": 0.0, **rule.example})
    made = problem(slab(comm, kind, 0.01), {"casting": flowing}, {"casting": held})
    for k in range(1, steps + 1):
        heat(made, temperature, step=step)
        made.equilibrium.solve(k * step)
        made.equilibrium.commit()
    overstress = stresses(comm, made, "casting")[:, 0] - (YIELD if rule.threshold else 0.0)
    found = [reference(name).rate(f, rule.example, temperature) for f in overstress]
    np.testing.assert_allclose(found, rate, rtol=1e-3)


def frozen(comm, kind: Kind, law: str, free: bool = False, **properties: Any) -> MechanicalProblem:
    """Return a casting that starts liquid, not hindered or shortened by 0.01 per s."""
    melting = described(kind, law, {**MELTING, **properties}, starts_liquid=True)
    held = [fixed("wall"), fixed("bottom")] + ([fixed("back")] if kind.model == "3d" else [])
    if not free:
        shortened = Table.from_points([[0.0, 0.0], [10.0, -0.1 * LENGTH]])
        held.append(SurfaceDisplacement("far", "x", shortened))
    return problem(slab(comm, kind), {"casting": melting}, {"casting": held})


@pytest.mark.parametrize(
    "kind",
    [Kind("3d"), Kind("3d", stabilisation="gls"), Kind("3d", "q1p0"),
     Kind("generalised-plane-strain"), Kind("generalised-plane-strain", "q1p0")],
    ids="-".join,
)  # fmt: skip
@pytest.mark.parametrize("law", [ELASTIC, PLASTIC])
def test_a_free_bar_shrinks_as_it_freezes(comm, kind, law):
    """By a third in each direction of what it loses above coherency, s (f_s − f_c)."""
    shrinkage, coherency = 0.03, 0.6
    made = frozen(comm, kind, law, True, expansion=0.0, solidification_shrinkage=shrinkage)
    for fraction in (0.0, 0.5, 0.6, 0.7, 0.95, 1.0):
        heat(made, 580.0, fraction)
        made.equilibrium.solve(0.0)
        made.equilibrium.commit()
        shrunk = shrinkage * max(fraction - coherency, 0.0)
        dimension = made.bodies["casting"].dimension
        found = motion(made, "casting")[:, :dimension]
        np.testing.assert_allclose(found, -shrunk / 3 * places(made, "casting"), atol=1e-9 * LENGTH)
        assert np.abs(stresses(comm, made, "casting")).max(initial=0.0) < 1e-6 * YOUNG


@pytest.mark.parametrize("kind", [Kind("plane-strain"), Kind("plane-strain", "q1p0")], ids="-".join)
def test_remelting_forgets_the_flow(comm, kind):
    """Stretched far as a solid, molten, frozen again: no stress, no plastic strain, then as new."""
    pull = Table.from_points([[0.0, 0.0], [1.0, 0.01 * LENGTH], [3.0, 0.01 * LENGTH]])
    body = described(kind, PLASTIC, {"hardening": 1e9, **MELTING})
    made = problem(
        slab(comm, kind), {"casting": body},
        {"casting": [fixed("wall"), fixed("bottom"), SurfaceDisplacement("far", "x", pull)]},
    )  # fmt: skip
    part = made.bodies["casting"]
    for time, (temperature, fraction) in enumerate(((20.0, 1.0), (620.0, 0.0), (560.0, 1.0)), 1):
        heat(made, temperature, fraction)
        made.equilibrium.solve(float(time))
        made.equilibrium.commit()
        flowed, stress = part.plastic_strain(), np.abs(stresses(comm, made, "casting"))
        if time == 1:
            assert flowed.min(initial=1.0) > 0.005 and stress.max() > YIELD
        else:
            viscous = 2e6 * 0.02 if fraction == 0.0 else 1.0
            assert flowed.max(initial=0.0) == 0.0 and stress.max() < viscous


def test_a_trial_step_leaves_no_trace(comm):
    kind = Kind("plane-strain")
    metal = {"viscosity": 1e8, "exponent": 3.0, "solidification_shrinkage": 0.03}
    made, plain = (frozen(comm, kind, VISCOPLASTIC, **metal) for _ in range(2))
    for time, (temperature, fraction) in enumerate(((600.0, 0.7), (570.0, 0.9), (300.0, 1.0)), 1):
        for trial in ((620.0, 0.0), (20.0, 1.0)):
            heat(made, lambda x, t=trial[0]: t - 3e3 * x[:, 0], trial[1])
            made.equilibrium.solve(float(time))
        made.equilibrium.rewind()
        for each in (made, plain):
            heat(
                each,
                lambda x, t=temperature: t - 3e3 * x[:, 0],
                lambda x, f=fraction: np.maximum(f - 100.0 * (1.0 - f) * x[:, 1], 0.0),
            )
            each.equilibrium.solve(float(time))
            each.equilibrium.commit()
    parts = [each.bodies["casting"] for each in (made, plain)]
    for name, found in parts[0].material.history.arrays().items():
        expected = parts[1].material.history.arrays()[name]
        assert any(comm.allgather(np.any(expected))), name
        np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-12, err_msg=name)
    np.testing.assert_allclose(motion(made, "casting"), motion(plain, "casting"), atol=1e-13)


@pytest.mark.parametrize("law", [PLASTIC, VISCOPLASTIC])
def test_rewound_stress_is_that_of_the_accepted_step(comm, law):
    """What is viscous must not flow on, what froze must not be born again."""
    made = frozen(comm, Kind("plane-strain"), law, viscosity=1e8, exponent=3.0)
    for time, (temperature, fraction) in enumerate(((600.0, 0.1), (570.0, 0.9), (300.0, 1.0)), 1):
        heat(made, lambda x, t=temperature: t - 3e3 * x[:, 0], fraction)
        made.equilibrium.solve(float(time))
        made.equilibrium.commit()
        accepted = stresses(comm, made, "casting")
        heat(made, lambda x: 100.0 + 3e3 * x[:, 0], 1.0, step=3.0)
        made.equilibrium.solve(time + 1.0)
        assert np.abs(stresses(comm, made, "casting") - accepted).max() > 1e3
        made.equilibrium.rewind()
        size = np.abs(accepted).max()
        np.testing.assert_allclose(stresses(comm, made, "casting"), accepted, atol=1e-9 * size)


def test_metal_that_cannot_contract_bears_all_of_its_stress(points, cells):
    """The first iteration of a step foresees its contraction; none that follows does."""
    metal = elastic(YOUNG, POISSON, 2e-5, yield_stress=YIELD, **MELTING)
    made = MaterialPoints(points, Law(metal, 560.0, PLASTIC), cells, starts_liquid=True)
    fraction = np.linspace(0.0, 1.0, points.cell_nodes.max() + 1)
    still = np.zeros((points.count, points.components))
    for step in range(2):
        made.begin(610.0 - 50.0 * fraction - 400.0 * step, fraction, 1.0)
        law = partial(respond, made.conditions, made.history, still)
        made.update(still)
        assert step == 0 or np.abs(made.response.stress - law().stress).max() > 1e6
        for _ in range(2):
            made.update(still)
            np.testing.assert_array_equal(made.response.stress, law().stress)
        made.commit(np.zeros(points.volumes))
    made.rewind()
    made.update(still)
    np.testing.assert_array_equal(made.response.stress, law().stress)


@pytest.mark.parametrize("kind", [Kind("plane-strain"), Kind("plane-strain", stabilisation="gls"),
                                  Kind("plane-strain", "q1p0")], ids="-".join)  # fmt: skip
def test_a_large_step_of_perfect_plasticity_is_solved(comm, kind):
    """Cooled by 280 to 500 K at once between walls; some of its Newton steps are mechanisms."""
    made = frozen(comm, kind, PLASTIC)
    for time, (temperature, fraction) in enumerate(((600.0, 0.1), (570.0, 0.9), (300.0, 1.0)), 1):
        heat(made, lambda x, t=temperature: t - 3e3 * x[:, 0], fraction)
        made.equilibrium.solve(float(time))
        made.equilibrium.commit()
    heat(made, lambda x: 20.0 + 3e3 * x[:, 0])
    made.equilibrium.solve(4.0)
    stress = stresses(comm, made, "casting")
    deviator = stress[:, :3] - stress[:, :3].mean(axis=1, keepdims=True)
    equivalent = np.sqrt(1.5 * (np.sum(deviator**2, axis=1) + 2 * stress[:, 3] ** 2))
    np.testing.assert_allclose(equivalent, YIELD, rtol=0.2 if kind.cells != "simplices" else 1e-8)


def test_a_shell_at_rest_does_not_move_with_the_steps_of_its_liquid(comm):
    """By what the volume of a cell of liquid is off its own, and would be forgotten in each."""
    metal = elastic(YOUNG, POISSON, 2e-5, **MELTING)
    cast = MechanicalBody(Law(metal, 560.0), starts_liquid=True)
    held = [fixed("wall"), fixed("bottom")]
    made = problem(slab(comm, Kind("plane-strain"), 0.0025), {"casting": cast}, {"casting": held})
    shell = _in_the_shell(places(made, "casting"), 1.0, 0.0) > 0
    shape = []
    for time, (cold, fraction) in enumerate(((640.0, 0.0), (540.0, 1.0), *[(300.0, 1.0)] * 13)):
        heat(made, partial(_in_the_shell, solid=cold, liquid=640.0),
             partial(_in_the_shell, solid=fraction, liquid=0.0))  # fmt: skip
        made.equilibrium.solve(float(time))
        made.equilibrium.commit()
        shape.append(everywhere(comm, motion(made, "casting")[shell, :2]))
    contracted, moved = (np.abs(shape[k] - shape[2]).max() for k in (0, -1))
    assert moved < 0.01 * contracted


def _in_the_shell(x: FloatArray, solid: float, liquid: float) -> FloatArray:
    """Return one value where the shell is, another in its liquid, shape (nodes,)."""
    return np.where(x[:, 0] - x[:, 1] > 0.25 * LENGTH, solid, liquid)


def test_a_norton_liquid_between_walls(comm):
    """Pushed in plane strain, free at its top: q = √3 σ/2 and ε̇ = 2/√3 of the rate along."""
    kind, rate = Kind("plane-strain"), 1e-2
    melt = described(kind, PLASTIC, {**MELTING, "liquid": NORTON_LIQUID}, starts_liquid=True)
    pull = Table.from_points([[0.0, 0.0], [10.0, 10.0 * rate * LENGTH]])
    made = problem(
        slab(comm, kind), {"casting": melt},
        {"casting": [fixed("wall"), fixed("bottom"), SurfaceDisplacement("far", "x", pull)]},
    )  # fmt: skip
    G = YOUNG / (2 * (1 + POISSON))
    for step in (0.5, 1.0):
        made.equilibrium.rewind()
        heat(made, 620.0, 0.0, step)
        made.equilibrium.solve(step)
        strain = 2 / np.sqrt(3) * rate * step
        roots = np.roots([step * 1e-22, 0.0, 1 / (3 * G), -strain])
        q = float(roots[np.abs(roots.imag) < 1e-6 * np.abs(roots)].real[0])
        stress = everywhere(comm, stresses(comm, made, "casting"))
        np.testing.assert_allclose(stress[:, 0], 2 / np.sqrt(3) * q, rtol=1e-6)
        np.testing.assert_allclose(stress[:, 1], 0.0, atol=1e-6 * q)
