"""Coupled castings whose mesh does not match that of their mould: heat, contact, files, restart."""

from __future__ import annotations

from pathlib import Path

import gmsh
import numpy as np
import pytest

from castx.checkpoint.file import Checkpoint
from castx.command.cli import execute
from castx.domain.source import gmsh_session
from castx.errors import CaseError
from castx.results.files.series import read_series
from tests.castx.checkpoint.test_file import difference
from tests.contact_methods import AT_ONCE
from tests.coupled_cases import (
    TIGHT,
    cylinder,
    fields,
    final_state,
    merged,
    simulation,
)

pytestmark = pytest.mark.sampled

RADIUS, HEIGHT, WALL = 0.03, 0.06, 0.025
SURFACES = {"casting": "side", "mould": "bore"}


def draw(sizes: dict[str, float]) -> None:
    """Draw casting and mould as rectangles of (r, z) that share nothing."""
    places = {"casting": (0.0, RADIUS), "mould": (RADIUS, RADIUS + WALL)}
    names = {"casting": ("base", "side", "top", None), "mould": ("base", "outside", "top", "bore")}
    for name, (inner, outer) in places.items():
        geo, h = gmsh.model.geo, sizes[name]
        corners = ((inner, 0.0), (outer, 0.0), (outer, HEIGHT), (inner, HEIGHT))
        p = [geo.addPoint(*corner, 0.0, h) for corner in corners]
        sides = [geo.addLine(p[k], p[(k + 1) % 4]) for k in range(4)]
        surface = geo.addPlaneSurface([geo.addCurveLoop(sides)])
        geo.synchronize()
        gmsh.model.addPhysicalGroup(2, [surface], name=name)
        for side, label in zip(sides, names[name], strict=True):
            if label is not None:
                # Of several bodies the same label is one group with the lines of both.
                gmsh.model.addPhysicalGroup(1, [side], name=f"{name} {label}")
    gmsh.model.mesh.generate(2)


@pytest.fixture
def mesh_file(comm, shared_tmp_path) -> Path:
    """Return the file of a fine casting in a coarse mould."""
    path = shared_tmp_path / "cylinder.msh"
    if comm.rank == 0:
        with gmsh_session():
            draw({"casting": 0.004, "mould": 0.0065})
            gmsh.write(str(path))
    comm.Barrier()
    return path


def unmatched(file: Path, *changes, bodies=("casting", "mould"), **contact) -> dict:
    """Return the cylinder of the other tests on that mesh."""
    data = cylinder(*changes)
    data["geometry"] = {"file": str(file), "model": "axisymmetric"}
    data["interfaces"][0]["bodies"] = list(bodies)
    data["interfaces"][0]["contact"] = {
        "pairing": "node-to-face", "surfaces": [f"{b} {SURFACES[b]}" for b in bodies], **contact,
    }  # fmt: skip
    data["boundaries"] = [
        {"on": f"{body}/{body} base", "displacement": {"normal": 0.0}} for body in SURFACES
    ]
    return data


@pytest.mark.parametrize("bodies", [("casting", "mould"), ("mould", "casting")])
@pytest.mark.parametrize("method", AT_ONCE)
def test_as_on_matching_meshes(comm, mesh_file, method, bodies):
    """Temperatures and gaps are those of matching meshes; no heat is lost between the surfaces."""
    end = {"time": {"end": 10.0}}
    state = final_state(comm, unmatched(mesh_file, end, bodies=bodies, method=method))
    exact = final_state(comm, cylinder(end, method=method, size=0.004))
    found, wanted = state.totals, exact.totals
    name = "/".join(bodies)
    sign = 1.0 if bodies[0] == "casting" else -1.0
    assert found["mould.heat_in"] == pytest.approx(sign * found[f"{name}.heat"], rel=1e-10)
    assert found["casting.heat_in"] == pytest.approx(-found["mould.heat_in"], rel=1e-10)
    assert found["energy_error"] < 1e-6
    assert found["casting.heat_in"] == pytest.approx(wanted["casting.heat_in"], rel=0.01)
    gap = wanted["casting/mould.mean_gap"]
    assert gap > 2e-5
    assert found[f"{name}.mean_gap"] == pytest.approx(gap, rel=0.05)
    assert found["casting.solid_fraction"] == pytest.approx(
        wanted["casting.solid_fraction"], abs=0.01
    )


def squeezed(file: Path, bodies, method: str) -> dict:
    """Return a casting that is a little too large for its mould."""
    data = merged(unmatched(file, bodies=bodies, method=method, initial_gap=-2e-5), TIGHT)
    for body in data["bodies"]:
        body["temperature"] = 300.0
    for material in data["materials"].values():
        material["stress_free"] = 300.0
    data["time"] = {"end": 1.0, "fixed_step": 1.0}
    return data


@pytest.mark.parametrize("bodies", [("casting", "mould"), ("mould", "casting")])
@pytest.mark.parametrize("method", AT_ONCE)
def test_action_is_reaction(comm, mesh_file, method, bodies):
    """The forces on both bodies add up to nothing."""
    state = final_state(comm, squeezed(mesh_file, bodies, method))
    forces = {}
    for body in bodies:
        mechanics = state.problem.mechanics.bodies[body]
        rows = mechanics.residual().reshape(-1, mechanics.block_size)
        points = mechanics.mesh.points[: len(rows)]
        free = points > 1e-9  # off the axis and the base, which hold them
        forces[body] = comm.allreduce(np.sum(np.where(free, rows[:, :2], 0.0), axis=0))
    total = np.abs(forces["casting"][0])
    assert total > 1e3
    np.testing.assert_allclose(forces["casting"] + forces["mould"], 0.0, atol=1e-10 * total)
    assert state.totals["/".join(bodies) + ".closed_fraction"] == pytest.approx(1.0)


def test_a_run_goes_on_from_a_checkpoint(comm, mesh_file, shared_tmp_path):
    data = unmatched(mesh_file, {"time": {"end": 1.0}}, TIGHT)
    run, checkpoint = simulation(comm, data), Checkpoint(shared_tmp_path, comm)
    for state in run:
        if state.step == 3:
            checkpoint.write(run.saved(), {})
    whole = fields(state)
    run = simulation(comm, data)
    header = checkpoint.read_header()
    run.restore(checkpoint.read(header, run.saved()))
    *_, state = run
    largest, where = difference(fields(state), whole)
    assert largest < 1e-9, where


CASE = """
[geometry]
file = "cylinder.msh"
model = "axisymmetric"
# Elastic melt parts from its wall at once, long before a shell would.
[materials.elastic]
extends = "Al-pure"
liquid = "none"
[[bodies]]
name = "casting"
material = "elastic"
temperature = 670
[[bodies]]
name = "mould"
material = "steel-H13"
temperature = 200
formulation = "displacement"
[[interfaces]]
bodies = ["casting", "mould"]
[interfaces.contact]
pairing = "node-to-face"
surfaces = ["casting side", "mould bore"]
normals = "primary"
[interfaces.heat]
law = "limited"
closed = 2300
gas_conductivity = 0.05
[[boundaries]]
on = "casting/casting base"
displacement = { normal = 0 }
[[boundaries]]
on = "mould/mould base"
displacement = { normal = 0 }
[time]
end = 2
first_step = 0.1
[output]
every = 1
fields = ["temperature", "gap", "contact_pressure", "displacement"]
[[probes]]
name = "gap"
interface = "casting/mould"
at = [0.03, 0.0311]
quantities = ["gap", "heat_transfer_coefficient"]
"""


@pytest.mark.ranks
def test_the_command_line_runs_it(comm, mesh_file, shared_tmp_path, capsys):
    path = shared_tmp_path / "case.toml"
    if comm.rank == 0:
        path.write_text(CASE)
    comm.Barrier()
    assert execute(["check", str(path)], comm) == 0
    if comm.rank == 0:
        assert "interface casting/mould: 16 nodes face facets" in capsys.readouterr().out
    assert execute(["run", str(path), "--output", str(shared_tmp_path / "out")], comm) == 0
    probes = read_series(shared_tmp_path / "out" / "probes.csv")
    assert probes["gap.gap"][-1] > 1e-6
    assert 0 < probes["gap.heat_transfer_coefficient"][-1] <= 2300
    history = read_series(shared_tmp_path / "out" / "history.csv")
    assert history["energy_error"][-1] < 1e-6


def test_refused(comm, mesh_file):
    data = unmatched(mesh_file)
    data["interfaces"][0]["heat"] = {"law": "perfect"}
    with pytest.raises(CaseError, match=r'heat\.law.*"perfect" joins the nodes of matching meshes'):
        final_state(comm, data)


@pytest.mark.parametrize("bodies", [("casting", "mould"), ("mould", "casting")])
def test_quadratic_bodies_as_linear_ones(comm, mesh_file, bodies):
    """Freezing in a mould, both of quadratic displacements: heat and gap are those of matching."""
    end = {"time": {"end": 10.0}}
    data = unmatched(mesh_file, end, bodies=bodies)
    for body in data["bodies"]:
        body["formulation"] = "taylor-hood"
    found = final_state(comm, data).totals
    wanted = final_state(comm, cylinder(end, size=0.004)).totals
    gap = wanted["casting/mould.mean_gap"]
    assert found["/".join(bodies) + ".mean_gap"] == pytest.approx(gap, rel=0.05)
    assert found["casting.heat_in"] == pytest.approx(wanted["casting.heat_in"], rel=0.01)
    assert found["casting.force_error"] < 1e-3
