"""Displacements that are not small are told once for each body, and absurd ones end a run."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from castx.case.reading.read import read_case
from castx.command.cli import execute
from castx.command.watches.deformations import DeformationWatch
from castx.errors import ConvergenceError
from castx.results.states.snapshot import ProcessState
from tests.castx.case_data import cylinder
from tests.castx.fakes import FakeSnapshot, cylinder_mesh
from tests.partitions import PARTITION, on_the_last

LISTENED = "castx.command.watches.deformations"


def moved(gradient, offset=(0.0, 0.0), solid=1.0):
    """Return formulas of a displacement u = H x + c, in metres, and of a solid fraction."""
    slope = np.array(gradient)
    return {
        "displacement": lambda x: x @ slope.T + np.array(offset),
        "solid_fraction": lambda x: np.full(len(x), solid),
    }


def check(comm, *states, **changes):
    watch = DeformationWatch(read_case(cylinder(**changes), Path("case.toml")), comm)
    mesh = cylinder_mesh(comm)
    for step, formulas in enumerate(states):
        watch.check(FakeSnapshot(time=float(step), step=step, mesh=mesh, formulas=formulas))


def test_small_displacements_are_not_worth_a_word(comm, heard):
    turned = moved([[0.0, -0.05], [0.05, 0.0]])
    check(comm, moved(np.zeros((2, 2))), moved([[0.06, 0.0], [0.0, 0.06]]), turned)
    assert heard == []


@pytest.mark.ranks
@pytest.mark.parametrize("gradient", [[[0.0, 0.2], [0.0, 0.0]], [[0.0, 0.15], [-0.15, 0.0]]])
def test_strains_and_turns_of_solids_are_told_once_for_each_body(comm, heard, gradient):
    """A rotation too: linear strains take it for a strain."""
    check(comm, moved(gradient), moved(gradient))
    bodies = ("casting", "mould") if comm.rank == 0 else ()
    assert len(heard) == len(bodies)
    for body, text in zip(bodies, heard, strict=True):
        assert text.startswith(f"at t = 0 s {body} is displaced by")
        assert f"by up to {100.0 * np.linalg.norm(gradient):.3g} % at (" in text
        assert "displacements are taken as small, with errors of that order above 10 %" in text


def test_liquid_may_flow_and_a_body_may_not_leave(comm, heard):
    check(comm, moved([[0.0, 0.2], [0.0, 0.0]], solid=0.5))
    check(comm, moved(np.zeros((2, 2)), offset=(0.0, 1.0), solid=0.5))
    assert heard == []
    check(comm, moved(np.zeros((2, 2)), offset=(0.0, 0.02)))
    assert len(heard) == (2 if comm.rank == 0 else 0)


@pytest.mark.ranks
def test_what_flowed_as_a_liquid_is_no_strain_of_the_solid(comm, heard):
    """Cells of a casting had turned by more than 100 % when they froze, and the run ended."""
    flowed, strained = [[0.12, 0.0], [0.0, 0.0]], [[0.32, 0.0], [0.0, 0.0]]
    check(comm, moved(flowed, solid=0.5), moved(flowed))
    assert heard == []
    check(comm, moved(flowed, solid=0.5), moved(flowed), moved(strained))
    assert len(heard) == (2 if comm.rank == 0 else 0)
    assert all("strained and turned by up to 20 % at" in text for text in heard)


@pytest.mark.ranks
def test_what_sank_as_a_liquid_is_no_displacement_of_the_solid(comm, heard):
    """The pipe of a feeder was half as deep as its casting, and the run ended."""
    still = np.zeros((2, 2))
    sunk, further = (moved(still, offset=(0.0, -depth)) for depth in (0.03, 0.045))
    check(comm, moved(still, offset=(0.0, -0.03), solid=0.5), sunk)
    assert heard == []
    check(comm, moved(still, offset=(0.0, -0.03), solid=0.5), sunk, further)
    assert len(heard) == (2 if comm.rank == 0 else 0)


@pytest.mark.ranks
def test_absurd_displacements_end_a_run_on_all_ranks(comm, heard):
    with pytest.raises(ConvergenceError, match=r"casting .* by up to 150 % .* beyond 50 % a run"):
        check(comm, moved([[1.5, 0.0], [0.0, 0.0]]))
    with pytest.raises(ConvergenceError, match="casting is displaced by"):
        check(comm, moved(np.zeros((2, 2)), offset=(1.0, 0.0)))


def test_an_absurd_displacement_names_what_the_stage_has_removed(comm, heard):
    """A casting may have let go of all that held it."""
    stages = [{"at": 5.0, "spray": {"coefficient": 10, "ambient": 20}},
              {"at": 6.0, "remove": ["mould"]}]  # fmt: skip
    watch = DeformationWatch(read_case(cylinder(stages=stages), Path("case.toml")), comm)
    away = moved(np.zeros((2, 2)), offset=(1.0, 0.0))
    for stage, told in ((0, False), (1, False), (2, True)):
        state = FakeSnapshot(time=9.0, step=0, mesh=cylinder_mesh(comm), formulas=away,
                             process=ProcessState(stage=stage))  # fmt: skip
        with pytest.raises(ConvergenceError, match="casting is displaced by") as caught:
            watch.check(state)
        assert ("since stage 2 has removed mould" in str(caught.value)) == told


@pytest.mark.ranks
def test_they_do_on_ranks_without_cells(comm, heard, monkeypatch):
    monkeypatch.setattr(PARTITION, on_the_last)
    with pytest.raises(ConvergenceError, match=r"casting .* by up to 150 % .* beyond 50 % a run"):
        check(comm, moved([[1.5, 0.0], [0.0, 0.0]]))
    with pytest.raises(ConvergenceError, match="casting is displaced by"):
        check(comm, moved(np.zeros((2, 2)), offset=(1.0, 0.0)))


def test_what_is_rigid_or_not_moved_is_not_looked_at(comm, heard):
    check(comm, moved([[1.5, 0.0], [0.0, 0.0]]), coupling={"scheme": "thermal"})
    assert heard == []


NONSENSE = {
    "displacement": ('boundaries.0.displacement={ normal = "1 m" }', "displacement normal: 1 m"),
    "interference": (
        'interfaces.0.contact={ initial_gap = "-0.5 m" }',
        "initial_gap: an interference: 0.5 m",
    ),
}


@pytest.mark.parametrize("kind", NONSENSE)
@pytest.mark.parametrize("command", ["check", "run"])
def test_nonsense_is_refused_before_anything_is_solved(
    comm, case_file, shared_tmp_path, said, command, kind
):
    change, text = NONSENSE[kind]
    arguments = [command, str(case_file), "--set", change]
    if command == "run":
        arguments += ["--output", str(shared_tmp_path / "out")]
    assert execute(arguments, comm) == 2
    found = said()
    assert text in found and "displacements and strains are taken as small" in found


@pytest.mark.ranks
def test_a_run_ends_when_its_part_is_torn(comm, case_file, shared_tmp_path, said):
    """The base is lifted by 19.9 mm, less than half the part, and the top is held."""
    folder = shared_tmp_path / "out"
    lift = 'boundaries.0.displacement={ normal = "-19.9 mm" }'
    hold = 'boundaries.1={ on = "casting/top", displacement = { normal = 0 } }'
    arguments = ["run", str(case_file), "--output", str(folder), "--set", lift, "--set", hold]
    arguments += ["--set", "bodies.0.temperature=400", "--set", "interfaces=[]"]
    assert execute(arguments, comm) == 3
    text = said()
    assert "casting is displaced by 50" in text and "beyond 50 % a run ends" in text
    assert json.loads((folder / "run.json").read_text())["exit"]["reason"] == "not converged"
