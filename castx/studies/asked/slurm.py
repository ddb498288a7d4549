"""How the runs of a study are handed to a cluster that Slurm schedules."""

from __future__ import annotations

from typing import Annotated

from castx.input.entries import Description, EntryName, Quantity
from castx.input.units import TIME


class SlurmJobs(Description):
    """Settings of the jobs of a study; each run is one job of an array, on one core.

    Attributes:
        partition: of the cluster; None: its usual one.
        account: that the time is booked on; None: the usual one.
        qos: quality of service; None: the usual one.
        constraint: on the nodes; None: none.
        time: that a job may take before Slurm ends it [s]; None: that of the partition.
    """

    partition: EntryName | None = None
    account: EntryName | None = None
    qos: EntryName | None = None
    constraint: EntryName | None = None
    time: Annotated[float | None, Quantity(TIME, above=0.0)] = None
