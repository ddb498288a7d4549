"""Stress and distortion in words."""

from castx.report.solid import solid_rows


def extreme(value, *place):
    return {"value": value, "place": list(place)}


def end(stage, time, pull):
    stress = {
        "largest_principal": extreme(pull, 0.01, 0.02), "smallest_principal": extreme(-1e6, 0, 0),
        "von_mises": extreme(9e7, 0.0, 0.03), "mean_von_mises": 2.5e7,
    }  # fmt: skip
    distortion = {
        "outward": extreme(1e-5, 0.02, 0.0), "inward": extreme(-6.846e-4, 0.03, 0.06),
        "allowance": [0.0137, 0.0121],
    }  # fmt: skip
    bodies = {"casting": {"stress": stress, "distortion": distortion}}
    return {"stage": stage, "cycle": 1, "time": time, "bodies": bodies}


def test_the_last_end_of_each_body_is_told():
    rows = dict(solid_rows([end(0, 10.0, 5e7), end(1, 90.0, 1.234e8)], "axisymmetric"))
    assert rows["stress casting"] == (
        "at 90 s largest principal 123 MPa at (10.0, 20.0) mm, von Mises 90 MPa at (0.0, 30.0) mm "
        "and 25 MPa in the mean"
    )
    assert rows["distortion casting"] == (
        "at 90 s from -0.685 mm at (30.0, 60.0) mm to 0.01 mm at (20.0, 0.0) mm, positive outward; "
        "allowance r 1.37 %, z 1.21 %"
    )


def test_a_body_without_distortion_has_its_stress():
    closed = end(0, 10.0, 5e7)
    del closed["bodies"]["casting"]["distortion"]
    assert list(dict(solid_rows([closed], "axisymmetric"))) == ["stress casting"]


def test_a_body_that_is_gone_keeps_its_last_end():
    later = {**end(1, 90.0, 1e8), "bodies": {}}
    rows = dict(solid_rows([end(0, 10.0, 5e7), later], "axisymmetric"))
    assert rows["stress casting"].startswith("at 10 s")
    assert not dict(solid_rows([], "3d"))
