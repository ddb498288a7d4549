"""Reading of whole case files: defaults, overrides, and all problems in one message."""

import re
import tomllib
from copy import deepcopy
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from castx.case.case import Case
from castx.case.reading.read import load_case, read_case
from castx.errors import CaseError
from tests.castx.case_data import CYLINDER, REMOVED, cylinder

pytestmark = pytest.mark.serial


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "cylinder.toml"
    path.write_text(CYLINDER)
    return path


def refusal(path, *overrides):
    with pytest.raises(CaseError) as caught:
        load_case(path, overrides)
    return str(caught.value)


def test_the_whole_contract_of_what_is_available(file, monkeypatch):
    monkeypatch.chdir(file.parent)
    case = load_case(file)
    assert case.path == file and case.name == "aluminium cylinder in a steel mould"
    assert case.geometry.arguments["size"] == pytest.approx(0.0015)
    assert case.materials["aluminium"].conductivity.solid(340.0) == pytest.approx(223.5)
    assert case.materials["steel"].density == pytest.approx(7800.0)
    assert [body.temperature.uniform for body in case.bodies] == pytest.approx([670.0, 200.0])
    assert case.interfaces[0].name == "casting/mould"
    assert case.interfaces[0].heat.closed.table(0.0) == 2300.0
    assert case.boundaries[0].heat[0].type == "insulated"
    assert case.boundaries[1].displacement[0].direction == "normal"
    assert case.loads.gravity == (0.0, -9.81)
    assert (case.time.end, case.coupling.passes, case.solver.mechanics_tolerance) == (
        90.0,
        40,
        3e-4,
    )
    assert case.output.folder == file.parent / "results" / "cylinder"
    assert case.probes[1].at == pytest.approx((0.03, 0.05))


def test_defaults_that_depend_on_the_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    data = cylinder(name=REMOVED, output=REMOVED)
    case = read_case(data, Path("cases/bar.toml"))
    assert case.name == "bar" and case.output.folder == tmp_path / "results" / "bar"


def test_a_mesh_file_is_relative_to_the_case_file(tmp_path):
    path = tmp_path / "bar.toml"
    rest = CYLINDER[CYLINDER.index("[materials") :]
    path.write_text(f"[geometry]\nmodel = 'axisymmetric'\nfile = '../part.msh'\n{rest}")
    assert load_case(path).geometry.file == tmp_path / ".." / "part.msh"


def test_overrides(file):
    case = load_case(file, ["time.end=10", "bodies.0.temperature=953.15 K", "solver.linear=direct"])
    assert (case.time.end, case.bodies[0].temperature.uniform) == (10.0, pytest.approx(680.0))
    assert case.solver.linear == "direct"


def test_content_is_read_as_a_file_of_the_present_folder(file, monkeypatch):
    monkeypatch.chdir(file.parent)
    data = tomllib.loads(CYLINDER)
    before = deepcopy(data)
    case = load_case(data, ["time.end=10"])
    assert data == before and case.time.end == 10.0
    assert case.digest == load_case(str(file), ["time.end=10"]).digest
    assert case.output.folder.parent == file.parent / "results"
    with pytest.raises(CaseError, match=r"case\.toml --set time\.ende=1: .*unknown key"):
        load_case(data, ["time.ende=1"])


def test_the_hash_tells_content_not_layout(file, tmp_path):
    other = tmp_path / "other.toml"
    other.write_text("# a comment\n" + CYLINDER.replace(" = ", "   =  "))
    case = load_case(file)
    assert load_case(other).digest == case.digest and len(case.digest) == 64
    assert load_case(file, ["time.end=91"]).digest != case.digest
    other.write_text(CYLINDER.replace("2300", "2301"))
    assert load_case(other).digest != case.digest


def test_problems_of_all_parts_are_shown_together(file):
    overrides = ["time.end=90 m", "bodies.1.material=3", "heat={}", "solver.linear=dirct"]
    first, *rest = refusal(file, *overrides).splitlines()
    assert first.startswith(f"{file} --set time.end=90 m --set ") and first.endswith(": 4 problems")
    assert [line.split(":")[0] for line in rest] == [
        "  bodies[1].material = 3",
        '  time.end = "90 m"',
        '  solver.linear = "dirct"',
        "  heat",
    ]


@pytest.mark.parametrize(
    "override, text",
    [
        ("tiem.end=3", 'tiem: unknown key; known keys: name, geometry, materials, bodies.*"time"'),
        ("path=x", "path = .x.: unknown key"),
        ("digest=x", "digest = .x.: unknown key"),
        ("bodies={}", "bodies: a list is needed"),
        ("bodies=[]", r"bodies = \[\]: at least 1 needed"),
        ("time=3", "time = 3: a table of keys is needed"),
        ("name=3", "name = 3: a text in quotes of at most 200"),
        ('support.in_gate=["casting/lid"]', r"support.in_gate\[0\] = .*: no surface 'lid'"),
        ('support.in_gate=["cast/top"]', "support.in_gate.*unknown body 'cast'"),
        ("support.in_gate=casting/top", "support.in_gate = .*: a list of surfaces"),
        (
            'support.in_gate=["casting/top","casting/top"]',
            r"support.in_gate\[1\] = .*: is there already",
        ),
        ("output.checkpoint=0", "output.checkpoint = 0: must be positive"),
        ("bodies.0.law=rigid", "the secondary body 'casting' is rigid; name the bodies the other"),
        ("bodies.0.law=elastic", 'law = "elastic": unknown; allowed: thermo-elastic'),
        ("bodies.0.formulation=q2", 'formulation = "q2": unknown; allowed: mixed'),
        (
            "materials.steel.activation_energy=1e5",
            'materials.steel.activation_energy = .*: acts only with law = .*"norton"',
        ),
        ("materials.steel.exponent=0", "materials.steel.exponent = 0: must be positive"),
        (
            "materials.steel.conductivity=[[20,25],[90,-1]]",
            r"steel.conductivity\[1\] = \[90, -1\]: ",
        ),
        ("materials.aluminium.solidus=670", "materials.aluminium.solidus = 670.*liquidus"),
        ("materials.steel.poisson_ratio=0.5", "steel.poisson_ratio = 0.5: must be .*below 0.5"),
        ("bodies.0.temperature=-300", "bodies.0..temperature = -300: below absolute zero"),
        ("bodies.0.temperature=true", "bodies.0..temperature = true: a temperature is needed"),
        ("bodies.0.temperature=nan", "bodies.0..temperature = NaN: a temperature must be finite"),
        ("bodies.0.material=" + "x" * 200, "material = .*: at most 100 characters"),
        ("bodies.7.material=x", "bodies is a list and has no '7'; indices: 0, 1"),
    ],
)
def test_refused(file, override, text):
    assert re.search(text, refusal(file, override))


def test_unreadable_files(tmp_path):
    assert "cannot be read: No such file" in refusal(tmp_path / "none.toml")
    assert "cannot be read: Is a directory" in refusal(tmp_path)
    path = tmp_path / "bad.toml"
    for content, text in [
        (b"\xff\xfe", "not a text file in UTF-8"),
        (b"name = ", "not a TOML file"),
        (b"a = 1\na = 2", "not a TOML file"),
        (b"a = " + b"9" * 5000, "not a TOML file"),
        (b"a = " + b"[" * 5000, "nested more than 20 levels deep"),
        (b"a" + b".a" * 5000 + b" = 1", "nested more than 20 levels deep"),
        (b"#" * 4_000_001, "too large"),
        (b"", "geometry: missing"),
    ]:
        path.write_bytes(content)
        message = refusal(path)
        assert text in message and str(path) in message and len(message) < 2000


def leaves(data, path=()):
    """Yield the paths of all values, tables and lists included."""
    items = data.items() if isinstance(data, dict) else enumerate(data)
    for key, value in items:
        yield (*path, key)
        if isinstance(value, dict | list):
            yield from leaves(value, (*path, key))


JUNK = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-(10**20), 10**20),
    st.floats(),
    st.text(max_size=20),
    st.sampled_from(["5 min", "3 mm", "20 degC", "1e999 m", "uniform", "casting", "9 m^9"]),
    st.lists(st.lists(st.floats(), max_size=3), max_size=3),
    st.dictionaries(st.text(max_size=8), st.integers(), max_size=2),
)


@settings(max_examples=300, deadline=None, derandomize=True, database=None)
@given(st.sampled_from(list(leaves(tomllib.loads(CYLINDER)))), JUNK)
def test_any_value_is_accepted_or_refused_with_its_file(path, junk):
    data = deepcopy(tomllib.loads(CYLINDER))
    place = data
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = junk
    try:
        assert isinstance(read_case(data, Path("cylinder.toml")), Case)
    except CaseError as error:
        assert str(error).startswith("cylinder.toml: ") and len(str(error)) < 10_000
