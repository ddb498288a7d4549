"""Mush beside solid: one metal while nothing flows, two as soon as one of them does."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from castx.materials.flow import PLASTIC, VISCOPLASTIC
from castx.mechanics.constitutive.eigenstrain import front_normals
from castx.mechanics.constitutive.history import PointHistory
from castx.mechanics.constitutive.law import ELASTIC, Conditions, Law
from castx.mechanics.constitutive.mush import across_one_layer
from castx.mechanics.constitutive.response import Response, foreseen, respond
from castx.mechanics.constitutive.return_mapping import tensor_norm
from tests.castx.mechanics.constitutive.metals import NEWTONIAN, NORTON, YIELD, G, after, strains
from tests.elastic_bodies import elastic

SOLIDUS, LIQUIDUS = 560.0, 610.0
TIMES = (616.0, 596.0, 586.0, 576.0, 566.0)
"""Temperatures of the far end of the slab at the ends of the steps [°C]."""
WEAK = 2e6
FALL = 1500.0
"""Of the temperature along the slab [K/m], 7.5 K in a cell."""


def law(
    name: str,
    yields: float = YIELD,
    liquid: dict[str, Any] = NEWTONIAN,
    poisson: float = 0.3,
    **given: Any,
) -> Law:
    """Return a law that finds the share of solid inside the cells."""
    material = elastic(
        60e9, poisson, 2e-5, solidus=SOLIDUS, liquidus=LIQUIDUS, latent_heat=4e5, liquid=liquid,
        solidification_shrinkage=0.05, yield_stress=yields, kinematic_hardening=2e9, **given,
    )  # fmt: skip
    return Law(material, SOLIDUS, name, inside=True)


def state(law: Law, body, far: float) -> tuple[np.ndarray, np.ndarray]:
    """Return temperatures [°C] and solid fractions of the nodes, the far end at a temperature."""
    temperature = far - FALL * (0.02 - body.points[:, 0])
    return temperature, law.material.solid_fraction_at(temperature)


def step(law: Law, points, body, first: float, last: float) -> Conditions:
    return law.conditions(points, *state(law, body, last), 0.5, law.nodes(*state(law, body, first)))


def histories(law: Law, points, body, size: float, times=TIMES) -> list[PointHistory]:
    """Return the history after each step of a path of strains that grow to a size."""
    found = [PointHistory.initial(points, mush=law.has_layers)]
    way = strains(points, size)
    for number, (first, last) in enumerate(pairwise(times), 1):
        conditions = step(law, points, body, first, last)
        found.append(after(points, conditions, found[-1], number * way))
    return found


@pytest.mark.serial
def test_they_are_one_metal_while_neither_flows(points, body):
    for strong, soft in zip(
        histories(law(PLASTIC, 1e15), points, body, 1e-3),
        histories(law(ELASTIC), points, body, 1e-3),
        strict=True,
    ):
        np.testing.assert_allclose(strong.elastic, soft.elastic, rtol=1e-9, atol=1e-15)


@pytest.mark.serial
def test_so_they_are_as_the_metal_melts_again(points, body):
    times = (586.0, 576.0, 566.0, 573.0, 582.0, 570.0)
    strong = histories(law(PLASTIC, 1e15), points, body, 1e-3, times)[-1]
    assert strong.mush is not None
    assert np.abs(strong.mush.elastic - strong.elastic).max() > 1e-5
    melted = step(law(PLASTIC, 1e15), points, body, 566.0, 573.0).mush
    assert melted is not None
    assert np.any(melted.layers.solid_before > melted.layers.solid + 1e-3)
    soft = histories(law(ELASTIC), points, body, 1e-3, times)[-1]
    off = np.abs(strong.elastic - soft.elastic).max() / np.abs(soft.elastic).max()
    assert off < 0.1  # a point of one metal leaves as much as melts of all of it


@pytest.mark.serial
def test_solid_that_melts_takes_along_what_it_bears(points, body):
    """Both pasts have the mean of the history, and mush its own with that of what has melted."""
    made = law(PLASTIC)
    history = histories(made, points, body, 2e-3, (*TIMES, 563.0))[-1]
    mush = step(made, points, body, 563.0, 565.0).mush
    assert mush is not None and history.mush is not None
    layers, at = mush.layers, mush.layers.points
    melted = layers.solid_before - layers.solid
    assert np.any(melted > 1e-3) and np.any(layers.mush_before > 1e-3)
    begun = made.nodes(*state(made, body, 563.0)).share
    assert np.any(layers.mush_before < 0.9 * points.from_nodes(begun)[at])
    solids, mushes = mush.pasts(history)
    for solid, mixed, mean, own in zip(solids, mushes, history.mean, history.of_mush, strict=True):
        whole = layers.solid_before + layers.mush_before
        borne = (layers.solid_before * solid.T + layers.mush_before * own[at].T).T
        np.testing.assert_allclose((borne.T / whole).T, mean[at], rtol=1e-12, atol=1e-18)
        joined = (melted * solid.T + layers.mush_before * own[at].T).T
        expected = (joined.T / (melted + layers.mush_before)).T
        np.testing.assert_allclose(mixed, expected, rtol=1e-12, atol=1e-18)
    assert np.abs(solids.elastic - mushes.elastic).max() > 1e-5


@pytest.mark.serial
def test_mush_is_hotter_than_the_solid_beside_it(points, body):
    """And what both contract beyond the cell adds up to nothing."""
    mush = step(law(PLASTIC), points, body, *TIMES[-2:]).mush
    assert mush is not None
    layers = mush.layers
    assert np.all(layers.mush_temperature > layers.solid_temperature + 1.0)
    strained = layers.shares.strained * layers.shares.end
    joint = layers.solid * layers.solid_excess + strained * layers.mush_excess
    assert np.abs(joint).max() < 1e-12 < 1e-5 < np.abs(layers.mush_excess).min()


@pytest.mark.serial
@pytest.mark.parametrize("name", [PLASTIC, VISCOPLASTIC])
def test_mush_that_flows_leaves_the_solid_beside_it(points, body, name):
    """It shrinks by far more than it can bear, the solid by what it pulls."""
    viscous = {"viscosity": 1e4, "exponent": 1.0} if name == VISCOPLASTIC else {}
    made = law(name, WEAK, **viscous)
    assert made.has_layers
    conditions = step(made, points, body, *TIMES[-2:])
    assert conditions.mush is not None
    layers = conditions.mush.layers
    assert np.all(layers.mush_excess < 0.0) and np.all(layers.solid_excess > 0.0)
    start = PointHistory.initial(points, mush=True)
    found = respond(conditions, start, conditions.shape)
    assert found.mush is not None
    at, own = layers.points, layers.shares.end
    np.testing.assert_allclose(layers.solid + own, conditions.shares.end[at], rtol=1e-12)
    mean = found.equivalent[at] * conditions.shares.end[at]
    of_solid = (mean - own * found.mush.equivalent[at]) / layers.solid
    assert np.all(found.mush.equivalent[at] > np.maximum(5e-5, 5 * of_solid))
    bears = np.sqrt(1.5) * 2 * G * tensor_norm(found.mush.elastic[at])
    assert np.all(bears > 0.99 * WEAK) and np.all(bears < 1.3 * WEAK)


@pytest.mark.serial
def test_layers_behind_each_other_bear_no_stress_across(points, body):
    """Of a layer with lateral strain δ and σ_nn = 0 the deviator is E/(1 − ν) δ/3 = 2 G λ δ."""
    for ratio in (0.0, 0.2, 0.45):
        young = 2 * G * (1 + ratio)
        assert across_one_layer(np.array([ratio])) == pytest.approx(
            young / (1 - ratio) / 3 / (2 * G)
        )
        made = law(PLASTIC, poisson=ratio)
        conditions = step(made, points, body, *TIMES[-2:])
        assert conditions.mush is not None
        layers, at = conditions.mush.layers, conditions.mush.layers.points
        front = front_normals(points, state(made, body, TIMES[-1])[0])[at]
        lateral = np.stack([-front[:, 1], front[:, 0]], axis=1)
        for shape, excess in (
            (conditions.mush.shape, layers.mush_excess),
            (conditions.mush.solid_shape, layers.solid_excess),
        ):
            own = shape - conditions.shape[at]
            along = np.einsum("pi,pij,pj->p", lateral, plane(own), lateral)
            expected = across_one_layer(np.array([ratio])) * excess / 3
            np.testing.assert_allclose(along, expected, rtol=1e-12, atol=1e-15)


def plane(tensors: np.ndarray) -> np.ndarray:
    """Return the parts in the plane of tensors by components, shape (points, 2, 2)."""
    xx, yy, _, xy = tensors.T
    return np.stack([np.stack([xx, xy], axis=1), np.stack([xy, yy], axis=1)], axis=2)


@pytest.mark.serial
@pytest.mark.parametrize("liquid", [NEWTONIAN, NORTON])
@pytest.mark.parametrize("evaluated", [respond, foreseen])
def test_tangent_of_both(points, body, liquid, evaluated):
    """By differences, where both flow in directions of their own and liquid is beside them."""
    made = law(PLASTIC, liquid=liquid)
    before = histories(made, points, body, 2e-3)[-2]
    conditions = step(made, points, body, *TIMES[-2:])
    assert conditions.mush is not None
    strain = before.strain + (strains(points, 2e-3, 7) if evaluated is respond else 0.0)
    found = evaluated(conditions, before, strain)
    assert found.beside is not None
    at = conditions.mush.layers.points
    assert found.beside.radial[at].any() and (found.radial[at].any() or evaluated is foreseen)
    if evaluated is foreseen:
        strain = strain + conditions.shape
    change = strains(points, 1e-8, 3)
    differences = _stress(conditions, before, strain, change) - _stress(
        conditions, before, strain, -change
    )
    expected = found.linear(2 * change)
    newtonian = np.ones(points.count, dtype=bool)
    if liquid is NORTON:  # a mixture keeps one of the directions of solid and liquid
        newtonian = conditions.shares.end == 1.0
    scale = np.abs(differences).max()
    np.testing.assert_allclose(expected[newtonian], differences[newtonian], atol=1e-5 * scale)


def _stress(conditions, before, strain, change) -> np.ndarray:
    found: Response = respond(conditions, before, strain + change)
    return found.stress


@pytest.mark.serial
def test_metal_without_mush_is_one(points, body):
    assert not law(ELASTIC).has_layers
    assert step(law(ELASTIC), points, body, *TIMES[-2:]).mush is None
    pure = elastic(
        60e9, 0.3, 2e-5, solidus=SOLIDUS, liquidus=SOLIDUS, latent_heat=4e5, liquid=NEWTONIAN,
        yield_stress=YIELD,
    )  # fmt: skip
    assert not Law(pure, SOLIDUS, PLASTIC).has_layers
    assert not Law(elastic(60e9, 0.3, 2e-5, yield_stress=YIELD), 20.0, PLASTIC).has_layers


@pytest.mark.serial
def test_its_past_is_saved_with_that_of_all(points, body):
    made = law(PLASTIC)
    history = histories(made, points, body, 2e-3)[-1]
    arrays = {name: part.values for name, part in history.saved(points).items()}
    found = PointHistory.initial(points, mush=True).restored(arrays)
    for name, values in found.arrays().items():
        np.testing.assert_array_equal(values, history.arrays()[name], err_msg=name)
    assert {"mush_elastic", "mush_plastic", "mush_equivalent"} < set(arrays)
    assert found.mush is not None and np.any(found.mush.plastic != found.plastic)
