"""The verdict of several runs counts what passed and failed, and names the slowest files."""

from __future__ import annotations

import pytest

from tests import verdict

pytestmark = pytest.mark.serial

RESULTS = """<?xml version="1.0" encoding="utf-8"?><testsuites><testsuite name="pytest" errors="1"
failures="2" skipped="3" tests="10" time="7.5">
<testcase classname="tests.castx.heat.test_body" name="test_one[a]" time="1.5"/>
<testcase classname="tests.castx.heat.test_body" name="test_one[b]" time="2.5"/>
<testcase classname="tests.forms.test_heat" name="test_two" time="3.0"/>
</testsuite></testsuites>"""


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "1 rank.xml").write_text(RESULTS)
    (tmp_path / "1 rank.status").write_text("1")
    return tmp_path


def verdict_of(folder, capsys) -> tuple[int, list[str]]:
    status = verdict.main(folder, folder / "kept" / "durations.csv")
    return status, capsys.readouterr().out.splitlines()


def passing(folder, name: str, status: int = 0, tests: int = 4) -> None:
    suite = f'<testsuite errors="0" failures="0" skipped="0" tests="{tests}" time="1"/>'
    (folder / f"{name}.xml").write_text(f"<testsuites>{suite}</testsuites>")
    (folder / f"{name}.status").write_text(str(status))


def test_numbers_of_all_runs(folder, capsys):
    passing(folder, "2 ranks")
    status, lines = verdict_of(folder, capsys)
    assert status == 1
    assert lines[-3:] == [
        "1 rank: 4 passed, 3 failed, 3 skipped in 8 s",
        "2 ranks: 4 passed, 0 failed, 0 skipped in 1 s",
        "8 passed, 3 failed",
    ]


def test_slowest_files_and_the_durations_that_are_kept(folder, capsys):
    _, lines = verdict_of(folder, capsys)
    assert [line.split() for line in lines[1:3]] == [
        ["4.0", "s", "tests/castx/heat/test_body.py"],
        ["3.0", "s", "tests/forms/test_heat.py"],
    ]
    kept = (folder / "kept" / "durations.csv").read_text().splitlines()
    assert kept[0] == "run,file,test,seconds"
    assert kept[1] == "1 rank,tests/castx/heat/test_body.py,test_one[a],1.5"
    assert len(kept) == 4


@pytest.mark.parametrize(("status", "failed"), [(0, 0), (verdict.NO_TESTS, 0), (2, 1), (137, 1)])
def test_a_bad_end_without_a_failed_test_is_a_failure(tmp_path, capsys, status, failed):
    passing(tmp_path, "1 rank", status)
    result, lines = verdict_of(tmp_path, capsys)
    assert (result, lines[-1]) == (failed, f"4 passed, {failed} failed")


def test_a_run_without_results_has_failed(tmp_path, capsys):
    (tmp_path / "3 ranks.status").write_text("124")
    status, lines = verdict_of(tmp_path, capsys)
    assert status == 1
    assert lines[-2:] == [
        "3 ranks: 0 passed, 1 failed, 0 skipped in 0 s, ended with status 124 before its end",
        "0 passed, 1 failed",
    ]


def test_nothing_that_ran_is_a_failure(tmp_path, capsys):
    passing(tmp_path, "1 rank", verdict.NO_TESTS, tests=0)
    assert verdict_of(tmp_path, capsys)[0] == 1
