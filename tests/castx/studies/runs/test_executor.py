"""Executors: the local one and the one of the tests offer what a runner asks for."""

import pytest

from castx.studies.runs.executor import Ended, Task
from castx.studies.runs.local import LocalProcesses
from tests.castx.many_runs import CASE, Formulas

pytestmark = pytest.mark.serial


@pytest.mark.parametrize("kind", [LocalProcesses, lambda: Formulas(lambda content: ({}, {}))])
def test_every_task_ends_once(kind, tmp_path):
    """Tasks that castx refuses are enough: nothing is solved."""
    (tmp_path / "case.toml").write_text(CASE.replace("[geometry]", "[geometri]"))
    tasks = [Task(("info", "--no-such-option"), tmp_path / f"log{k}") for k in range(2)]
    if kind is not LocalProcesses:
        tasks = []
    found = dict(kind().ended(tasks))
    assert sorted(found) == list(range(len(tasks)))
    assert all(isinstance(ended, Ended) and ended.code == 2 for ended in found.values())
