"""Every key of a case reaches its problem: changing it changes the answer."""

from copy import deepcopy
from dataclasses import replace
from typing import Any

import gmsh
import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.contact.choice import Contact, common_method
from castx.coupling.building import build_problem, law_above_solidus, laws_above_solidus
from castx.domain.source import gmsh_session
from castx.errors import CaseError, MeshError
from castx.materials.description import Liquid
from castx.materials.inelastic import LIQUID_RULES
from castx.materials.lookup import find_material
from castx.meshes.generators.core_in_ring import core_in_ring
from tests import coupled_cases
from tests.coupled_cases import final_state, ring

# Keys reach their problems alike on all ranks; the problems themselves are tested on several.
pytestmark = pytest.mark.serial

REMOVED = object()
COATING = {"thickness": 1e-4, "conductivity": 0.3}


def base() -> dict[str, Any]:
    """Return the ring with conditions of every kind, two steps of 2 s from above melting."""
    data = ring({"time": {"end": 4.0, "fixed_step": 2.0, "heat_substeps": 2}}, size=0.01)
    data["materials"]["aluminium"] |= {"stress_free": 650.0, "expansion_reference": 20.0,
                                       "expansion": [[20.0, 2.3e-5], [660.0, 2.5e-5]]}  # fmt: skip
    data["loads"] = {"gravity": [0.0, -9.81]}
    data["bodies"][0]["heat_source"] = 1e6
    data["boundaries"] += [
        {"on": "core/top", "heat": {"type": "flux", "value": 1e4}, "traction": [0.0, -1e6]},
        {"on": "casting/top", "heat": {"type": "temperature", "value": 640.0}, "pressure": 1e6},
    ]
    return data


def changed(data: dict[str, Any], path: str, value: Any) -> dict[str, Any]:
    result = deepcopy(data)
    place: Any = result
    *above, last = (int(key) if key.isdecimal() else key for key in path.split("."))
    for key in above:
        place = place.setdefault(key, {}) if isinstance(place, dict) else place[key]
    if value is REMOVED:
        del place[last]
    else:
        place[last] = value
    return result


CHANGES: list[tuple[str, Any]] = [
    ("geometry.size", 0.008),
    ("materials.aluminium.density", 2600.0),
    ("materials.aluminium.heat_capacity.solid", 1000.0),
    ("materials.aluminium.heat_capacity.liquid", 1000.0),
    ("materials.aluminium.conductivity.solid", 200.0),
    ("materials.aluminium.conductivity.liquid", 90.0),
    ("materials.aluminium.latent_heat", 380e3),
    ("materials.aluminium.liquidus", 670.0),
    ("materials.aluminium.young_modulus", 30e9),
    ("materials.aluminium.poisson_ratio", 0.3),
    ("materials.aluminium.expansion", 2.2e-5),
    ("materials.aluminium.stress_free", 640.0),
    ("materials.aluminium.expansion_reference", 300.0),
    ("materials.aluminium.liquid", {"viscosity": 1e6, "coherency": 0.7}),
    ("materials.steel.young_modulus", 200e9),
    ("materials.steel.conductivity", 30.0),
    ("bodies.0.temperature", 690.0),
    ("bodies.0.heat_source", 2e7),
    ("bodies.0.formulation", "displacement"),
    ("bodies.0.stabilisation", "gls"),
    ("bodies.1.temperature", 110.0),
    ("bodies.1.formulation", "mixed"),
    ("bodies.1.material", "aluminium"),
    ("interfaces.0.contact.method", "none"),
    ("interfaces.0.contact.initial_gap", 1e-5),
    ("interfaces.0.contact.initial_gap", -1e-5),
    ("interfaces.0.heat.law", "series"),
    ("interfaces.0.heat.closed", 1400.0),
    ("interfaces.0.heat.pressure", REMOVED),
    ("interfaces.0.heat.pressure.resistance", 1e-4),
    ("interfaces.0.heat.pressure.hardness", 4e8),
    ("interfaces.0.heat.pressure.exponent", 0.9),
    ("interfaces.0.heat.closed", {"over": "temperature", "table": [[0, 1500.0], [900, 1400.0]]}),
    ("interfaces.0.heat.closed", {"over": "time", "table": [[0, 1500.0], [9, 1400.0]]}),
    ("interfaces.0.heat.pressure", {"hardness": 5e8, "roughness": [2e-6, 3e-6]}),
    ("interfaces.0.heat.pressure", {"hardness": 5e8, "coating": COATING}),
    ("interfaces.0.heat", {"law": "limited", "gas_conductivity": 0.05, "coating": COATING}),
    ("interfaces.0.heat.radiation", {"emissivities": [0.3, 0.8]}),
    ("interfaces.0.heat.patches", [{"within": {"z": [0, 0.02]}, "closed": 500.0}]),
    (
        "interfaces.0.heat.patches",
        [{"within": {"z": [0, 0.02]}, "radiation": {"emissivities": [1, 1]}}],
    ),
    ("interfaces.0.heat", {"law": "none"}),
    ("interfaces.0.heat", {"law": "none", "radiation": {"emissivities": [0.3, 0.8]}}),
    ("interfaces.0.heat", {"law": "solid-fraction", "closed": 1500.0, "open": 100.0}),
    ("interfaces.0.heat", {"law": "perfect"}),
    ("boundaries.0.displacement.normal", 1e-5),
    ("boundaries.2.heat.coefficient", 400.0),
    ("boundaries.2.heat.coefficient", {"over": "temperature", "table": [[0, 500], [700, 400]]}),
    (
        "boundaries.2.heat.coefficient",
        {"over": "temperature", "table": [[0, 500], [700, 400]], "of": "surface"},
    ),
    ("boundaries.2.heat.ambient", 40.0),
    ("boundaries.2.heat", {"type": "radiation", "emissivity": 0.9, "ambient": 30.0}),
    ("boundaries.3.heat.value", 1e5),
    ("boundaries.3.traction", [0.0, -2e6]),
    ("boundaries.3.pressure", 1e6),
    ("boundaries.4.heat.value", 630.0),
    ("boundaries.4.pressure", 2e6),
    ("boundaries.4.displacement", {"normal": "uniform"}),
    ("loads.gravity", [0.0, -9810.0]),
    ("time.fixed_step", 1.0),
    ("time.heat_substeps", 3),
    ("coupling.scheme", "staggered"),
    ("coupling.scheme", "one-way"),
    ("coupling.scheme", "thermal"),
]


def answer(comm, data: dict[str, Any]) -> dict[str, np.ndarray]:
    state = final_state(comm, data)
    found = coupled_cases.fields(state) if state.problem.mechanics is not None else {}
    sizes = {k: v for k, v in state.totals.items() if "heat" in k or "enthalpy" in k}
    stress = [
        np.abs(state.cellwise(b, "stress")).sum() for b in ("casting", "core")
    ] if found else [0.0]  # fmt: skip
    return {**found, "totals": np.array(list(sizes.values())),
            "stress": np.array(comm.allreduce(np.array(stress)))}  # fmt: skip


@pytest.fixture(scope="module")
def original() -> dict[str, Any]:
    return {}


@pytest.mark.sampled
@pytest.mark.parametrize("path, value", CHANGES)
def test_each_key_changes_the_answer(comm, original, path, value):
    if not original:
        original |= answer(comm, base())
    found = answer(comm, changed(base(), path, value))
    comparable = [n for n in found if n in original and found[n].shape == original[n].shape]
    assert comparable
    assert any(
        np.abs(found[n] - original[n]).max() > 1e-7 * np.abs(original[n]).max() for n in comparable
    )


def test_gas_acts_once_the_gap_is_open(comm):
    """What a closed interface does not feel, and `transition` likewise below."""
    data = coupled_cases.cylinder({"time": {"end": 4.0, "fixed_step": 2.0}})
    found = [
        final_state(comm, changed(data, "interfaces.0.heat.gas_conductivity", k)).totals
        for k in (0.01, {"over": "temperature", "table": [[0, 0.01], [900, 0.02]]}, 0.02)
    ]
    heats = [totals["casting/mould.heat"] for totals in found]
    assert heats[0] < 0.99 * heats[1] < 0.99 * heats[2]


def test_rounding_acts_where_the_gap_is_small(comm):
    data = coupled_cases.cylinder({"time": {"end": 4.0, "fixed_step": 2.0}})
    rounded = changed(data, "interfaces.0.heat.transition", 2e-5)
    heats = [final_state(comm, case).totals["casting/mould.heat"] for case in (data, rounded)]
    assert heats[1] < (1.0 - 1e-6) * heats[0]


def test_solver_options_reach_their_solvers(comm):
    data = base()
    data["solver"] = {
        "heat": {"snes_max_it": 33}, "mechanics": {"snes_max_it": 34},
        "contact": {"mat_mumps_icntl_14": 35}, "mechanics_tolerance": 1e-7, "heat_tolerance": 1e-9,
    }  # fmt: skip
    problem = coupled_cases.simulation(comm, data).problem
    assert problem.heat._solver.snes.getTolerances()[3] == 33
    equilibrium = problem.mechanics.equilibrium
    assert equilibrium._procedure._solver.snes.getTolerances()[3] == 34
    assert equilibrium._procedure._solver.options["bodies_mat_mumps_icntl_14"] == 35
    assert equilibrium.balance.convergence.tolerance == 1e-7


def test_coupling_numbers_reach_the_coupling(comm):
    data = base()
    data["coupling"] = {"tolerance": 1e-6, "passes": 11, "scheme": "iterated"}
    problem = coupled_cases.simulation(comm, data).problem
    assert (problem._tolerance, problem._most_passes) == (1e-6, 11)


def test_support_can_be_switched_off(comm):
    data = changed(base(), "support.mode", "none")
    problems = [coupled_cases.simulation(comm, case).problem for case in (data, base())]
    without, supported = (problem.mechanics.equilibrium for problem in problems)
    assert without.balance.supports.motions is None
    assert supported.balance.supports.motions is not None


def test_unknown_surface_of_a_file_is_refused(comm, shared_tmp_path):
    data = changed(base(), "boundaries.0.on", "core/chimney")
    arguments = {k: v for k, v in data.pop("geometry").items() if k != "generator"}
    if comm.rank == 0:
        with gmsh_session():
            core_in_ring(**arguments)
            gmsh.write(str(shared_tmp_path / "ring.msh"))
    comm.Barrier()
    data["geometry"] = {"file": "ring.msh", "model": "axisymmetric"}
    with pytest.raises(MeshError, match="chimney"):
        coupled_cases.simulation(comm, data, shared_tmp_path)


def test_a_displacement_body_that_starts_solid_goes_without_its_liquid(comm):
    """A chill of a casting alloy is elastic at every temperature; a melt is refused."""
    data = changed(base(), "bodies.1.material", "Cu-pure")
    for formulation, liquid in (("displacement", False), ("mixed", True)):
        run = coupled_cases.simulation(comm, changed(data, "bodies.1.formulation", formulation))
        assert run.problem.mechanics.bodies["core"].is_compressible is not liquid
    hot = changed(data, "bodies.1.temperature", 1084.62)
    with pytest.raises(CaseError, match=r'incompressible liquid; use "mixed", or liquid = "none"'):
        coupled_cases.simulation(comm, hot)


def test_the_law_above_the_solidus_is_named():
    copper = find_material("Cu-pure", {})
    text = (
        "core: Cu-pure flows with its viscosity ahead of its front at 1084.62 °C; its coherency "
        "has no meaning there"
    )
    assert law_above_solidus("core", copper) == text
    chill = text.replace("Cu-pure", "should it melt, Cu-pure")
    assert law_above_solidus("core", copper, poured=False) == chill
    alloy = find_material("AlSi7Mg", {})
    text = "core: AlSi7Mg flows with its viscosity below a solid fraction of 0.9"
    assert law_above_solidus("core", alloy) == text
    text = "core: Cu-pure keeps its solid's law at every temperature, without liquid"
    assert law_above_solidus("core", copper.without_liquid()) == text
    for name, rule in LIQUID_RULES.items():
        liquid = Liquid.read({"model": name, "coherency": 0.6, **rule.example})
        description = alloy.description.model_copy(update={"liquid": liquid})
        text = f"core: AlSi7Mg creeps by {rule.title} below a solid fraction of 0.6"
        assert law_above_solidus("core", replace(alloy, description=description)) == text


def test_a_chill_is_not_said_to_flow(comm):
    data = changed(changed(base(), "bodies.1.material", "Cu-pure"), "bodies.1.formulation", "mixed")
    run = coupled_cases.simulation(comm, data)
    for temperature, said in ((20.0, True), (1200.0, False)):
        hot = changed(data, "bodies.1.temperature", temperature)
        lines = laws_above_solidus(read_case(hot, coupled_cases.Path("case.toml")), run.mesh)
        assert any("core: should it melt, Cu-pure" in line for line in lines) is said


def test_methods_of_contact_cannot_be_mixed():
    contacts = [Contact("a", "b", "condensed"), Contact("a", "c", "multipliers")]
    with pytest.raises(CaseError, match="condensed, multipliers"):
        common_method(contacts)


def test_initial_gap_at_the_pairs(comm):
    data = base()
    data["interfaces"][0]["contact"]["initial_gap"] = {
        "along": "z", "table": [[0.0, 0.0], [0.04, 4e-5]],
    }  # fmt: skip
    run = coupled_cases.simulation(comm, data)
    problem = build_problem(read_case(data, coupled_cases.Path("case.toml")), run.mesh, run.pairs)
    heights = run.pairs["casting/core"].points[:, 1]
    assert problem.states[0].gap == pytest.approx(1e-3 * heights, abs=1e-12)


def test_liquid_in_plane_stress_is_refused_with_cures_that_run(comm):
    """A yielding body there has no pressure of its own, and so no incompressible liquid."""
    data: dict[str, Any] = {
        "geometry": {"generator": "box_in_mould", "model": "plane-stress", "box": [0.04, 0.02],
                     "wall": 0.01, "size": 0.01},
        "materials": {"melt": {"extends": "AlSi7Mg"}},
        "bodies": [
            {"name": "casting", "material": "melt", "temperature": 640.0,
             "law": "thermo-elasto-plastic"},
            {"name": "mould", "material": "steel-H13", "temperature": 150.0},
        ],
        "interfaces": [{"bodies": ["casting", "mould"],
                        "heat": {"law": "limited", "closed": 3e3, "gas_conductivity": 0.05}}],
        "boundaries": [{"on": "mould/base", "displacement": {"normal": 0.0}}],
        "loads": {"gravity": [0.0, -9.81]},
        "time": {"end": 0.4, "fixed_step": 0.2},
    }  # fmt: skip
    said = "'melt' has a liquid.* triangles and the law 'thermo-elastic'.*liquid = \"none\""
    for path, value in (
        ("materials.melt.liquid", "none"),
        ("geometry.model", "generalised-plane-strain"),
        ("bodies.0.law", "thermo-elastic"),
    ):
        with pytest.raises(CaseError, match=said):
            coupled_cases.simulation(comm, data)
        totals = final_state(comm, changed(data, path, value)).totals
        assert totals["casting/mould.force.y"] == pytest.approx(2680 * 9.81 * 8e-4, rel=1e-3)
