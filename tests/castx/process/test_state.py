"""What a state shows: fields by name, totals against sums made here."""

from mpi4py import MPI

import numpy as np
import pytest

from castx.case.fields.stress import von_mises
from castx.errors import CaseError
from tests import coupled_cases
from tests.contact_methods import EXACT
from tests.coupled_cases import cylinder, final_state, merged, ring
from tests.partitions import PARTITION, on_the_last

SHORT = {"time": {"end": 4.0, "fixed_step": 2.0}}
INTERFACE = "casting/core"


@pytest.fixture(scope="module")
def run():
    return final_state(MPI.COMM_WORLD, ring(SHORT))


def owned(run, body):
    return run.mesh.bodies[body].nodes.dofmap.index_map.size_local


def test_nodal_fields_have_all_local_nodes(run):
    for body, part in run.mesh.bodies.items():
        nodes = len(part.parent_vertices)
        for name in ("temperature", "enthalpy", "solid_fraction", "pressure"):
            assert run.nodal(body, name).shape == (nodes,)
        assert run.nodal(body, "displacement").shape == (nodes, 2)


def test_cell_fields_have_all_local_cells(run):
    for body, part in run.mesh.bodies.items():
        cells = len(part.nodes.dofmap.list)
        assert run.cellwise(body, "stress").shape == (cells, 6)
        assert run.cellwise(body, "von_mises") == pytest.approx(
            von_mises(run.cellwise(body, "stress"))
        )
        assert (run.cellwise(body, "plastic_strain") == 0).all()


def test_fields_fit_each_other(run):
    T, f = run.nodal("casting", "temperature"), run.nodal("casting", "solid_fraction")
    assert (f[T > 660.0 + 1e-9] == 0).all()
    assert (f[T < 660.0 - 1e-9] == 1).all()
    cold = T < 660.0 - 1e-9  # solid 0 °C has no enthalpy: ρ c T there
    H = run.nodal("casting", "enthalpy")[cold]
    assert pytest.approx(2700.0 * 1080.0 * T[cold], rel=1e-9) == H


@pytest.mark.ranks
def test_pressure_of_a_displacement_body_is_the_mean_stress(run):
    stress = run.cellwise("core", "stress")[:, :3].mean(axis=1)
    pressure = run.nodal("core", "pressure")
    extremes = run.mesh.comm.allgather((stress.min(initial=np.inf), stress.max(initial=-np.inf)))
    low, high = min(e[0] for e in extremes), max(e[1] for e in extremes)
    assert (low <= pressure).all()
    assert (pressure <= high).all()


def test_paired_fields(run):
    pairs = run.pairs[INTERFACE]
    for name in ("gap", "contact_pressure", "heat_transfer_coefficient"):
        assert run.paired(INTERFACE, name).shape == pairs.areas.shape
    p, g = run.paired(INTERFACE, "contact_pressure"), run.paired(INTERFACE, "gap")
    h = np.where(g > 0, np.minimum(1500.0, 0.05 / np.maximum(g, 1e-12)), 1500.0)
    relative = np.maximum(p / 5e8, 0.0)
    h += relative * np.maximum(relative, 1e-6) ** -0.05 / 2e-4
    assert run.paired(INTERFACE, "heat_transfer_coefficient") == pytest.approx(h, rel=1e-9)


@pytest.mark.ranks
def test_totals_are_sums_over_all_ranks(run):
    comm, totals, pairs = run.mesh.comm, run.totals, run.pairs[INTERFACE]
    for body in run.mesh.bodies:
        volumes = run.problem.volumes[body]
        f = run.nodal(body, "solid_fraction")[: owned(run, body)]
        H = run.nodal(body, "enthalpy")[: owned(run, body)]
        volume = comm.allreduce(volumes.sum())
        assert totals[f"{body}.solid_fraction"] == pytest.approx(
            comm.allreduce(f @ volumes) / volume
        )
        T = run.nodal(body, "temperature")[: owned(run, body)]
        mean = comm.allreduce(T @ volumes) / volume
        assert totals[f"{body}.mean_temperature"] == pytest.approx(mean)
        assert totals[f"{body}.min_temperature"] == comm.allreduce(T.min(initial=9e9), op=MPI.MIN)
        assert totals[f"{body}.max_temperature"] == comm.allreduce(T.max(initial=-9e9), op=MPI.MAX)
        assert totals[f"{body}.min_temperature"] < mean < totals[f"{body}.max_temperature"]
        assert totals[f"{body}.enthalpy"] == pytest.approx(comm.allreduce(H @ volumes), rel=1e-9)
    area = comm.allreduce(pairs.areas.sum())
    assert area == pytest.approx(2 * np.pi * 0.03 * 0.04)
    gap, p = run.paired(INTERFACE, "gap"), run.paired(INTERFACE, "contact_pressure")
    assert totals[f"{INTERFACE}.mean_gap"] == pytest.approx(
        comm.allreduce(gap @ pairs.areas) / area, abs=1e-15
    )
    for name, extreme in (("min_gap", MPI.MIN), ("max_gap", MPI.MAX)):
        own = gap.min(initial=np.inf) if name == "min_gap" else gap.max(initial=-np.inf)
        assert totals[f"{INTERFACE}.{name}"] == comm.allreduce(own, op=extreme)
    assert abs(totals["largest_pull"]) < 1e-9 * comm.allreduce(p @ pairs.areas)
    force = comm.allreduce(p @ (pairs.areas * pairs.normals[:, 0]))
    assert totals[f"{INTERFACE}.force.r"] == pytest.approx(force, rel=1e-9)
    touching = comm.allreduce(((p > 0) * pairs.areas).sum()) / area
    assert 0 < touching <= totals[f"{INTERFACE}.closed_fraction"] <= 1 + 1e-12


@pytest.mark.ranks
def test_a_rank_without_cells_has_the_totals_of_all(comm, monkeypatch):
    alone = first_state(MPI.COMM_SELF).totals
    monkeypatch.setattr(PARTITION, on_the_last)
    totals = first_state(comm).totals
    assert totals.keys() == alone.keys()
    for name, value in alone.items():
        assert totals[name] == pytest.approx(value, rel=1e-9, abs=1e-12), name


def first_state(comm):
    return next(iter(coupled_cases.simulation(comm, ring(SHORT))))


def test_unknown_names_are_refused(run):
    for read, name in ((run.nodal, "colour"), (run.cellwise, "colour")):
        with pytest.raises(CaseError, match="colour"):
            read("casting", name)
    with pytest.raises(CaseError, match="colour"):
        run.paired(INTERFACE, "colour")


@pytest.mark.ranks
def test_mechanics_is_missing_in_thermal_runs(comm):
    data = merged(cylinder(SHORT), {"coupling": {"scheme": "thermal"}})
    state = final_state(comm, data)
    assert "support_force" not in state.totals
    for read, name in ((state.nodal, "displacement"), (state.cellwise, "stress")):
        with pytest.raises(CaseError, match="no mechanics"):
            read("casting", name)


@pytest.mark.parametrize("method", EXACT)
def test_closed_fraction_knows_the_pairs_not_the_round_off_of_gaps(comm, method):
    state = final_state(comm, ring(SHORT, method=method))
    pressed = state.paired(INTERFACE, "contact_pressure") > 0
    areas = state.pairs[INTERFACE].areas
    share = comm.allreduce(areas @ pressed) / comm.allreduce(areas.sum())
    assert state.totals[f"{INTERFACE}.closed_fraction"] == pytest.approx(share)


def test_von_mises():
    stress = np.array([[3.0, 0, 0, 0, 0, 0], [5.0, 5, 5, 0, 0, 0], [0, 0, 0, 1.0, 0, 0],
                       [1.0, 0, 0, 0, 2, 2]])  # fmt: skip
    assert von_mises(stress) == pytest.approx([3.0, 0.0, np.sqrt(3), 5.0])


def test_initial_state(comm):
    first = first_state(comm)
    assert (first.time, first.step) == (0.0, 0)
    assert first.nodal("casting", "temperature") == pytest.approx(700.0)
    assert first.nodal("casting", "displacement") == pytest.approx(0.0, abs=0.0)
    assert first.totals["energy_error"] == 0.0
    assert first.totals[f"{INTERFACE}.closed_fraction"] == pytest.approx(1.0)


@pytest.mark.ranks
def test_suction_is_the_stress_of_the_liquid_that_a_wall_draws(comm):
    """A viscous block drawn out in plane strain by its base: σ = 4 η ε̇; frozen it lets go."""
    viscosity, motion, height = 1e6, 1e-5, 0.03
    metal = {
        "density": 2700.0, "heat_capacity": 1000.0, "conductivity": 100.0, "latent_heat": 4e5,
        "solidus": 560.0, "liquidus": 610.0,
        "young_modulus": 7e9, "poisson_ratio": 0.33, "expansion": 0.0,
        "liquid": {"viscosity": viscosity, "coherency": 0.7},
    }  # fmt: skip
    hard = {"density": 7800.0, "heat_capacity": 500.0, "conductivity": 30.0,
            "young_modulus": 70e12, "poisson_ratio": 0.3, "expansion": 0.0}  # fmt: skip
    data = {
        "geometry": {"generator": "stacked_blocks", "model": "plane-strain", "size": 0.01,
                     "upper": [0.02, height], "base": [0.02, 0.03]},
        "materials": {"metal": metal, "hard": hard},
        "bodies": [{"name": "upper", "material": "metal", "temperature": 650.0},
                   {"name": "base", "material": "hard", "temperature": 20.0}],
        "interfaces": [{"bodies": ["upper", "base"]}],
        "boundaries": [
            {"on": "upper/top", "displacement": {"normal": 0.0}},
            {"on": "base/bottom", "displacement": {"normal": [[0.0, 0.0], [9.0, 9.0 * motion]]}},
        ],
        "coupling": {"scheme": "mechanical"},
        "time": {"end": 2.0, "fixed_step": 1.0},
    }  # fmt: skip
    last = final_state(comm, data)
    expected = 4 * viscosity * motion / height
    assert last.totals["upper/base.suction"] == pytest.approx(expected, rel=1e-3)
    assert last.paired("upper/base", "wall_suction") == pytest.approx(expected, rel=1e-3)
    assert np.all(last.paired("upper/base", "contact_pressure") < 1e-6)


def test_a_state_whose_problem_was_freed_refuses_to_sum_it():
    last = list(coupled_cases.states(MPI.COMM_SELF, ring(SHORT)))[-1]
    with pytest.raises(RuntimeError, match=r"at t = 4 s has no totals .* freed by destroy\(\)"):
        _ = last.totals
    assert np.isfinite(last.nodal("casting", "temperature")).all()
