"""Every benchmark can be started: it explains itself, and its cases are accepted."""

from __future__ import annotations

import ast
import random
import shutil
import subprocess
import sys
import tomllib
from argparse import Namespace
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from bench import drawn_faults, executed_lines, line_tests, mutation
from castx.case.reading.read import load_case

pytestmark = pytest.mark.serial

BENCH = Path(__file__).parents[1] / "bench"


def script(name: str) -> ModuleType:
    """Return a script as a module."""
    spec = spec_from_file_location(name, BENCH / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", [path.stem for path in sorted(BENCH.glob("*.py"))])
def test_each_explains_itself(name, capsys):
    found = script(name)
    with pytest.raises(SystemExit) as ended:
        found.main(["--help"])
    assert ended.value.code == 0
    said = " ".join(capsys.readouterr().out.split())
    first = (found.__doc__ or "").partition("\n")[0]
    assert first.endswith(("?", ".")) and first in said


@pytest.mark.parametrize("name", ["robustness", "random_castings"])
def test_castings_drawn_at_random_are_accepted(name):
    drawing = script(name)
    for number in range(60):
        case = drawing.casting(random.Random(f"1/{number}"))
        assert tomllib.loads("\n".join(drawing.toml(case))) == case
        load_case(case)


@pytest.mark.parametrize(
    "changes", [(), ("turned", "mirrored", "renumbered", "swapped", "tight")], ids=len
)
def test_foundries_drawn_at_random_are_accepted(changes, tmp_path):
    running = script("random_foundries")
    for number in range(20):
        drawn = running.foundry(random.Random(f"1/{number}"))
        case = load_case(running.written(drawn, tmp_path / str(number), changes))
        assert {body.name for body in case.bodies} == {b.body for b in drawn.blocks}
        assert (case.coupling.tolerance == 1e-8) == ("tight" in changes)


def test_sand_of_a_foundry_is_rigid_in_plane_stress():
    """Cases with its other law, which has no plane stress, were refused instead of run."""
    running, laws = script("random_foundries"), set()
    for number in range(120):
        case = running.foundry(random.Random(f"2/{number}")).case
        if case["geometry"]["model"] == "plane-stress":
            laws |= {b["law"] for b in case["bodies"] if b["material"].startswith("sand")}
    assert laws == {"rigid"}


def test_a_foundry_is_turned_and_mirrored_with_its_weight():
    """Motions of its nodes keep its shape; half a section only stands on its head."""
    running = script("random_foundries")
    points = np.random.default_rng(1).normal(size=(6, 3))
    for size, model in ((2, "plane-strain"), (3, "3d")):
        given, down = points[:, :size], -np.eye(size)[size - 1 :]
        for changes in (("turned",), ("mirrored",), ("turned", "mirrored")):
            found, load = (running.moved(v, model, changes) for v in (given, down))
            np.testing.assert_allclose(found @ found.T, given @ given.T)
            np.testing.assert_allclose(found @ load[0], given @ down[0])
            assert np.abs(load - down).max() == ("turned" in changes)
    flat = running.moved(points[:, :2], "axisymmetric", ("turned",))
    np.testing.assert_array_equal(flat, points[:, :2] * [1.0, -1.0])


def test_a_foundry_is_judged_by_cuts_iterations_and_what_cannot_be(tmp_path, monkeypatch):
    running = script("random_foundries")
    monkeypatch.setattr(running, "strength", lambda *_: iter(()))
    drawn = running.foundry(random.Random("1/0"))
    right = {
        "time": 1.0, "cutbacks": 0, "passes": 2, "mechanics_iterations": 25, "energy_error": 1e-8,
        "casting.force_error": 1e-4, "casting.solid_fraction": 1.0, "casting.min_temperature": 30.0,
        "casting/mould.suction": 5.0,
    }  # fmt: skip
    wrong = {"cutbacks": 3, "passes": 21, "mechanics_iterations": 26, "energy_error": 1e-3,
             "casting.force_error": 0.1, "casting.solid_fraction": 1.1,
             "casting.min_temperature": 0.0}  # fmt: skip
    (tmp_path / "run").mkdir()

    def judged(**changed):
        rows = [dict.fromkeys(right, 0), right, right | {"time": 2.0} | changed]
        lines = [",".join(right), *(",".join(map(str, row.values())) for row in rows)]
        (tmp_path / "run" / "history.csv").write_text("\n".join(lines) + "\n")
        return running.judged(drawn, tmp_path)

    counts, found = judged()
    assert found == [] and (counts["passes"], counts["most its"], counts["suction"]) == (4, 25, 5.0)
    for name, value in wrong.items():
        assert len(judged(**{name: value})[1]) == 1, name


def test_the_casting_whose_cost_is_measured_may_be_a_solid():
    scaling = script("scaling")
    case = load_case(scaling.CASE, scaling.SOLID)
    assert case.bodies[0].material == "solid"
    assert case.materials["solid"].liquid is None


@pytest.mark.parametrize("place", ["nodes", "cells"])
def test_a_casting_of_an_alloy_freezes_at_nodes_or_inside_cells(place):
    freezing = script("freezing")
    asked = Namespace(tetrahedra=3000, law="thermo-elastic", end=2.0)
    case = freezing.cylinder(place, asked)
    assert (case.bodies[0].material, case.bodies[0].freezing) == ("AlSi7Mg", place)
    assert (case.bodies[0].law, case.time.end) == ("thermo-elastic", 2.0)


@pytest.mark.parametrize("law", ["elastic", "flowing"])
def test_a_casting_of_industrial_size_flows_or_is_elastic(law):
    industrial = script("industrial")
    case = industrial.cylinder(30_000, law)
    assert ("viscoplastic" in case.bodies[0].law) == (law == "flowing")
    assert (case.bodies[0].material == "solid") == (law == "elastic")


def history(gap=1e-4, **changes):
    """Return two accepted steps of a casting of 20 N, as they are read from a history."""
    steps = {
        "time": [0.0, 1.0, 2.0], "casting/mould.force.y": 19.0,
        "casting.support_force.y": 1.0, "casting.force_error": 1e-4, "mould.force_error": 0.0,
        "casting/mould.min_gap": 0.0, "casting/mould.mean_gap": gap / 2,
        "casting/mould.max_gap": gap, "largest_pull": 0.0, "frozen_pairs": 1.0, "cutbacks": 0.0,
        "fallbacks": 0.0, "unbalanced": 0.0, "mechanics_iterations": 1.0,
    } | changes  # fmt: skip
    return {name: np.broadcast_to(value, 3) for name, value in steps.items()}


@pytest.mark.parametrize(
    "changes, said",
    [
        ({}, []),
        ({"casting/mould.force.y": [19.0, 19.0, 18.0]},
         ["the weight is missed by 5.0e-02", "exact methods differ by 5.0e-02"]),
        ({"mould.force_error": [0.0, 0.1, 0.0]}, ["forces are missing by 1.0e-01"]),
        ({"casting/mould.min_gap": [0.0, 0.0, -1e-3], "frozen_pairs": 0.0},
         ["penetration of 1.0e-02 of the size"]),
        ({"largest_pull": [0.0, 1.0, 0.0]},
         ["1 steps with a frozen pair in violation", "a pair pulls by 5.0e-02 of the weight"]),
        ({"gap": 1.1e-4}, ["exact methods differ by 1.0e-01"]),
    ],
)  # fmt: skip
def test_castings_are_judged_by_every_accepted_step(changes, said):
    bench = script("random_castings")
    case = {
        "geometry": {"model": "plane-strain", "box": [0.1, 20.0 / (2680 * 9.81 * 0.1)]},
        "bodies": [{"material": "AlSi7Mg"}], "loads": {},
        "interfaces": [{"bodies": ["casting", "mould"]}],
    }  # fmt: skip
    found = history(**changes)
    apart = bench.difference(case, history(), found)
    judged = bench.judged(case, found)
    assert list(bench.wrongs({"condensed": found}, judged, apart)) == said
    assert list(bench.wrongs({"penalty": "3"}, {}, None)) == ["penalty did not end (3)"]


def test_cases_that_are_written_out_are_accepted():
    memory, restart, cylinder = (script(name) for name in ("memory", "restart", "scaling"))
    for method, linear in memory.KINDS:
        case = load_case(tomllib.loads(memory.case_text(method, linear, 1000)))
        assert case.time.end == pytest.approx(20.0)
        assert (case.interfaces[0].contact.method, case.solver.linear) == (method, linear)
    assert load_case(tomllib.loads(restart.CASE)).output.checkpoint == 0.1
    size = cylinder.element_size(5400)
    assert load_case(cylinder.CASE, [f"geometry.size={size}"]).geometry.model == "3d"


def test_elements_are_compared_in_cases_that_are_accepted(tmp_path):
    bench = script("cost_per_digit")
    for part in bench.PARTS.values():
        made = {(element, size): case for element, size, case in bench.cases(part, tmp_path)}
        assert set(part.reference) <= set(made)
        assert len({case.time.fixed_step for case in made.values()}) == 1
        forms = {element: case.bodies[0].formulation for (element, _), case in made.items()}
        assert "taylor-hood" in forms.values() and None in forms.values()
    assert bench.digits([0.1, -0.01, 0.005, 0.005]) == pytest.approx(1.523, abs=1e-3)


def test_paths_are_those_of_meshes_and_steps(tmp_path):
    bench = script("path_dependence")
    cases = bench.hubs(tmp_path)
    assert len({case.geometry.file for case in cases.values()}) == len(bench.SIZES) == 3
    changes = [case.time.temperature_change for case in cases.values()]
    assert changes == [20.0, 10.0] * 3
    own = bench.of_file(BENCH.parent / "demos" / "cylinder.toml")
    assert [case.time.largest_step for case in own.values()] == [2.0, 1.0]


@pytest.mark.parametrize("name", ["constitutive", "contact"])
def test_those_that_build_their_problem_themselves_measure_a_tiny_one(name, capsys):
    found = script(name)
    found.main(["60"])
    heading, *lines = capsys.readouterr().out.splitlines()
    assert heading.split() and lines
    assert all(float(line.split()[0]) > 10 for line in lines)


def test_faults_still_stand_where_the_list_says():
    """At least a hundred different ones, each in one place, with tests that exist."""
    found = mutation.mutants()
    assert len({(mutant.path, mutant.text, mutant.replacement) for mutant in found}) > 100
    rooms = {mutant.path.removeprefix("castx/").partition("/")[0] for mutant in found}
    assert rooms >= {"forms", "contact", "transfer", "materials", "mechanics", "coupling"}
    checkout = BENCH.parent
    for mutant in found:
        code = (checkout / mutant.path).read_text(encoding="utf-8")
        assert mutant.planted(code) != code
        if mutant.path.endswith(".py"):
            compile(mutant.planted(code), mutant.path, "exec")
        assert all((checkout / test.split("::")[0]).is_file() for test in mutant.tests), mutant


def test_faults_of_ranks_are_for_the_rank_contract_to_notice():
    of_ranks = [fault for fault in mutation.mutants() if fault.ranks > 1]
    assert len(of_ranks) >= 120
    outside = [
        test
        for fault in of_ranks
        for test in fault.tests
        if not in_contract(BENCH.parent / test.partition("::")[0], test.partition("::")[2])
    ]
    assert not outside


def in_contract(file: Path, function: str) -> bool:
    """Return whether a function of a file of tests is marked `ranks`, any if it is not named."""
    return any(
        function.partition("[")[0] in ("", node.name)
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef)
        and "pytest.mark.ranks" in map(ast.unparse, node.decorator_list)
    )


def test_a_fault_that_stands_nowhere_or_twice_is_refused():
    fault = mutation.Mutant("a.py", "x = 1", "x = 2", ("tests/test_bench.py",))
    assert fault.planted("x = 1\ny = 1\n") == "x = 2\ny = 1\n"
    for code in ("y = 1\n", "x = 1\nx = 1\n"):
        with pytest.raises(ValueError, match=r"a\.py: x = 1  →  x = 2: stands there"):
            fault.planted(code)


SOURCE = '''"""At 20 °C: 1 + 2."""
__all__ = [1]


@dataclass(frozen=True)
def f(x: Annotated[int, 7], share=0.5, n=20, kind=Literal[3]):
    """Return 5."""
    if x < 3.5 and len(x) > 0:
        raise ValueError("1" + str(9))
    log.info("%g", 1.5 * x)
    return max(x, 4) - 2.0  # "°" is two bytes: é - 1
'''


def test_faults_are_drawn_over_code_alone():
    """Constants, comparisons, signs, extremes, joints, defaults; no texts, types or errors."""
    found = drawn_faults.candidates("a.py", SOURCE)
    assert [(fault.line, fault.old, fault.new) for fault in found] == [
        (6, "0.5", "0.05"), (6, "0.5", "5.0"), (6, "20", "2"), (6, "20", "200"),
        (8, "<", ">="), (8, "3.5", "0.35"), (8, "3.5", "35.0"), (8, "and", "or"), (8, ">", "<="),
        (8, ">", ">="), (8, "0", "1"), (11, "max", "min"), (11, "4", "5"), (11, "-", "+"),
        (11, "2.0", "0.2"), (11, "2.0", "20.0"),
    ]  # fmt: skip
    for fault in found:
        planted, lines = fault.planted(SOURCE).splitlines(), SOURCE.splitlines()
        assert len(planted) == len(lines)
        assert [n for n, old in enumerate(lines, 1) if planted[n - 1] != old] == [fault.line]
    with pytest.raises(ValueError, match="stands there"):
        found[0].planted("é" + SOURCE)


def test_a_draw_is_that_of_its_seed():
    first, again, other = (drawn_faults.drawn(200, seed) for seed in (1, 1, 2))
    assert first == again and len(set(first)) == 200 and len({*first, *other}) > 350
    for fault in first:
        code = (BENCH.parent / fault.path).read_text(encoding="utf-8")
        compile(fault.planted(code), fault.path, "exec")


def test_a_drawn_fault_stays_drawn_when_other_lines_change(tmp_path):
    folder = tmp_path / "forms"
    folder.mkdir()
    code = "".join(f"a{n} = {n}.5 + b{n}\n" for n in range(200))
    changes = {}
    for name, text in (("before", code), ("after", code.replace("a7 = 7.5 + b7\n", "c = 1.0\n\n"))):
        (folder / "a.py").write_text(text)
        lines = text.splitlines()
        found = drawn_faults.drawn(100, 1, tmp_path)
        changes[name] = {(lines[f.line - 1], f.old, f.new) for f in found}
    assert len(changes["before"] & changes["after"]) >= 98


LIBRARY = '''from castx.inner.b import LIMIT


def twice(x, factor=2):
    """Return a multiple."""
    return (
        factor
        * x
    )


def limited(x):
    return min(x, LIMIT)


def never():
    return 1
'''
TESTS = """import pytest

from castx.a import limited, twice


@pytest.fixture(scope="module")
def four():
    return twice(2)


def test_first(four):
    assert four == 4


def test_second(four):
    assert limited(four) == 0.5


def test_fails():
    assert twice(2) == 5


def test_none():
    pass
"""


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """Return a small checkout and the record of its lines."""
    if sys.version_info < (3, 12):
        pytest.skip("sys.monitoring came with Python 3.12")
    checkout = tmp_path_factory.mktemp("recorded")
    for folder in ("castx/inner", "tests/castx", "bench"):
        (checkout / folder).mkdir(parents=True)
    for name in ("mutation", "executed_lines"):
        shutil.copy(BENCH / f"{name}.py", checkout / "bench")
    (checkout / "castx" / "__init__.py").touch()
    (checkout / "castx" / "a.py").write_text(LIBRARY)
    (checkout / "castx" / "inner" / "b.py").write_text("OTHER = 1\nLIMIT = 0.5\n")
    (checkout / "tests" / "castx" / "test_a.py").write_text(TESTS)
    code = (
        "from pathlib import Path; from bench.executed_lines import record; "
        "record(Path('lines.npz'), ['tests'])"
    )
    mutation.isolate(checkout)
    subprocess.run(
        [sys.executable, "-c", code], cwd=checkout, env=mutation.environment(checkout), check=True,
        capture_output=True,
    )  # fmt: skip
    return checkout, executed_lines.read(checkout)


def test_a_record_says_which_tests_execute_a_line(recorded):
    """A fixture of the module counts for all that ask for it; tests that fail do not count."""
    _, lines = recorded
    first, second, none = (f"tests/castx/test_a.py::test_{name}" for name in
                           ("first", "second", "none"))  # fmt: skip
    assert set(lines.seconds) == {first, second, none}
    assert lines.tests_of("castx/a.py", [7]) == {first, second}
    assert lines.tests_of("castx/a.py", [13]) == {second}
    assert lines.tests_of("castx/a.py", [1, 4, 16]) == set()
    assert 0.0 <= lines.seconds[none] <= sum(lines.seconds.values()) < 60.0
    with pytest.raises(FileNotFoundError, match="no lines are recorded"):
        executed_lines.read(BENCH)


def test_a_fault_is_tried_by_the_tests_of_its_line(recorded):
    checkout, lines = recorded
    tests_of = line_tests.LineTests(lines, checkout)
    first, second, none = (f"tests/castx/test_a.py::test_{name}" for name in
                           ("first", "second", "none"))  # fmt: skip
    assert tests_of("castx/a.py", 13) == [second]
    assert tests_of("castx/inner/b.py", 2) == [second]  # what names the constant
    assert set(tests_of("castx/a.py", 4)) == {first, second, none}  # a default, and the room
    assert set(tests_of("castx/a.py", 6)) == {first, second}  # within a statement
    assert set(tests_of("castx/a.py", 16)) == {first, second, none}  # no test: the room


def test_a_drawn_fault_is_caught_by_a_test_that_is_named(recorded):
    checkout, lines = recorded
    tests = sorted(lines.seconds)
    code = (checkout / "castx" / "a.py").read_text()
    for fault, said in (
        (drawn_faults.Fault("castx/inner/b.py", 2, 18, 21, "0.5", "5.0"), "caught"),
        (drawn_faults.Fault("castx/a.py", 16, len(code) - 2, len(code) - 1, "1", "2"), "survived"),
    ):
        found, tried = mutation.verdict(fault, tests, lines.seconds, checkout, 60.0)
        assert found.verdict == said and tried == 3
        assert found.test == ("tests/castx/test_a.py::test_second" if said == "caught" else "")
        assert (checkout / "castx" / "a.py").read_text() == code
        assert (checkout / "castx" / "inner" / "b.py").read_text().endswith("LIMIT = 0.5\n")


def test_tests_are_tried_in_portions_that_grow():
    seconds = {"a": 2.0, "b": 0.5, "c": 14.0, "d": 30.0, "e": 29.0, "f": 50.0, "g": 900.0}
    found = ["".join(portion) for portion in mutation.portions("abcdefg", seconds)]
    assert found == ["ab", "c", "de", "fg"]


def test_faults_are_planted_where_python_finds_them(tmp_path):
    """In a copy that is imported in place of the checkout that is installed."""
    copy = mutation.copy_of_checkout(tmp_path)  # asks Python, and raises if it looks elsewhere
    assert (copy / "castx" / "forms").resolve() == copy / "forms"


def test_histories_differ_by_shares_of_their_quantities():
    """Rounding of a force that vanishes is one of the forces; efforts and errors are no answer."""
    differences = script("histories").differences
    before = history() | {"casting/mould.force.x": np.full(3, 1e-15)}
    after = before | {
        "casting/mould.force.x": np.full(3, -1e-15), "casting/mould.mean_gap": np.full(3, 4e-5),
        "casting.force_error": np.zeros(3), "cutbacks": np.ones(3),
    }  # fmt: skip
    found = differences(before, after)
    assert found["casting/mould.force.x"] < 1e-15
    assert found["casting/mould.mean_gap"] == pytest.approx(0.1)
    assert not {"cutbacks", "time", "casting.force_error"} & set(found)
    missing = after | {"casting/mould.max_gap": np.array([1e-4, np.nan, 1e-4])}
    assert differences(before, missing)["casting/mould.max_gap"] == np.inf


def test_histories_of_different_steps_are_refused():
    later = history() | {"time": np.array([0.0, 1.0, 2.1])}
    with pytest.raises(SystemExit, match="different steps"):
        script("histories").differences(history(), later)


def test_random_assemblies_are_drawn_meshed_and_judged(tmp_path):
    """A small one is meshed; what it is not told it calls wrong."""
    bench = script("random_assemblies")
    step = tmp_path / "a.step"
    again = [bench.written(random.Random("1/9"), step) for _ in range(2)]
    assert again[0] == again[1] and again[0][0].words == ["cone", "halves z"]
    assert len(again[0][0].solids) == 3 and 0.005 <= again[0][1] <= 1.0
    ran = {"ended": "ran", "steps": 5, "volume": 0.01}
    place = "castx: a and b overlap round (0.1, 0, -2e-3) m; cut one"
    for cells, said in (
        (ran, []),
        ({**ran, "steps": 3}, ["3 steps"]),
        ({**ran, "volume": 0.4}, ["a volume is off by 0.4"]),
        ({"ended": "refused", "said": place}, []),
        ({"ended": "refused", "said": "a; b"}, ["the refusal has no place"]),
        ({"ended": "refused", "said": "a.step: b"}, ["the refusal has no cure"]),
        ({"ended": "3", "said": ""}, ["ended by 3"]),
    ):
        assert list(bench.wrongs(cells, 5)) == said
