"""Values given on the command line."""

import pytest

from castx.errors import CaseError
from castx.input.overrides import apply_overrides, value_at

pytestmark = pytest.mark.serial

DATA = {"time": {"end": 90}, "bodies": [{"name": "casting", "at": [1, 2]}, {"name": "mould"}]}


@pytest.mark.parametrize(
    "override, path, value",
    [
        ("time.end=10", ("time", "end"), 10),
        ("time.end = 1e1", ("time", "end"), 10.0),
        ("time.end=5 min", ("time", "end"), "5 min"),
        ('time.end="5 min"', ("time", "end"), "5 min"),
        ("bodies.0.temperature=680", ("bodies", 0, "temperature"), 680),
        ("bodies[1].name=die", ("bodies", 1, "name"), "die"),
        ("bodies.0.at.1=3", ("bodies", 0, "at", 1), 3),
        ("bodies.0.at=[[0, 1], [2, 3]]", ("bodies", 0, "at"), [[0, 1], [2, 3]]),
        ("solver.heat={ksp_rtol=1e-9}", ("solver", "heat"), {"ksp_rtol": 1e-9}),
        ("solver.linear=direct", ("solver", "linear"), "direct"),
        ("output.folder=results/a=b", ("output", "folder"), "results/a=b"),
        ("support.mode=true", ("support", "mode"), True),
        ("name=1\nend=2", ("name",), "1\nend=2"),
        ("name=" + "9" * 5000, ("name",), "9" * 5000),
        ("name=" + "[" * 5000, ("name",), "[" * 5000),
    ],
)
def test_override(override, path, value):
    found = apply_overrides(DATA, [override])
    for key in path:
        found = found[key]
    assert found == value and type(found) is type(value)


def test_the_last_one_counts_and_the_original_stays():
    assert apply_overrides(DATA, ["time.end=1", "time.end=2"])["time"] == {"end": 2}
    assert DATA["time"] == {"end": 90}


@pytest.mark.parametrize(
    "override, text",
    [
        ("time.end", "--set time.end: KEY.PATH=VALUE is needed, such as time.end=10"),
        ("=3", "KEY.PATH=VALUE is needed"),
        ("time..end=3", "KEY.PATH=VALUE is needed"),
        ("bodies.2.name=x", "bodies is a list and has no '2'; indices: 0, 1"),
        ("bodies.-1.name=x", "bodies is a list and has no '-1'"),
        ("bodies.casting.name=x", "bodies is a list and has no 'casting'; indices: 0, 1"),
        ("time.end.x=3", "time.end is a single value and has no 'x'"),
    ],
)
def test_refused_override(override, text):
    with pytest.raises(CaseError) as caught:
        apply_overrides(DATA, [override])
    assert text in str(caught.value)


def test_keys_have_levels_like_those_of_a_file():
    with pytest.raises(CaseError, match=r"--set a\.a\.a.{195} \.\.\.: lists or tables are nested"):
        apply_overrides({}, [".".join("a" * 50_000) + "=1"])


@pytest.mark.parametrize(
    ("path", "value"),
    [("a.0.b", 3), ("a[0].b", 3), ("a.1", None), ("a.0.b.c", None), ("d", None), ("a.x", None)],
)
def test_the_value_at_a_path(path, value):
    assert value_at({"a": [{"b": 3}]}, path) == value
