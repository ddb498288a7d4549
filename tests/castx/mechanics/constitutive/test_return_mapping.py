"""Return mapping against tensor equations, rate equations, finite differences and closed forms."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays
from scipy.spatial.transform import Rotation

from castx.errors import ConvergenceError
from castx.materials.flow import (
    PLASTIC,
    VISCOPLASTIC,
    FlowProperties,
    isotropic_hardening,
    solid_flow,
)
from castx.materials.hardening.voce import VoceCurve
from castx.materials.inelastic import HARDENING_RULES
from castx.materials.material import Material
from castx.materials.rules.hardening_rule import HardeningRule
from castx.materials.rules.power_law import PowerLaw
from castx.mechanics.constitutive import return_mapping as module
from castx.mechanics.constitutive.return_mapping import (
    Returned,
    plastic_work,
    return_mapping,
    viscoplastic_strain,
)
from tests.castx.flow_reference import (
    LAWS,
    PLASTIC_FLOW,
    Numbers,
    Tensor,
    components,
    implicit_step,
    integrate,
    norm,
    reference,
    tensor,
)
from tests.castx.materials.descriptions import alloy

pytestmark = pytest.mark.serial

G = 26e9
SCALE = 100e6
TENSION = np.diag([1.0, -0.5, -0.5])
SHEAR = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
OTHER_SHEAR = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])


def flow(material: Material, numbers: Numbers, step: float, points: int = 1) -> FlowProperties:
    """Return what castx makes of a material at the temperature and modulus of the numbers."""
    law = PLASTIC if numbers.law == "plastic" else VISCOPLASTIC
    temperature = np.full(points, numbers.temperature)
    return solid_flow(material, law, np.full(points, numbers.shear_modulus), temperature, step)


def uniform(points: int = 1, /, **values: float) -> FlowProperties:
    """Return the properties of points that are alike, 0 but for those given; V = resistance Δγ."""
    given_values = {"shear_modulus": G, "power": 1.0} | values
    return properties_of({name: np.full(points, value) for name, value in given_values.items()})


def properties_of(values: Mapping[str, np.ndarray]) -> FlowProperties:
    """Return the properties of points: 0 but for those given, a power law and Voce's hardening."""

    def value(name: str) -> np.ndarray:
        return values.get(name, np.zeros_like(values["shear_modulus"]))

    return FlowProperties(
        value("shear_modulus"),
        value("yield_stress"),
        value("linear_hardening"),
        (VoceCurve(value("saturation"), value("saturation_rate")),),
        value("kinematic_hardening"),
        PowerLaw(value("resistance"), value("power")),
    )


def deviatoric(values: np.ndarray) -> np.ndarray:
    result = np.array(values, dtype=np.float64)
    result[:, :3] -= result[:, :3].mean(axis=1)[:, None]
    return result


@st.composite
def materials(draw: st.DrawFn, law: str, rate: float = 1e-3) -> Numbers:
    """Return a material that flows at a rate [1/s] under a moderate overstress."""
    stress = SCALE * draw(st.floats(0.05, 2.0))
    either = st.sampled_from([0.0, 1.0])
    return Numbers(
        law,
        G,
        yield_stress=SCALE * draw(st.floats(0.1, 1.0)),
        linear=draw(either) * draw(st.floats(1e7, 1e10)),
        saturation=draw(either) * SCALE * draw(st.floats(0.1, 2.0)),
        saturation_rate=draw(st.floats(1.0, 300.0)),
        kinematic=draw(either) * draw(st.floats(1e7, 1e10)),
        values={} if law == PLASTIC_FLOW else reference(law).drawn(draw, stress, rate, 300.0),
    )


def tensors(count: int, number: int = 6) -> st.SearchStrategy[np.ndarray]:
    """Return deviatoric tensors of the size 1."""
    shape = (count, number)
    return arrays.arrays(np.float64, shape, elements=st.floats(-1.0, 1.0)).map(deviatoric)


@pytest.mark.parametrize("law", LAWS)
@settings(max_examples=40)
@given(data=st.data())
def test_one_step_fulfils_the_tensor_equations(law: str, data: st.DataObject) -> None:
    numbers = data.draw(materials(law))
    trial, back = data.draw(tensors(2)) * np.array([[4.0], [0.3]]) * SCALE
    equivalent, step = data.draw(st.floats(0.0, 0.05)), data.draw(st.floats(0.01, 100.0))
    if not numbers.yields:
        back[:] = 0.0
    q = np.sqrt(1.5) * norm(tensor(trial - back))
    assume(numbers.overstress(q, equivalent) > 1e-3 * SCALE)
    properties = flow(alloy(**numbers.keys), numbers, step)
    result = return_mapping(trial[None], back[None], np.array([equivalent]), properties)
    found = tensor(result.stress[0]), float(result.increment[0])
    guess = (found[0] + 1e-3 * tensor(trial), 1.001 * found[1])
    stress, increment = implicit_step(numbers, tensor(trial), tensor(back), equivalent, step, guess)
    assert norm(found[0] - stress) < 1e-10 * norm(tensor(trial - back))
    assert found[1] == pytest.approx(increment, rel=1e-10)


def walk(
    material: Material,
    at: Callable[[float], Numbers],
    strain: Callable[[float], Tensor],
    steps: int,
) -> np.ndarray:
    """Return stress over SCALE (6 components) and ξ after implicit steps from 0 to 1 s."""
    flowed: np.ndarray = np.zeros((1, 6))
    equivalent: np.ndarray = np.zeros(1)
    for time in np.arange(1, steps + 1) / steps:
        properties = flow(material, at(time), 1.0 / steps)
        trial = 2 * at(time).shear_modulus * (components(strain(time)) - flowed)
        back = 2 / 3 * properties.kinematic_modulus[:, None] * flowed
        result = return_mapping(trial, back, equivalent, properties)
        flowed = flowed + viscoplastic_strain(result)
        equivalent = equivalent + result.increment
    return np.append(result.stress[0] / SCALE, equivalent)


def check_first_order(
    material: Material, at: Callable[[float], Numbers], strain: Callable[[float], Tensor]
) -> None:
    """Check that the error of implicit steps falls like their length, to the rate equations.

    A step in which yielding begins adds an error of second order that depends on where in the
    step it does.
    """
    stress, equivalent = integrate(at, strain, 1.0)
    exact = np.append(components(stress) / SCALE, equivalent)
    coarse, fine = (walk(material, at, strain, steps) for steps in (100, 200))
    errors = [np.abs(result - exact).max() / np.abs(exact).max() for result in (coarse, fine)]
    extrapolated = np.abs(2.0 * fine - coarse - exact).max() / np.abs(exact).max()
    assert errors[1] < 0.03
    assert extrapolated < min(0.2 * errors[1], 3e-4) + 1e-8
    if errors[1] > 1e-5:
        assert 1.8 < errors[0] / errors[1] < 2.25


# Ever faster: the error of a flow that has become steady dies out by itself.
PATHS: dict[str, Callable[[float], Tensor]] = {
    "tension": lambda t: 0.01 * t * (1.0 + t) * TENSION,
    "shear": lambda t: 0.008 * t * (1.0 + t) * SHEAR,
    "non-proportional": lambda t: (
        0.02 * (t * TENSION + np.sin(2.0 * t) * t * SHEAR + 0.5 * t**2 * OTHER_SHEAR)
    ),
}


@pytest.mark.sampled
@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("law", LAWS)
@settings(max_examples=6)
@given(data=st.data())
def test_steps_tend_to_the_rate_equations(law: str, path: str, data: st.DataObject) -> None:
    numbers = data.draw(materials(law, rate=0.01))
    check_first_order(alloy(**numbers.keys), lambda time: numbers, PATHS[path])


@pytest.mark.parametrize("law", LAWS)
@settings(max_examples=3)
@given(data=st.data())
def test_steps_follow_a_changing_temperature(law: str, data: st.DataObject) -> None:
    cold = replace(data.draw(materials(law, rate=0.01)), temperature=200.0)
    scale = {"shear_modulus": 0.8, "yield_stress": 0.5, "linear": 0.5, "saturation": 0.7,
             "saturation_rate": 1.5, "kinematic": 0.6}  # fmt: skip
    # An exponent acts on powers of the stress: it and the activation energy change little.
    changed = {"exponent": 0.95, "activation_energy": 1.02, "coefficient": 1.5}
    hot = replace(
        cold,
        temperature=250.0,
        values={key: value * changed.get(key, 0.9) for key, value in cold.values.items()},
        **{key: getattr(cold, key) * scale[key] for key in scale},
    )

    def at(time: float) -> Numbers:
        share = 0.9 - 0.8 * time
        mixed = {
            field.name: getattr(cold, field.name)
            + share * (getattr(hot, field.name) - getattr(cold, field.name))
            for field in fields(Numbers)
            if field.name not in ("law", "values")
        }
        values = {key: v + share * (hot.values[key] - v) for key, v in cold.values.items()}
        return Numbers(law, values=values, **mixed)

    check_first_order(alloy(**tabulated(cold.keys, hot.keys)), at, PATHS["non-proportional"])


def tabulated(cold: dict[str, Any], hot: dict[str, Any]) -> dict[str, Any]:
    """Return the keys of a material known at 200 and 250 °C."""
    result: dict[str, Any] = {}
    for key, value in cold.items():
        if isinstance(value, dict):
            result[key] = tabulated(value, hot[key])
        elif isinstance(value, str):
            result[key] = value
        else:
            result[key] = [[200.0, value], [250.0, hot[key]]]
    return result


def test_proportional_plastic_paths_are_exact_in_one_step() -> None:
    numbers = Numbers("plastic", G, yield_stress=SCALE, linear=2e9, kinematic=3e9)
    strain = 0.02
    result = walk(alloy(**numbers.keys), lambda time: numbers, PATHS["tension"], 1)
    equivalent = (3 * G * strain - SCALE) / (3 * G + 5e9)
    assert result[6] == pytest.approx(equivalent, rel=1e-12)
    assert result[0] * SCALE == pytest.approx(2 / 3 * (SCALE + 5e9 * equivalent), rel=1e-12)


def test_norton_relaxation_in_closed_form() -> None:
    """σ^(1−n) = σ0^(1−n) + (n − 1) 3G A t at constant strain; extrapolated from 400, 800 steps."""
    n, coefficient, start = 5.0, 1e-40, 10e6
    numbers = Numbers("norton", 20e9, values={"coefficient": coefficient, "exponent": n})
    material = alloy(**numbers.keys)
    strain = start / (3 * 20e9) * TENSION

    def relaxed(steps: int) -> float:
        flowed: np.ndarray = np.zeros((1, 6))
        properties = flow(material, numbers, 100.0 / steps)
        for _ in range(steps):
            trial = 2 * 20e9 * (components(strain) - flowed)
            result = return_mapping(trial, np.zeros((1, 6)), np.zeros(1), properties)
            flowed = flowed + viscoplastic_strain(result)
        return float(1.5 * result.stress[0, 0])

    exact = (start ** (1 - n) + (n - 1) * 60e9 * coefficient * 100.0) ** (1 / (1 - n))
    coarse, fine = relaxed(400), relaxed(800)
    assert coarse == pytest.approx(exact, rel=2e-3)
    assert 2 * fine - coarse == pytest.approx(exact, rel=2e-5)


@pytest.mark.parametrize("number", [4, 6])
@pytest.mark.parametrize("law", LAWS)
@settings(max_examples=25)
@given(data=st.data())
def test_tangent_agrees_with_differences(law: str, number: int, data: st.DataObject) -> None:
    numbers = data.draw(materials(law))
    trial, back, change = data.draw(tensors(3, number))[:, None] * SCALE
    trial, back = 4 * trial, (0.2 if numbers.yields else 0.0) * back
    equivalent = np.array([data.draw(st.floats(0.0, 0.05))])
    properties = flow(alloy(**numbers.keys), numbers, data.draw(st.floats(0.01, 100.0)))
    result = return_mapping(trial, back, equivalent, properties)
    overstress = 3 * G * result.increment[0] + norm(tensor(trial[0])) * (result.increment[0] == 0)
    assume(overstress > 0.02 * SCALE and norm(tensor(change[0])) > 0.01 * SCALE)
    h = 1e-4 * overstress / SCALE

    def stress(share: float) -> np.ndarray:
        moved = return_mapping(trial + share * h * change, back, equivalent, properties)
        assume((moved.increment[0] > 0) == (result.increment[0] > 0))
        return moved.stress

    # 2G δe = h change
    difference = (8 * (stress(1) - stress(-1)) - (stress(2) - stress(-2))) / (12 * h) * 2 * G
    along = np.tensordot(tensor(result.direction[0]), tensor(change[0]))
    tangent = result.isotropic * change[0] + result.radial * along * result.direction[0]
    assert np.abs(tangent - difference).max() < 1e-6 * 2 * G * np.abs(change).max()


@pytest.mark.parametrize("law", LAWS)
@settings(max_examples=20)
@given(data=st.data())
def test_a_rotated_step_gives_the_rotated_answer(law: str, data: st.DataObject) -> None:
    numbers = data.draw(materials(law))
    trial, back = data.draw(tensors(2))[:, None] * SCALE * [[[4.0]], [[0.3]]]
    properties = flow(alloy(**numbers.keys), numbers, 1.0)
    rotation = Rotation.from_rotvec(
        data.draw(arrays.arrays(np.float64, 3, elements=st.floats(-3, 3)))
    )
    turn = rotation.as_matrix()

    def turned(tensors: np.ndarray) -> np.ndarray:
        return np.array([components(turn @ tensor(row) @ turn.T) for row in tensors])

    equivalent = np.array([0.01])
    result = return_mapping(trial, back, equivalent, properties)
    other = return_mapping(turned(trial), turned(back), equivalent, properties)
    assert np.abs(other.stress - turned(result.stress)).max() < 1e-12 * 5 * SCALE
    np.testing.assert_allclose(other.increment, result.increment, rtol=1e-10, atol=1e-16)
    np.testing.assert_allclose(other.isotropic, result.isotropic, rtol=1e-10)


@settings(max_examples=20)
@given(data=st.data())
def test_plane_models_hold_four_of_six_components(data: st.DataObject) -> None:
    plane = data.draw(tensors(2, 4))[:, None] * 4 * SCALE
    space = np.concatenate((plane, np.zeros((2, 1, 2))), axis=2)
    properties = uniform(yield_stress=SCALE, resistance=SCALE, power=0.3)
    small = return_mapping(plane[0], plane[1], np.zeros(1), properties)
    large = return_mapping(space[0], space[1], np.zeros(1), properties)
    np.testing.assert_allclose(small.stress, large.stress[:, :4], rtol=1e-13)
    np.testing.assert_allclose(small.radial, large.radial, rtol=1e-12)


POINT = st.fixed_dictionaries(
    {
        "shear_modulus": st.floats(3.0, 11.5).map(lambda power: 10.0**power),
        "yield_stress": st.sampled_from([0.0, SCALE]),
        "linear_hardening": st.sampled_from([0.0, 1e6, 1e11]),
        "saturation": st.just(0.0) | st.floats(0.0, 10.0).map(lambda power: 10.0**power),
        "saturation_rate": st.floats(-3.0, 5.0).map(lambda power: 10.0**power),
        "kinematic_hardening": st.sampled_from([0.0, 1e9]),
        "resistance": st.just(0.0) | st.floats(-20.0, 40.0).map(lambda power: 10.0**power),
        "power": st.sampled_from([1.0]) | st.floats(0.2, 200.0).map(lambda n: 1.0 / n),
    }
)


@settings(max_examples=300)
@given(
    point=POINT,
    share=st.floats(-14.0, 3.0).map(lambda power: 10.0**power),
    equivalent=st.just(0.0) | st.floats(1e-8, 1.0),
)
def test_the_scalar_equation_is_solved_to_round_off(
    point: dict[str, float], share: float, equivalent: float
) -> None:
    """Steps of 1e-6 to 1e4 s, n = 0.2 to 200, overstress from 1e-6 Pa: none may be too hard."""
    properties = uniform(**point)
    hardening = point["linear_hardening"] * equivalent - point["saturation"] * np.expm1(
        -point["saturation_rate"] * equivalent
    )
    q = point["yield_stress"] + hardening + SCALE * share
    f = q - point["yield_stress"] - hardening
    assume(f > 1e-12 * q)
    trial = components(q * 2 / 3 * TENSION)[None]
    result = return_mapping(trial, np.zeros((1, 6)), np.array([equivalent]), properties)
    increment = float(result.increment[0])
    modulus = 3 * point["shear_modulus"]
    assert 0.0 <= increment <= 1.001 * f / modulus
    assert np.isfinite(result.stress).all()
    assert -1e-12 * modulus <= result.isotropic[0] <= modulus
    assert abs(result.radial[0]) <= modulus
    linear = modulus + point["linear_hardening"] + point["kinematic_hardening"]
    fading = np.exp(-point["saturation_rate"] * equivalent)
    voce = -point["saturation"] * fading * np.expm1(-point["saturation_rate"] * increment)
    viscous = 0.0
    if point["resistance"] > 0.0:
        if increment < 1e-290:  # too little for a number: all of f is borne by the viscosity
            logarithm = np.log(f / point["resistance"]) / point["power"]
            assert logarithm < np.log(1e-289)
            return
        viscous = point["resistance"] * increment ** point["power"]
    # The trial overstress itself is a difference of large numbers.
    assert linear * increment + voce + viscous == pytest.approx(f, rel=1e-12, abs=1e-15 * q * 4)


def test_points_do_not_disturb_each_other() -> None:
    """Elastic, linear and curved points in one call, each as alone."""
    generator = np.random.default_rng(3)
    count = 60
    trial, back = deviatoric(generator.normal(size=(2 * count, 6))).reshape(2, count, 6) * SCALE
    equivalent = generator.uniform(0, 0.02, count)
    kinds = generator.integers(0, 4, count)
    values = {
        "shear_modulus": np.full(count, G),
        "yield_stress": np.full(count, 4.5 * SCALE),
        "linear_hardening": np.full(count, 1e9),
        "saturation": np.where(kinds == 1, SCALE, 0.0),
        "saturation_rate": np.full(count, 20.0),
        "resistance": np.where(kinds >= 2, 10.0 ** generator.uniform(6, 10, count), 0.0),
        "power": np.where(kinds == 2, 1.0, generator.uniform(0.05, 1.5, count)),
    }
    properties = properties_of(values)
    together = return_mapping(trial, back, equivalent, properties)
    assert 0.1 < np.mean(together.increment > 0) < 0.9
    for i in range(count):
        own = slice(i, i + 1)
        alone = properties_of({name: part[own] for name, part in values.items()})
        for part, whole in zip(
            return_mapping(trial[own], back[own], equivalent[own], alone), together, strict=True
        ):
            np.testing.assert_allclose(part[0], whole[i], rtol=1e-10, atol=1e-14)


def test_arguments_are_left_alone() -> None:
    trial, back = components(4 * SCALE * TENSION)[None], np.zeros((1, 6))
    numbers = {"shear_modulus": G, "yield_stress": SCALE, "resistance": SCALE, "power": 0.2}
    values = {name: np.array([value]) for name, value in numbers.items()}
    arguments = (trial, back, np.zeros(1), *values.values())
    before = [argument.copy() for argument in arguments]
    return_mapping(trial, back, np.zeros(1), properties_of(values))
    for argument, old in zip(arguments, before, strict=True):
        np.testing.assert_array_equal(argument, old)


@pytest.mark.parametrize("power", [1.0, 0.2, 2.0])
def test_viscous_laws_lie_between_plastic_and_elastic(power: float) -> None:
    trial, back, start = components(4 * SCALE * TENSION)[None], np.zeros((1, 6)), np.zeros(1)
    hardening = {"yield_stress": SCALE, "linear_hardening": 1e9}
    plastic = return_mapping(trial, back, start, uniform(**hardening))
    stresses = [
        return_mapping(
            trial, back, start,
            uniform(**hardening, resistance=resistance, power=power),
        ).stress[0, 0]
        for resistance in 10.0 ** np.arange(-2.0, 36.0)
    ]  # fmt: skip
    assert stresses[0] == pytest.approx(plastic.stress[0, 0], rel=1e-8)
    assert stresses[-1] == pytest.approx(trial[0, 0], rel=1e-8)
    assert (np.diff(stresses) >= -1e-12 * SCALE).all()
    assert stresses[10] - stresses[0] > 0.01 * SCALE or stresses[-1] - stresses[10] > 0.01 * SCALE


def test_elastic_points_keep_their_trial_stress() -> None:
    trial = components(0.6 * SCALE * TENSION)[None]
    result = return_mapping(trial, np.zeros((1, 6)), np.zeros(1), uniform(yield_stress=SCALE))
    np.testing.assert_array_equal(result.stress, trial)
    assert result.increment == result.radial == plastic_work(result) == 0.0
    assert result.isotropic == 2 * G
    still = return_mapping(0 * trial, 0 * trial, np.zeros(1), uniform())
    assert np.isfinite(np.concatenate([values.ravel() for values in still])).all()


@pytest.mark.parametrize("rule", HARDENING_RULES, ids=lambda rule: rule.name)
def test_every_hardening_rule_returns_to_the_yield_surface(rule: HardeningRule) -> None:
    """There q = σ_Y + R(ξ + Δγ); Δγ is what relieves q_tr, and dΔγ/dq_tr its slope."""
    yield_stress, strain = 3e7, np.array([0.0, 0.0, 0.01, 0.2, 0.2])
    numbers = Numbers(PLASTIC_FLOW, temperature=20.0)
    hardening = {"hardening": rule.example} if rule.isotropic else rule.example
    hard, soft = (
        flow(alloy(yield_stress=yield_stress, **keys), numbers, 1.0, 5) for keys in (hardening, {})
    )
    surface = yield_stress + isotropic_hardening(hard, strain)
    q_trial = surface * np.array([1.05, 30.0, 1.5, 1.02, 20.0])

    def returned(properties: FlowProperties, scale: float = 1.0) -> Returned:
        trial = scale * q_trial[:, None] / np.sqrt(3.0) * components(SHEAR)
        return return_mapping(trial, np.zeros((5, 6)), strain, properties)

    found = returned(hard)
    back = 2.0 / 3.0 * hard.kinematic_modulus[:, None] * viscoplastic_strain(found)
    q = np.sqrt(3.0) * (found.stress - back)[:, 3]
    expected = yield_stress + isotropic_hardening(hard, strain + found.increment)
    np.testing.assert_allclose(q, expected, rtol=1e-8)
    relieved = (3.0 * G + hard.kinematic_modulus) * found.increment
    np.testing.assert_allclose(relieved, q_trial - q, rtol=1e-6)
    assert (found.increment < returned(soft).increment).all(), "the material does not harden"
    low, high = (returned(hard, scale).increment for scale in (1.0 - 1e-5, 1.0 + 1e-5))
    slope = (1.0 - (found.isotropic + found.radial) / (2.0 * G)) / (3.0 * G)
    np.testing.assert_allclose(slope, (high - low) / (2e-5 * q_trial), rtol=1e-5)


def test_plastic_work_is_stress_times_flow() -> None:
    generator = np.random.default_rng(5)
    trial, back = deviatoric(generator.normal(size=(40, 6))).reshape(2, 20, 6) * SCALE
    properties = uniform(20, yield_stress=0.1 * SCALE, kinematic_hardening=1e9)
    result = return_mapping(trial, back, np.zeros(20), properties)
    strain = viscoplastic_strain(result)
    expected = [
        np.tensordot(tensor(result.stress[i]), tensor(strain[i])) for i in range(len(strain))
    ]
    np.testing.assert_allclose(plastic_work(result), expected, rtol=1e-12)
    lengths = [np.sqrt(2 / 3) * norm(tensor(flowed)) for flowed in strain]
    np.testing.assert_allclose(lengths, result.increment, rtol=1e-12, atol=1e-18)


def test_a_point_that_cannot_be_solved_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    trial = np.tile(components(2 * SCALE * TENSION), (5, 1))
    properties = uniform(5, yield_stress=SCALE, resistance=SCALE, power=0.2)
    broken = trial.copy()
    broken[3, 4] = np.nan
    with pytest.raises(ConvergenceError, match=r"1 of 5 points, first at point 3 with .* nan Pa"):
        return_mapping(broken, np.zeros((5, 6)), np.zeros(5), properties)
    resistance = np.array([0.0, 0.0, np.nan, 1e9, 1e9])
    unknown = properties._replace(overstress=PowerLaw(resistance, np.full(5, 0.2)))
    with pytest.raises(ConvergenceError, match=r"first at point 2 with .* of 2e\+08 Pa; the step"):
        return_mapping(trial, np.zeros((5, 6)), np.zeros(5), unknown)
    monkeypatch.setattr(module, "MOST_ITERATIONS", 1)
    with pytest.raises(ConvergenceError, match="5 of 5 points, first at point 0"):
        return_mapping(trial, np.zeros((5, 6)), np.zeros(5), properties)
