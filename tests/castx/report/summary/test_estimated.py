"""Estimated errors beside the numbers of a run."""

import pytest

from castx.report.summary.estimated import error_texts, with_estimates
from castx.report.summary.finding import Finding
from castx.results.files.estimate import Coarser, Estimate, write_estimate
from tests.castx.report.summary.fake_run import run

pytestmark = pytest.mark.serial

GAP = Finding("Largest gap", "casting/mould", 1.2e-4, "µm", "", factor=1e6)
INPUT = Finding("Coherency", "casting", 0.9, "", "")


def estimate(gap_in_mesh=1e-4, gap_in_steps=1.25e-4):
    def coarser(folder, gap):
        values = {GAP.name: gap, INPUT.name: 0.9}
        return Coarser(folder=folder, ratio=2.0, ended="finished", values=values)

    return Estimate(
        reached=60.0, values={GAP.name: GAP.value, INPUT.name: 0.9},
        mesh=coarser("m", gap_in_mesh), steps=coarser("s", gap_in_steps),
    )  # fmt: skip


def fake(folder, reached=60.0):
    return run(folder=folder, record=run().record | {"time_reached": reached})


def test_a_number_says_how_far_it_is_off(tmp_path):
    write_estimate(tmp_path, estimate())
    gap, given = with_estimates([GAP, INPUT], fake(tmp_path))
    assert gap.error == "± 20 µm by the mesh, ± 5 µm by the steps"
    assert given.error == ""


def test_a_run_that_went_on_has_none(tmp_path):
    write_estimate(tmp_path, estimate())
    assert with_estimates([GAP], fake(tmp_path, 90.0)) == [GAP]


def test_a_run_without_estimates_has_none(tmp_path):
    assert with_estimates([GAP], fake(tmp_path)) == [GAP]


def test_another_number_of_the_name_has_none():
    other = Finding("Largest gap", "casting/mould", 1.3e-4, "µm", "", factor=1e6)
    assert error_texts(other, estimate()) == ("", "")
    assert error_texts(GAP, estimate().model_copy(update={"mesh": None})) == ("", "± 5 µm")
