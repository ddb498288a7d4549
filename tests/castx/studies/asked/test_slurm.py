"""Settings of the jobs of a cluster."""

import pytest

from castx.errors import CaseError
from castx.studies.asked.runner import Running

pytestmark = pytest.mark.serial


def test_jobs_of_a_cluster_have_settings():
    found = Running.read({"slurm": {"partition": "long", "time": "2 h"}}).slurm
    assert found is not None and (found.partition, found.time) == ("long", 7200.0)
    assert found.account is found.qos is found.constraint is None


def test_names_that_sbatch_would_take_for_more_are_refused():
    with pytest.raises(CaseError, match="a name has 1 to"):
        Running.read({"slurm": {"account": "a;b"}})
    with pytest.raises(CaseError, match="positive"):
        Running.read({"slurm": {"time": 0}})
