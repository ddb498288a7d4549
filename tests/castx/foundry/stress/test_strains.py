"""Strain in the mush behind a front that travels evenly, from fields given as formulas."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import pytest

from castx.foundry.front.windows import Window
from castx.foundry.stress.strains import BodyStrains, largest_principal, strain_beside
from castx.results.states.snapshot import ProcessState
from castx.solvers.counters import StepCounters
from tests.castx.fakes import FakeSnapshot, slab_mesh

GRADIENT, SPEED, RATE, STEP = 2e4, 1e-3, 3e-3, 0.08
LENGTH, SIZE = 3e-3, 5e-4
BEGIN, END, LATER = 555.0, 552.0, 551.0


@dataclass
class Followed:
    name: str = "temperature"
    windows: dict = field(
        default_factory=lambda: {0.95: Window(BEGIN, END), 0.99: Window(BEGIN, LATER)}
    )

    def shrinking(self, fraction):
        return -0.05 * fraction


def strain(time):
    """Strain that grows along the gradient and, half as fast, across it, and shear with both."""

    def of_cells(points):
        rows = np.tile([5.0, 1.0, 0.5, 0.3, 0.2, 0.0], (len(points), 1))
        return RATE * time * rows

    return of_cells


def snapshot(mesh, time, step, solid=1.0, process=None):
    return FakeSnapshot(
        time,
        step,
        mesh,
        formulas={
            "temperature": lambda x: BEGIN + 1.0 + GRADIENT * (x[:, 0] - SPEED * time),
            "solid_fraction": lambda x: np.full(len(x), 0.5 + 0.01 * time),
            "mechanical_strain": strain(time),
            "coherent": lambda x: np.full(len(x), solid),
        },
        process=ProcessState() if process is None else process,
    )


def follow(mesh, strains, steps, **given):
    for step in steps:
        strains.update(snapshot(mesh, STEP * step, step, **given))


@pytest.fixture
def body(comm):
    return slab_mesh(comm, SIZE, LENGTH)


STEPS = range(int((LENGTH / SPEED + 0.5) / STEP))


@pytest.mark.ranks
def test_strain_across_the_gradient_while_the_front_passes(body):
    strains = BodyStrains(body.bodies["casting"], Followed())
    follow(body, strains, STEPS)
    for until, width in ((0.95, BEGIN - END), (0.99, BEGIN - LATER)):
        passing = width / (GRADIENT * SPEED)
        np.testing.assert_allclose(strains.duration(until), passing, rtol=1e-9)
        np.testing.assert_allclose(strains.largest(until), RATE * passing, rtol=1e-9)
        skeleton = RATE * passing - 0.05 * 0.01 * passing / 3.0
        found = strains.largest_beside_shrinkage(until)
        np.testing.assert_allclose(found, skeleton, rtol=1e-9)


@pytest.mark.ranks
def test_no_node_has_strain_before_it_has_passed(body):
    strains = BodyStrains(body.bodies["casting"], Followed())
    follow(body, strains, STEPS[: len(STEPS) // 2])
    x = body.bodies["casting"].points[:, 0]
    cold = BEGIN + 1.0 + GRADIENT * (x - SPEED * STEP * STEPS[len(STEPS) // 2 - 1]) <= LATER
    np.testing.assert_array_equal(np.isfinite(strains.largest(0.99)), cold)


@pytest.mark.ranks
def test_liquid_has_no_skeleton_that_could_be_strained(body):
    strains = BodyStrains(body.bodies["casting"], Followed())
    follow(body, strains, STEPS, solid=0.0)
    assert np.all(strains.largest(0.99) == 0.0)
    assert np.all(strains.duration(0.99) > 0.0)


def test_a_history_goes_on_where_it_was(body):
    there = body.bodies["casting"]
    whole, first = (BodyStrains(there, Followed()) for _ in range(2))
    follow(body, whole, STEPS)
    half = len(STEPS) // 2
    follow(body, first, STEPS[:half])
    second = BodyStrains(there, Followed())
    second.restore({name: saved.values for name, saved in first.saved().items()})
    follow(body, second, STEPS[half:])
    for until in (0.95, 0.99):
        np.testing.assert_array_equal(second.largest(until), whole.largest(until))
        np.testing.assert_array_equal(second.duration(until), whole.duration(until))


def test_what_melts_or_is_poured_anew_begins_again(body):
    strains = BodyStrains(body.bodies["casting"], Followed())
    follow(body, strains, STEPS)
    once, passing = strains.largest(0.99), strains.duration(0.99)
    hot = STEPS[-1] + 1
    strains.update(FakeSnapshot(STEP * hot, hot, body, formulas={
        "temperature": lambda x: np.full(len(x), 600.0),
        "mechanical_strain": lambda x: np.zeros((len(x), 6)),
    }))  # fmt: skip
    assert np.isnan(strains.largest(0.99)).all()
    follow(body, strains, STEPS[1:])
    assert np.isfinite(strains.largest(0.99)).all()
    renewed = BodyStrains(body.bodies["casting"], Followed())
    follow(body, renewed, STEPS)
    new = ProcessState(renewed=frozenset({"casting"}))
    poured = replace(snapshot(body, STEP, 1, process=new), counters=StepCounters(step=STEP))
    renewed.update(poured)
    follow(body, renewed, STEPS[2:])
    np.testing.assert_allclose(renewed.largest(0.99), once, rtol=1e-9)
    np.testing.assert_allclose(renewed.duration(0.99), passing, rtol=1e-9)


def test_largest_principal_values():
    shear = np.array([[0.0, 0.0, 0.0, 2e-3, 0.0, 0.0], [-1.0, -2.0, -3.0, 0.0, 0.0, 0.0]])
    np.testing.assert_allclose(largest_principal(shear), [2e-3, 0.0], atol=1e-18)
    assert np.isnan(largest_principal(np.full((1, 6), np.nan))).all()


def test_parts_along_one_direction_are_left_out_and_all_count_where_there_is_none():
    """Second eigenvalue 0, a quarter of the first one, equal to it; last there is no gradient."""
    strain = np.tile([4.0, 1.0, 0.5, 0.0, 0.0, 0.0], (4, 1))
    along = np.array([np.diag([9.0, 9.0 * part]) for part in (0.0, 0.25, 1.0)] + [np.zeros((2, 2))])
    found = strain_beside(strain, along)
    np.testing.assert_allclose(found[:, 0], [0.0, 1.0, 4.0, 4.0], atol=1e-12)
    np.testing.assert_allclose(found[:, 1:3], strain[:, 1:3], rtol=1e-12)


@pytest.mark.ranks
def test_fronts_that_meet_have_one_direction(body):
    """Temperatures fall to both sides of the middle, where the mean gradient vanishes."""
    strains = BodyStrains(body.bodies["casting"], Followed())
    for step in range(20):
        state = snapshot(body, STEP * step, step)
        state.formulas["temperature"] = lambda x, time=STEP * step: (
            BEGIN + 20.0 - GRADIENT * SPEED * time - GRADIENT * np.abs(x[:, 0] - 0.5 * LENGTH)
        )
        strains.update(state)
    found = strains.largest(0.99)
    assert np.isfinite(found).any()
    passing = (BEGIN - LATER) / (GRADIENT * SPEED)
    np.testing.assert_allclose(found[np.isfinite(found)], RATE * passing, rtol=1e-9)
