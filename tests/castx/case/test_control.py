"""Time steps, coupling and solvers."""

import math

import pytest

from castx.case.control import Coupling, Solver, Time
from castx.input.problems import Refusal

pytestmark = pytest.mark.serial


def test_times_with_units():
    time = Time.read(
        {
            "end": "1.5 min",
            "first_step": "50 ms",
            "largest_step": 2,
            "smallest_step": "1e-4 s",
            "temperature_change": "20 K",
            "solid_fraction_change": 0.02,
            "skin_change": 0.3,
            "reject_above": 3,
            "heat_substeps": 4,
        }
    )
    assert (time.end, time.first_step, time.largest_step, time.smallest_step) == pytest.approx(
        (90.0, 0.05, 2.0, 1e-4)
    )
    assert (time.temperature_change, time.fixed_step, time.heat_substeps) == (20.0, None, 4)
    assert (time.solid_fraction_change, time.skin_change) == (0.02, 0.3)
    assert time.reject_above == 3.0


@pytest.mark.parametrize("given", [{}, {"largest_step": 1e-3}, {"first_step": 0.1}])
def test_defaults_are_in_order(given):
    time = Time.read({"end": 90, **given})
    assert 0 < time.usual_first_step <= time.largest_step
    assert (time.first_step, time.smallest_step) == (given.get("first_step"), None)
    assert (time.temperature_change, time.heat_substeps) == (20.0, "automatic")
    assert (time.solid_fraction_change, time.skin_change) == (0.04, 0.1)
    assert time.reject_above == 2.0


def test_defaults_of_coupling_and_solver_are_those_of_the_manual():
    coupling, solver = Coupling.read({}), Solver.read({})
    assert (coupling.scheme, coupling.tolerance, coupling.passes) == ("iterated", 1e-3, 40)
    assert (solver.linear, solver.heat_tolerance) == ("automatic", "automatic")


@pytest.mark.parametrize(
    "keys, text",
    [
        ({}, "end: missing"),
        ({"end": 0}, r"end: must be positive \(in s\)"),
        ({"end": "90 m"}, "end: 'm' is not a unit of time"),
        (
            {"end": 90, "first_step": 3, "largest_step": 2},
            "first_step: must not exceed largest_step",
        ),
        (
            {"end": 1, "first_step": 1},
            "first_step: must not exceed largest_step, 0.05 s, by default",
        ),
        (
            {"end": 90, "first_step": 0.1, "smallest_step": 1},
            "smallest_step: must not exceed first",
        ),
        ({"end": 90, "temperature_change": 0}, r"temperature_change: must be positive \(in K\)"),
        ({"end": 90, "temperature_change": "5 s"}, "temperature_change: 's' is not a unit"),
        ({"end": 90, "solid_fraction_change": 0}, "solid_fraction_change: must be positive"),
        ({"end": 90, "solid_fraction_change": 1.5}, "solid_fraction_change: must .*1"),
        ({"end": 90, "reject_above": 0.9}, "reject_above: must .*1"),
        ({"end": 90, "fixed_step": -1}, "fixed_step: must be positive"),
        ({"end": 90, "fixed_step": 1e-9}, "fixed_step: makes more than 10000000 steps"),
        ({"end": 90, "heat_substeps": 0}, 'heat_substeps: "automatic" or a whole number'),
        ({"end": 90, "heat_substeps": True}, 'heat_substeps: "automatic" or a whole number'),
        ({"end": 90, "heat_substeps": 1.5}, 'heat_substeps: "automatic" or a whole number'),
        ({"end": 90, "last_step": 1}, "last_step: unknown key"),
        ({"end": 90, "tolerance": {}}, "tolerance: at least one of temperature, gap and strain"),
        ({"end": 90, "tolerance": {"gap": 0}}, r"tolerance\.gap: must be positive \(in m\)"),
        ({"end": 90, "tolerance": {"gap": "2 K"}}, "tolerance.gap: 'K' is not a unit"),
        ({"end": 90, "tolerance": {"strain": 1}}, "strain: must be positive and below 1"),
        ({"end": 90, "tolerance": {"heat": 1}}, r"tolerance\.heat: unknown key"),
        (
            {"end": 90, "fixed_step": 1, "tolerance": {"gap": 1e-6}},
            "tolerance: chooses the steps: leave it or fixed_step out",
        ),
    ],
)
def test_refused_times(keys, text):
    with pytest.raises(Refusal, match=text):
        Time.read(keys)


def test_with_a_tolerance_only_changes_that_are_given_are_wanted():
    given = {"end": 90, "skin_change": 0.2}
    keys = ("temperature_change", "solid_fraction_change", "skin_change")
    assert [Time.read(given).wanted(key) for key in keys] == [20.0, 0.04, 0.2]
    time = Time.read({**given, "tolerance": {"temperature": "2 K"}})
    assert [time.wanted(key) for key in keys] == [math.inf, math.inf, 0.2]
    assert time.bounds("largest_step") and not time.bounds("temperature_change")
    assert (time.tolerance.temperature, time.tolerance.gap) == (2.0, None)


@pytest.mark.parametrize("scheme", ["thermal", "mechanical", "one-way", "staggered", "iterated"])
def test_schemes(scheme):
    assert Coupling.read({"scheme": scheme}).scheme == scheme


@pytest.mark.parametrize(
    "keys, text",
    [
        ({"scheme": "itrated"}, r'scheme: unknown.*mean "iterated"\?'),
        ({"tolerance": 0}, "tolerance: must be positive and below 1"),
        ({"tolerance": 1}, "tolerance: must be positive and below 1"),
        ({"passes": 0}, "passes: a whole number from 1 to 10000"),
        ({"passes": "40"}, "passes: a whole number"),
    ],
)
def test_refused_coupling(keys, text):
    with pytest.raises(Refusal, match=text):
        Coupling.read(keys)


def test_petsc_options_pass_through():
    options = {
        "ksp_rtol": 1e-9,
        "pc_type": "fieldsplit",
        "snes_max_it": 30,
        "ksp_view": "",
        "snes_monitor": True,
        "ksp_converged_reason": "::failed",
    }
    assert Solver.read({"mechanics": options}).mechanics == options


@pytest.mark.parametrize(
    "option, text",
    [
        ({"-ksp_rtol": 1}, "a PETSc option is named without its leading dash"),
        ({"ksp rtol": 1}, "a PETSc option is named without its leading dash"),
        ({"ksp_rtol": [1]}, "a PETSc option is a text, a number, true or false"),
        ({"pc_type": "python"}, "options that run user code are not allowed"),
        ({"pc_python_type": "os.system"}, "options that run user code are not allowed"),
        ({"ksp_view": "ascii:/etc/passwd"}, "options that write files are not allowed"),
        ({"ksp_view": ":out.m:ascii_matlab"}, "options that write files are not allowed"),
        ({"ksp_view": "x" * 300}, "at most 200 printable characters"),
        ({"ksp_view": "a\n-options_file x"}, "at most 200 printable characters"),
        (5, "a table of PETSc options is needed"),
    ],
)
def test_refused_petsc_options(option, text):
    with pytest.raises(Refusal, match=f"heat.*{text}"):
        Solver.read({"heat": option})


@pytest.mark.parametrize("key", ["heat_tolerance", "mechanics_tolerance"])
def test_tolerances(key):
    assert getattr(Solver.read({key: 1e-6}), key) == 1e-6
    with pytest.raises(Refusal, match=f"{key}: must be positive and below 1"):
        Solver.read({key: -1e-6})


def test_the_heat_tolerance_may_follow_the_passes():
    assert Solver.read({"heat_tolerance": "automatic"}).heat_tolerance == "automatic"
    with pytest.raises(Refusal, match="heat_tolerance: "):
        Solver.read({"heat_tolerance": "fine"})
