"""Methods in turn: what takes over, what is kept, and that a failure leaves nothing behind."""

from __future__ import annotations

import numpy as np
import pytest

from castx.contact.choice import Contact
from castx.errors import CaseError, ConvergenceError
from tests.contact_methods import AT_ONCE, EXACT
from tests.coupled_cases import cylinder, states
from tests.elastic_bodies import (
    blocks,
    body,
    elastic,
    everywhere,
    fixed,
    motion,
    pressures,
    problem,
    pulled,
    pushed,
)


def tilted(comm, method, fallback=()):
    """Return a block that is pushed over on its base, so that pairs open."""
    bodies = {
        "upper": body(
            elastic(7e9, 0.33), loads=(pushed("top", 1e6), pulled("side", 2e5, 0.0))
        ),
        "base": body(elastic(70e9, 0.3)),
    }
    held = {"base": [fixed("bottom", "all")], "upper": [fixed("top", "x")]}
    mesh = blocks(comm, symmetry=False)
    return problem(mesh, bodies, held, [Contact("upper", "base", method, fallback=fallback)])


def failing(monkeypatch, equilibrium):
    def solve(x):
        x.array[:] = 1e9
        raise ConvergenceError("a failure on purpose")

    monkeypatch.setattr(equilibrium._procedure, "solve", solve)


@pytest.mark.parametrize("second", AT_ONCE)
@pytest.mark.parametrize("first", EXACT)
def test_the_next_method_takes_over_for_one_step(comm, monkeypatch, first, second):
    if first == second:
        pytest.skip("a fallback is another method")
    expected = tilted(comm, second)
    expected.equilibrium.solve(0.0)
    made = tilted(comm, first, (second,))
    with monkeypatch.context() as patch:
        failing(patch, made.equilibrium.first)
        made.equilibrium.solve(0.0)
        assert made.equilibrium.fallbacks == 1
    p = pressures(comm, expected)
    assert 0 < np.count_nonzero(p) < len(p)
    np.testing.assert_allclose(pressures(comm, made), p, atol=1e-9 * p.max())
    made.equilibrium.commit()
    assert made.equilibrium.fallbacks == 0
    # The first method is at work again, and starts where the other one ended.
    displacement = everywhere(comm, motion(expected, "upper")[:, :2])
    made.equilibrium.rewind()
    found = everywhere(comm, motion(made, "upper")[:, :2])
    np.testing.assert_allclose(found, displacement, atol=1e-9 * np.abs(displacement).max())
    np.testing.assert_array_equal(everywhere(comm, made.equilibrium.present.active.closed), p > 0)
    alone = tilted(comm, first)
    alone.equilibrium.solve(0.0)
    made.equilibrium.solve(1.0)
    p = pressures(comm, alone)
    np.testing.assert_allclose(pressures(comm, made), p, atol=1e-9 * p.max())


@pytest.mark.ranks
def test_a_step_fails_when_all_methods_do(comm, monkeypatch):
    made = tilted(comm, "condensed", ("penalty",))
    made.equilibrium.solve(0.0)
    made.equilibrium.commit()
    before = everywhere(comm, motion(made, "upper"))
    with monkeypatch.context() as patch:
        failing(patch, made.equilibrium.first)
        made.equilibrium._built["penalty"] = made.equilibrium._others[0][1]()
        failing(patch, made.equilibrium._built["penalty"])
        with pytest.raises(ConvergenceError, match="on purpose; then a failure on purpose"):
            made.equilibrium.solve(1.0)
        made.equilibrium.rewind()
    np.testing.assert_array_equal(everywhere(comm, motion(made, "upper")), before)
    assert made.equilibrium.fallbacks == 0
    made.equilibrium.solve(1.0)


def test_interfaces_agree_about_the_fallback(comm):
    contacts = [
        Contact("upper", "base", fallback=names) for names in (("penalty",), ("multipliers",))
    ]
    bodies = {n: body(elastic(7e9, 0.33)) for n in ("upper", "base")}
    with pytest.raises(CaseError, match=r"contact.fallback \['multipliers'\] and \['penalty'\]"):
        problem(blocks(comm), bodies, {}, contacts)


@pytest.mark.serial
def test_history_counts_what_took_over(comm, monkeypatch, caplog):
    data = cylinder({"time": {"end": 0.2, "fixed_step": 0.1}})
    data["interfaces"][0]["contact"] = {"method": "condensed", "fallback": ["penalty"]}
    run = states(comm, data)
    start = next(run)
    failing(monkeypatch, start.problem.mechanics.equilibrium.first)
    counters = [state.counters for state in run]
    assert [c.fallbacks for c in counters] == [1, 1]
    assert [c.cutbacks for c in counters] == [0, 0]
    assert "contact by penalty takes over for this step: a failure on purpose" in caplog.text


@pytest.mark.serial
def test_history_counts_equilibria_that_do_not_balance(comm):
    """A Krylov method ends them: the steps that are accepted balance."""
    data = cylinder({"time": {"end": 0.2, "fixed_step": 0.1}})
    data["interfaces"][0]["contact"] = {
        "method": "block-iterative", "penalty": 1e14, "block_iterations": 1,
    }  # fmt: skip
    run = states(comm, data)
    next(run)
    for last in run:
        assert last.counters.unbalanced >= 1
        assert max(last.totals[f"{name}.force_error"] for name in last.mesh.bodies) <= 1e-3
    assert last.counters.cutbacks == 0
