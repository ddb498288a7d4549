"""In-gates: they hold a body only while it has lost all contact, and say with what force."""

from __future__ import annotations

import numpy as np
import pytest

from castx.case.contact import Pairing
from castx.contact.choice import Contact
from castx.equilibrium.supports.in_gates import InGate
from castx.errors import CaseError
from castx.mechanics.description import SurfaceLoad
from castx.proof.verification.contact.closed_mould import GRAVITY
from castx.tables import Table
from tests.contact_methods import AT_ONCE
from tests.coupled_cases import final_state
from tests.elastic_bodies import (
    body,
    elastic,
    everywhere,
    generated,
    heat,
    motion,
    places,
    problem,
)
from tests.partitions import PARTITION, along_x
from tests.verification.test_v17_loss_of_contact import case

WIDTH, HEIGHT, SIDEWAYS, UPWARDS = 0.1, 0.06, 1e4, 50.0


def open_box(comm, method="condensed", in_gate=("top",)):
    """Return a box in a rigid mould without a lid, pulled up a little, and sideways at 2 s."""
    made = unsolved_box(comm, method, in_gate)
    # A little too hot, so that the walls hold it.
    cool(made, 30.0, 0.0)
    return made


def unsolved_box(comm, method="condensed", in_gate=("top",)):
    mesh = generated(
        comm, "plane-strain", "box_in_mould", ["casting", "mould"],
        box=[WIDTH, HEIGHT], wall=0.03, size=0.01,
    )  # fmt: skip
    pull = Table.from_points([(0.0, 0.0), (1.0, 0.0), (2.0, SIDEWAYS)])
    loads = (SurfaceLoad("top", traction=(pull, Table.constant(UPWARDS))),)
    return problem(
        mesh, {"casting": body(elastic(70e9, 0.3, 2e-5), loads=loads)}, {},
        [Contact("casting", "mould", method, pairing=Pairing("patches"))],
        in_gate={"casting": list(in_gate)} if in_gate else {},
    )  # fmt: skip


def top(comm, made):
    """Return the displacements of the top without its corners, by place."""
    points = everywhere(comm, places(made, "casting"))
    chosen = (np.abs(points[:, 1] - HEIGHT) < 1e-9) & (np.abs(points[:, 0]) < 0.49 * WIDTH)
    moved = everywhere(comm, motion(made, "casting")[:, :2])[chosen]
    return moved[np.argsort(points[chosen, 0])]


def cool(made, temperature, time):
    heat(made, temperature)
    made.equilibrium.solve(time)
    made.equilibrium.commit()


@pytest.mark.parametrize("method", AT_ONCE)
def test_a_gate_holds_what_touches_nothing_and_bears_its_load(comm, method):
    made = open_box(comm, method)
    assert np.any(everywhere(comm, made.contact_states()[0].closed))
    before = top(comm, made)
    # It shrinks away from the walls, and from the floor since the top stays where it is.
    cool(made, -480.0, 1.0)
    assert not np.any(everywhere(comm, made.contact_states()[0].closed))
    np.testing.assert_allclose(top(comm, made), before, atol=1e-15)
    force, moment = made.equilibrium.supports()["casting"]
    np.testing.assert_allclose(force, [0.0, -UPWARDS * WIDTH], atol=1e-3)
    assert abs(moment[0]) < 1e-3
    # A pull at the top reaches the gate at once, with its arm about the centre of the box.
    cool(made, -480.0, 2.0)
    np.testing.assert_allclose(top(comm, made), before, atol=1e-15)
    force, moment = made.equilibrium.supports()["casting"]
    np.testing.assert_allclose(force, [-SIDEWAYS * WIDTH, -UPWARDS * WIDTH], rtol=1e-5)
    assert moment[0] == pytest.approx(SIDEWAYS * WIDTH * HEIGHT / 2, rel=1e-5)
    assert made.equilibrium.support_force() == pytest.approx(np.linalg.norm(force), rel=1e-9)


@pytest.mark.ranks
@pytest.mark.parametrize("method", AT_ONCE)
def test_it_lets_go_when_contact_comes_back(comm, method):
    expected = open_box(comm, method, in_gate=())
    made = open_box(comm, method)
    cool(made, -480.0, 1.0)
    for problem_ in (made, expected):
        cool(problem_, 60.0, 1.0)
    states = [problem_.contact_states()[0].pressure for problem_ in (made, expected)]
    assert everywhere(comm, states[0]).max() > 1e5
    largest = everywhere(comm, states[1]).max()
    np.testing.assert_allclose(states[0], states[1], atol=1e-6 * largest)
    force, moment = made.equilibrium.supports()["casting"]
    np.testing.assert_allclose(np.append(force, moment), 0.0, atol=1e-6 * largest * WIDTH)


@pytest.mark.ranks
def test_contact_on_one_rank_is_contact_on_all(comm, monkeypatch):
    monkeypatch.setattr(PARTITION, along_x)
    made = unsolved_box(comm)
    upper, gaps = made.bodies["casting"], made.gaps
    gate = InGate(made.equilibrium.balance.transform, gaps, 0, upper, ["top"])
    x = everywhere(comm, gaps.interfaces[0].pairs.points[gaps.interfaces[0].index, 0])
    right = gaps.interfaces[0].pairs.points[gaps.interfaces[0].index, 0] > x.max() - 1e-9
    gate.begin(right)
    assert not gate.acts
    assert gate.update(np.zeros_like(right), settled=True) and gate.acts
    assert gate.update(right, settled=False) and not gate.acts


def test_without_a_gate_the_springs_bear_the_load(comm):
    made = open_box(comm, in_gate=())
    cool(made, -480.0, 1.0)
    force, moment = made.equilibrium.supports()["casting"]
    np.testing.assert_allclose(force, [0.0, -UPWARDS * WIDTH], rtol=1e-6, atol=1e-6)
    assert abs(moment[0]) < 1e-6


def test_refuses_a_gate_without_free_nodes(comm):
    with pytest.raises(CaseError, match="all nodes of mould face another body"):
        open_box(comm, in_gate=("mould",))


@pytest.mark.ranks
def test_a_body_that_touches_is_not_held(comm):
    """The gate changes nothing while the floor carries the weight."""
    data = case(rigid=True)
    data["geometry"]["lid"] = False
    gated = {**data, "support": {"in_gate": ["casting/top"]}}
    plain, held = (final_state(comm, d) for d in (data, gated))
    for name in ("casting/mould.force.y", "casting/mould.mean_gap", "casting.support_force.y"):
        assert held.totals[name] == pytest.approx(plain.totals[name], rel=1e-9, abs=1e-9)


@pytest.mark.ranks
def test_history_names_force_and_moment(comm):
    """Without a lid and with gravity upwards, the box would rise for ever."""
    data = case(rigid=True)
    data["geometry"]["lid"] = False
    data["loads"] = {"gravity": [0.0, GRAVITY]}
    data["support"] = {"in_gate": ["casting/top"]}
    totals = final_state(comm, data).totals
    assert totals["casting.support_force.y"] == pytest.approx(-141.264, rel=1e-6)
    assert totals["casting.support_force.x"] == pytest.approx(0.0, abs=1e-3)
    assert totals["casting.support_moment.z"] == pytest.approx(0.0, abs=1e-3)
    assert totals["support_force"] == pytest.approx(141.264, rel=1e-6)
