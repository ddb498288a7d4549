"""Clamps of a case as the mechanics sees them, and those that cannot press."""

from __future__ import annotations

import pytest

from castx.case.boundaries import Boundary
from castx.command.cli import execute
from castx.coupling.clamps import surface_clamps
from castx.errors import CaseError
from tests.castx.mutations import toml
from tests.coupled_cases import ring, simulation

CLAMP = {"force": "20 kN", "stiffness": "1 MN/mm"}


# Conditions are the same on all ranks; the one that sees nodes of a rank is refused on several.
pytestmark = pytest.mark.sampled


def test_numbers_and_axes_reach_the_mechanics():
    given = [
        Boundary.read({"on": "die/back", "clamp": {**CLAMP, "direction": "z"}}),
        Boundary.read({"on": "die/side", "pressure": 1.0}),
        Boundary.read({"on": "die/top", "clamp": {"stiffness": 5}}),
    ]
    back, top = surface_clamps(given, "axisymmetric")
    assert (back.surface, back.axis, back.force(9.0)) == ("back", 1, 2e4)
    assert back.stiffness == pytest.approx(1e9)
    assert (top.surface, top.axis, top.force(0.0), top.stiffness) == ("top", None, 0.0, 5.0)
    assert surface_clamps(given, "3d")[0].axis == 2


FRAME = {"stiffness": 1e9, "direction": "all"}


def clamped(on: str, clamp=CLAMP, **conditions):
    """Return the coarse ring with a clamp on one of its surfaces."""
    data = ring({"time": {"end": 1.0, "fixed_step": 1.0}}, size=0.01)
    given = {on: {}, **{boundary["on"]: boundary for boundary in data["boundaries"]}}
    given[on] = {**given[on], "on": on, "clamp": clamp, **conditions}
    return {**data, "boundaries": list(given.values())}


@pytest.mark.ranks
@pytest.mark.parametrize(
    "data, text",
    [
        (clamped("core/base"), "displacement conditions prescribe the motion of the whole surfac"),
        (clamped("casting/top", displacement={"z": 1e-5}), "force and stiffness would have no ef"),
        (clamped("casting/top", displacement={"all": 0.0}), 'or the displacement ("uniform" make'),
        (clamped("core/base", FRAME, displacement={"all": 0.0}), "displacement conditions prescri"),
        (clamped("casting/outside"), "the surface is not flat"),
        (clamped("casting/outside", {**CLAMP, "direction": "z"}), "only 0 of the surface faces"),
    ],
)
def test_refused_before_anything_is_solved(comm, data, text, shared_tmp_path, capsys):
    with pytest.raises(CaseError) as caught:
        simulation(comm, data)
    assert text in str(caught.value) and "clamp" in str(caught.value)
    file = shared_tmp_path / "case.toml"
    if comm.rank == 0:
        file.write_text(toml(data))
    comm.Barrier()
    capsys.readouterr()
    assert execute(["check", str(file)], comm) == 2
    said = comm.bcast(" ".join("".join(capsys.readouterr()).split()))
    assert text in said and "Traceback" not in said


@pytest.mark.serial
@pytest.mark.parametrize(
    "data",
    [
        clamped("core/top", displacement={"r": 0.0}),
        clamped("casting/top", displacement={"z": "uniform"}),
        clamped("core/base", displacement={"r": 0.0}),
        clamped("casting/outside", FRAME),
        {**clamped("core/base"), "coupling": {"scheme": "thermal"}},
    ],
    ids=["along the surface", "rigid plate", "replaced", "a frame on a round", "no mechanics"],
)
def test_accepted(comm, data):
    simulation(comm, data).destroy()


@pytest.mark.ranks
def test_a_stage_may_not_hold_what_is_clamped(comm):
    """Nor clamp what an earlier stage holds: the conditions of a stage are those of all before."""
    data = clamped("casting/top")
    held = {"at": 0.5, "boundaries": [{"on": "casting/top", "displacement": {"normal": 0.0}}]}
    with pytest.raises(CaseError, match="'casting/top', clamp: displacement conditions"):
        simulation(comm, {**data, "stages": [held]})
