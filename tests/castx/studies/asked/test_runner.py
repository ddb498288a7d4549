"""Settings of the runs of a study."""

import pytest

from castx.errors import CaseError
from castx.studies.asked.runner import Running

pytestmark = pytest.mark.serial


def test_memory_and_time_have_units():
    found = Running.read({"memory": "1.5 GB", "time_limit": "2 min", "processes": 3})
    assert (found.memory, found.time_limit, found.processes) == (1.5e9, 120.0, 3)
    assert found.slurm is None


@pytest.mark.parametrize(
    ("key", "value", "text"),
    [
        ("memory", "3 m", "amount of memory"),
        ("memory", 0, "positive"),
        ("memory", "290 MB", "takes 300 MB before it begins"),
        ("processes", 0, "from 1"),
        ("folder", " ", "a folder is needed"),
        ("cores", 2, "known keys: processes, memory"),
    ],
)
def test_others_are_refused(key, value, text):
    with pytest.raises(CaseError, match=text):
        Running.read({key: value})
