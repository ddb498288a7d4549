"""Prescribed temperatures follow their tables; interfaces have the coefficients of their laws."""

from __future__ import annotations

import numpy as np
import pytest

from castx.coupling.prescribed import PrescribedBody, PrescribedTemperatures
from castx.heat.interface import HeatExchange
from castx.materials.description import MaterialDescription
from castx.materials.lookup import find_material
from castx.tables import Table
from castx.transfer.conductance import ConstantConductance
from castx.transfer.pair_state import PairState
from tests.castx.fakes import casting_pairs, cylinder_mesh

MELTING = {
    "density": 2700.0, "heat_capacity": 1000.0, "conductivity": 100.0, "latent_heat": 4e5,
    "solidus": 500.0, "liquidus": 600.0,
}  # fmt: skip


class LawOfEverything:
    """h = T_s − T_p + 1000 F_s + time, to see what a law is given."""

    needs_solid_fraction = True

    def __call__(self, state, faces):
        law = ConstantConductance(0.0)(state, faces)
        h = faces.secondary - faces.primary + faces.solid_fraction * 1000.0 + faces.time
        return type(law)(h, law.contact)


def material(name, **values):
    return find_material(name, {name: MaterialDescription.read(values)})


def problem(comm, *exchanges):
    mesh = cylinder_mesh(comm)
    pairs = casting_pairs(mesh)["casting/mould"]
    solid = {key: MELTING[key] for key in ("density", "heat_capacity", "conductivity")}
    bodies = {
        "casting": PrescribedBody(
            material("metal", **MELTING), Table.from_points([[0.0, 650.0], [10.0, 450.0]])
        ),
        "mould": PrescribedBody(material("steel", **solid), Table.constant(200.0)),
    }
    given = [HeatExchange("casting/mould", pairs, *exchange) for exchange in exchanges]
    closed = PairState.of(np.zeros(len(pairs.areas)), np.zeros(len(pairs.areas)))
    return PrescribedTemperatures(mesh, bodies, given), closed


def test_temperatures_and_solid_fractions_follow_the_tables(comm):
    heat, _ = problem(comm)
    report = heat.advance(0.0, 5.0)
    assert (heat.temperature["casting"].x.array == 550.0).all()
    assert (heat.temperature["mould"].x.array == 200.0).all()
    np.testing.assert_allclose(heat.solid_fraction["casting"].x.array, 0.5)
    assert (heat.solid_fraction["mould"].x.array == 1.0).all()
    assert report.largest_temperature_change == 100.0 and report.iterations == 0
    assert not heat.enthalpy and not heat.totals()


def test_a_rejected_step_leaves_no_trace(comm):
    heat, _ = problem(comm)
    heat.advance(0.0, 2.0)
    heat.commit()
    heat.advance(2.0, 6.0)
    heat.rewind()
    assert (heat.temperature["casting"].x.array == 610.0).all()
    assert (heat.solid_fraction["casting"].x.array == 0.0).all()


def test_the_time_is_all_that_is_saved_and_belongs_to_the_cycle(comm):
    heat, _ = problem(comm)
    heat.advance(0.0, 2.5)
    heat.commit()
    (name, saved), = heat.saved().items()
    assert saved.of_cycle
    other, _ = problem(comm)
    other.restore({name: saved.values})
    assert (other.temperature["casting"].x.array == 600.0).all()


def test_coefficients_are_those_of_the_kinds_and_laws(comm):
    heat, closed = problem(comm, ("perfect",), ("none",), ("law", LawOfEverything()))
    heat.advance(0.0, 5.0)
    perfect, none, law = heat.coefficients([closed] * 3)
    assert len(perfect) == len(closed.gap)
    assert np.isposinf(perfect).all() and not none.any()
    np.testing.assert_allclose(law, 550.0 - 200.0 + 500.0 + 5.0, rtol=1e-12)


@pytest.mark.serial
def test_pairs_may_have_states_of_their_own(comm):
    heat, closed = problem(comm, ("law", ConstantConductance(40.0)))
    assert heat.coefficients([closed.at(np.array([0, 2]))])[0].tolist() == [40.0, 40.0]


def test_given_temperatures_have_no_error(comm):
    heat, closed = problem(comm)
    heat.advance(0.0, 5.0)
    error = heat.step_error([(closed, closed)])
    assert (error.made, error.uniform) == (0.0, 0.0)
