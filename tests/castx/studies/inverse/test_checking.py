"""Studies that cannot begin are refused by a check of their case."""

import pytest

from castx.command.cli import execute
from castx.errors import CaseError
from castx.studies.inverse.checking import refuse_useless_studies
from tests.castx.cooled_mould import STUDY
from tests.castx.many_runs import CASE

pytestmark = pytest.mark.serial

VARY = """
[vary]
draws = 4
[[vary.inputs]]
of = "bodies.0.temperature"
low = 600
high = 700
"""


def file(tmp_path, text):
    path = tmp_path / "case.toml"
    path.write_text(CASE + text)
    return path


def test_studies_that_can_begin_are_named(tmp_path):
    assert refuse_useless_studies(file(tmp_path, VARY)) == ["vary"]
    assert refuse_useless_studies(file(tmp_path, "")) == []


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        ("bodies.0.temperature", "automatic", "automatic = .*: unknown key; known keys: name"),
        ("bodies.0.temperature", "bodies.7.temperature", "bodies"),
        ("low = 600", "low = -900", "below absolute zero"),
        ("draws = 4", "draws = -1", r"vary\.draws = -1"),
    ],
)
def test_a_check_refuses_what_no_run_could_begin_with(comm, tmp_path, capsys, old, new, why):
    path = file(tmp_path, VARY.replace(old, new))
    with pytest.raises(CaseError, match=why):
        refuse_useless_studies(path)
    assert execute(["check", str(path)], comm) == 2
    assert "vary" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        ('file = "near.csv"', 'file = "none.csv"', "there is no such file"),
        ("heat.closed", "heat.close", "the case has nothing at"),
    ],
)
def test_curves_and_unknowns_are_looked_at_too(tmp_path, old, new, why):
    rows = "".join(f"{time / 4},{200 + time}\n" for time in range(24))
    (tmp_path / "near.csv").write_text("time,near.temperature\n" + rows)
    assert refuse_useless_studies(file(tmp_path, STUDY)) == ["identify"]
    with pytest.raises(CaseError, match=why):
        refuse_useless_studies(file(tmp_path, STUDY.replace(old, new)))


def test_each_study_is_read_once(tmp_path, caplog):
    """Else ranges of the databases are told twice."""
    caplog.set_level("INFO")
    text = VARY.replace("low = 600\nhigh = 700\n", "").replace(
        "bodies.0.temperature", "materials.metal.solidification_shrinkage"
    )
    path = file(tmp_path, text)
    path.write_text(
        path.read_text().replace("[materials.metal]", '[materials.metal]\nextends = "AlSi7Mg"')
    )
    refuse_useless_studies(path)
    assert caplog.text.count("the range of AlSi7Mg") == 1
