"""What a run can find, before it runs: every topic of the findings, for what a case has."""

import ast
from pathlib import Path

import pytest

import castx.report.summary as room
from castx.case.reading.read import load_case
from castx.report.summary import freezing, solid
from castx.report.summary.answerable import ANSWER_KINDS, answerable, refusal_of
from castx.report.summary.registry import findings
from castx.report.summary.risks import FIELD_RISKS
from tests.castx.many_runs import CASE
from tests.castx.report.summary.fake_run import run
from tests.castx.report.summary.test_solid import end

pytestmark = pytest.mark.serial

# Of a run that has not frozen; of runs beside a run, which studies do not make.
NEVER = {"Still liquid", "Freezing time by coherency", "Largest gap by coherency"}
WITH_MECHANICS = CASE.replace('scheme = "thermal"', 'scheme = "iterated"').replace(
    'fields = ["temperature"]', 'fields = ["temperature", "niyama", "tearing_margin"]'
)


@pytest.fixture(scope="module")
def case_of(tmp_path_factory):
    def read(text, *overrides):
        path = tmp_path_factory.mktemp("case") / "case.toml"
        path.write_text(text)
        return load_case(path, overrides)

    return read


@pytest.fixture(scope="module")
def thermal(case_of):
    return case_of(CASE)


@pytest.fixture(scope="module")
def mechanical(case_of):
    text = WITH_MECHANICS.replace('material = "metal"', 'material = "AlSi7Mg"')
    return case_of(text.replace('material = "die"', 'material = "steel-H13"'))


def topics():
    """Yield the topics that stand in the sources of the findings."""
    named = {**vars(freezing), **vars(solid)}
    for path in Path(room.__path__[0]).glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            call = isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
            if not (call and node.args) or node.func.id not in ("Finding", "_suction"):
                continue
            topic = node.args[2] if node.func.id == "_suction" else node.args[0]
            for part in ast.walk(topic):
                if isinstance(part, ast.Constant) and isinstance(part.value, str):
                    yield part.value
                elif isinstance(part, ast.Name) and isinstance(named.get(part.id), str):
                    yield named[part.id]


def test_no_topic_of_the_findings_is_forgotten():
    known = {kind.topic for kind in ANSWER_KINDS}
    found = set(topics()) - {" without bounds"} - NEVER
    assert {"Largest gap", "Residual stress", "Freezes last"} < found <= known
    assert {risk.topic for risk in FIELD_RISKS} <= known


def test_what_a_run_finds_was_answerable(mechanical):
    found = run()
    found.record["stage_ends"] = [end(0, 3.0, 5e7, "casting", "mould")]
    names = [finding.name for finding in findings(found)]
    assert len(names) == 7 and set(names) <= set(answerable(mechanical))


def test_heat_alone_has_no_gaps_and_no_stress(thermal):
    known = answerable(thermal)
    assert known[:2] == ["Freezes last: casting", "Worst hot spot: casting"]
    assert not [name for name in known if "gap" in name or "tress" in name]
    text = refusal_of("Largest gap: casting/mould", thermal)
    assert text.startswith('needs mechanics, and coupling.scheme = "thermal" has none; without it')


def test_fields_must_be_written(thermal, mechanical):
    assert refusal_of("Least Niyama: casting", thermal).startswith("needs the field niyama: add it")
    assert refusal_of("Least Niyama: casting", mechanical) == ""
    assert "Tearing margin at g_c = 0.02: casting" in answerable(mechanical)
    assert not [name for name in answerable(mechanical) if name.startswith("Shrinkage")]


def test_a_mistyped_name_is_refused_with_what_there_is(mechanical):
    text = refusal_of("Largest gap: casting/mold", mechanical)
    assert text.startswith("no run answers this; they answer: Freezes last: casting, ")
    assert text.endswith('(did you mean "Largest gap: casting/mould"?)')


def test_a_body_whose_temperature_is_varied_may_freeze(case_of):
    text = CASE.replace(
        "[[bodies]]", "latent_heat = 2e5\nsolidus = 1400\nliquidus = 1450\n[[bodies]]", 1
    )
    case = case_of(text)
    assert "Freezes last: mould" not in answerable(case)
    assert "Freezes last: mould" in answerable(case, ["bodies.1.temperature"])
    assert "Freezes last: mould" not in answerable(case, ["bodies.0.temperature"])
