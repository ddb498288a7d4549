"""Stress and distortion at the last end of each body."""

import numpy as np
import pytest

from castx.report.summary.solid import distortion, residual_stress
from tests.castx.report.summary.fake_run import run

pytestmark = pytest.mark.serial


def extreme(value, *place):
    return {"value": value, "place": list(place)}


def end(stage, time, pull, *names):
    stress = {
        "largest_principal": extreme(pull, 0.01, 0.02), "smallest_principal": extreme(-1e6, 0, 0),
        "von_mises": extreme(9e7, 0.0, 0.03), "mean_von_mises": 2.5e7,
    }  # fmt: skip
    shape = {
        "outward": extreme(1e-5, 0.02, 0.0), "inward": extreme(-6.846e-4, 0.03, 0.06),
        "allowance": [0.0137, 0.0121],
    }  # fmt: skip
    bodies = {name: {"stress": stress, "distortion": shape} for name in names or ("casting",)}
    return {"stage": stage, "cycle": 1, "time": time, "bodies": bodies}


def with_ends(*ends):
    found = run(model="axisymmetric")
    found.record["stage_ends"] = list(ends)
    return found


def test_the_last_end_of_each_body_counts():
    found = with_ends(end(0, 10.0, 5e7), end(1, 90.0, 1.234e8))
    (stress,), (shape,) = residual_stress(found), distortion(found)
    assert stress.number == "123.4 MPa" and stress.where("axisymmetric").endswith("t = 90 s")
    assert stress.name == "Residual stress: casting"
    assert stress.sentence.endswith("The body is cold and free: this is residual stress.")
    assert "von Mises at most 90 MPa at r 0.0, z 30.0 mm, 25 MPa in the mean" in stress.sentence
    assert shape.number == "0.6846 mm" and shape.place == [0.03, 0.06]
    assert "from -0.685 to 0.01 mm; allowance r 1.37 %, z 1.21 %" in shape.sentence


def test_an_allowance_that_no_faces_tell_is_unknown():
    found = end(0, 10.0, 5e7)
    found["bodies"]["casting"]["distortion"]["allowance"] = [0.0137, None]
    (shape,) = distortion(with_ends(found))
    assert "allowance r 1.37 %, z unknown, as no faces across it lie apart." in shape.sentence


def test_distortion_has_a_size_whichever_way_it_goes():
    """So that the least of several runs is that with the smallest deviation."""
    numbers = []
    for outward, inward in ((3e-4, -1e-4), (1e-4, -3e-4)):
        found = end(0, 10.0, 5e7)
        shape = found["bodies"]["casting"]["distortion"]
        shape["outward"], shape["inward"] = extreme(outward, 0, 0), extreme(inward, 0.01, 0)
        (one,) = distortion(with_ends(found))
        numbers.append((one.value, one.place))
    assert numbers == [(3e-4, [0, 0]), (3e-4, [0.01, 0])]


def test_castings_come_first_and_a_body_that_is_gone_keeps_its_last_end():
    found = with_ends(end(0, 10.0, 5e7, "mould", "casting"), end(1, 20.0, 6e7, "casting"))
    first, second = residual_stress(found)
    assert (first.of, first.time, second.of, second.time) == ("casting", 20.0, "mould", 10.0)
    assert second.topic == "Stress at the end" and "residual" not in second.sentence


def test_a_body_that_was_removed_says_of_when_its_state_is():
    """A core or a half that is drawn before the end of the run; what stays says nothing."""
    found = with_ends(end(0, 20.0, 5e7, "casting", "mould"))
    found.record["process"] = [{"time": 20.0, "bodies": ["casting"], "removed": {"mould": 1e-6}}]
    for findings in (residual_stress(found), distortion(found)):
        casting, mould = findings
        assert mould.sentence.endswith("mould was removed: this is its state at 20 s.")
        assert "removed" not in casting.sentence


def test_a_body_without_distortion_has_its_stress():
    closed = end(0, 10.0, 5e7)
    del closed["bodies"]["casting"]["distortion"]
    assert not list(distortion(with_ends(closed))) and list(residual_stress(with_ends(closed)))


DOUBTS = [
    ({"law": "thermo-elastic"}, {}, "elastic"),
    ({}, {"hottest": 585.0}, "still up to 585 °C hot"),
    ({}, {"hindered": True}, "Supports hold casting"),
    ({}, {"model": "plane-strain"}, "holds it across the plane"),
    ({}, {"held": [0.0, 1.0, 0.5, 0.25]}, "mould still holds it, at 25 %"),
    ({}, {"held": [0.0, 1.0, 1.0, 1.0]}, "mould still holds it, at 100 %"),
]


@pytest.mark.parametrize("body, state, told", DOUBTS)
def test_stress_that_cannot_be_residual_is_not_called_so(body, state, told):
    cold = {
        "hottest": 60.0,
        "hindered": False,
        "model": "axisymmetric",
        "held": [0.0, 1.0, 0.5, 0.0],
    }
    for found_state, doubtful in ((cold, False), (cold | state, True)):
        found = with_ends(end(0, 3.0, 5e7))
        found.record["bodies"]["casting"] = body if doubtful else {"law": "thermo-elasto-plastic"}
        last = found.record["stage_ends"][0]["bodies"]["casting"]
        last |= {key: found_state[key] for key in ("hottest", "hindered")}
        found.model = found_state["model"]
        found.history["casting/mould.closed_fraction"] = np.array(found_state["held"])
        (stress,) = residual_stress(found)
        assert (told in stress.sentence) is doubtful
        assert stress.topic == ("Stress at the end" if doubtful else "Residual stress")


def test_the_strength_of_the_material_and_what_most_of_the_body_bears_stand_beside_the_largest():
    found = with_ends(end(0, 3.0, 2.41e8))
    found.record["bodies"]["casting"] = {"material": "AlSi7Mg", "tensile_strength": 2.4e8}
    stress = found.record["stage_ends"][0]["bodies"]["casting"]["stress"]
    stress |= {"high_principal": 1.1e8, "high_von_mises": 1.2e8}
    (told,) = residual_stress(found)
    assert "No AlSi7Mg bears more than 240 MPa." in told.sentence
    assert "stress (99 % of the volume below 110 MPa); von Mises at most 90" in told.sentence
    assert told.sentence.count("in the mean (99 % of the volume below 120 MPa).") == 1
    stress["largest_principal"]["value"] = 2.39e8
    (told,) = residual_stress(found)
    assert "bears more" not in told.sentence
