"""Sensors of a study: their samples within the run, and their curves at any depth and clock.

The depth of a sensor and the offset of its clock cost no run of their own: each run records a row
of probes about the place of the sensor, between which its curve is interpolated.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from castx.arrays import FloatArray
from castx.case.case import Case
from castx.case.output import Probe
from castx.errors import CaseError
from castx.foundry.identification.fit import Unknown
from castx.input.problems import among
from castx.results.files.measurements import read_measurement
from castx.studies.asked.curves import SensorCurve
from castx.studies.asked.identify import CLOCK, Identify

RUNGS = 9
"""Probes on each side of a sensor whose depth is unknown."""
WIDE = 3.0
"""How far they go, in deviations of the depth."""
DEPTH = "depth of "
"""Before the name of a probe: how much deeper it lies than the case says."""
OF_DEPTH, OF_CLOCK = 1e-4, 0.1
"""Differences of depths [m], and the largest one of a clock [s]."""
FEWEST = 11
"""Samples that a test of whiteness needs."""
COVERED = 0.5
"""Share of the run that a curve should cover, and up to which samples must reach."""
log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False)
class Sensor:
    """A sensor with its samples.

    Attributes:
        asked: its description.
        probe: the probe at its place.
        time: of its samples since the start of the run, by the clock of the logger [s], (samples,).
        values: in SI, (samples,).
        rungs: places of its row of probes, against its own [m]; none where its depth is known.
    """

    asked: SensorCurve
    probe: Probe
    time: FloatArray
    values: FloatArray
    rungs: FloatArray

    @property
    def depth_name(self) -> str:
        """Name of its depth among the unknowns."""
        return f"{DEPTH}{self.probe.name}"

    def rung_names(self) -> list[str]:
        """Return the names of its row of probes."""
        return [f"{self.probe.name} {k:+d}" for k in range(len(self.rungs))]

    def rung_probes(self, given: Mapping[str, Any]) -> list[dict[str, Any]]:
        """Return its row of probes as a case file has them.

        Args:
            given: its own probe there.
        """
        quantity = self.asked.of.split(".")[1]
        kept = {key: value for key, value in given.items() if key not in ("depth", "name")}
        rows = []
        for name, shift in zip(self.rung_names(), self.rungs, strict=True):
            row = {**kept, "name": name, "quantities": [quantity]}
            if self.probe.below is not None:
                row["depth"] = self.probe.depth + float(shift)
            else:
                row["at"] = [float(x) for x in self.moved(float(shift))]
            rows.append(row)
        return rows

    def moved(self, shift: float) -> FloatArray:
        """Return its place, moved along its direction [m]."""
        along = np.array(self.asked.direction, dtype=np.float64)
        return np.array(self.probe.at) + shift * along / np.linalg.norm(along)

    def computed(self, probes: Mapping[str, FloatArray], values: Mapping[str, float]) -> FloatArray:
        """Return the samples that a run gives, (samples,).

        Args:
            probes: columns of probes.csv of the run.
            values: of the unknowns.
        """
        time = self.time + values.get(CLOCK, 0.0)
        if not len(self.rungs):
            return np.asarray(np.interp(time, probes["time"], probes[self.asked.of]))
        ending = self.asked.of.removeprefix(self.probe.name)
        shift = float(np.clip(values[self.depth_name], self.rungs[0], self.rungs[-1]))
        upper = int(np.clip(np.searchsorted(self.rungs, shift), 1, len(self.rungs) - 1))
        share = (shift - self.rungs[upper - 1]) / (self.rungs[upper] - self.rungs[upper - 1])
        names = self.rung_names()
        below, above = (probes[f"{names[k]}{ending}"] for k in (upper - 1, upper))
        curve = (1.0 - share) * below + share * above
        return np.asarray(np.interp(time, probes["time"], curve))

    def unknown(self) -> Unknown | None:
        """Return its depth as a fit takes it; None where it is known."""
        deviation = self.asked.depth_deviation
        if deviation is None:
            return None
        return Unknown(
            self.depth_name, 0.0, OF_DEPTH, deviation,
            low=float(self.rungs[0]), high=float(self.rungs[-1]) - 2.0 * OF_DEPTH,
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Sensors:
    """All sensors of a study, their samples one behind the other.

    Attributes:
        sensors: them.
        clock_deviation: how well their clock is known [s]; None: it is.
    """

    sensors: Sequence[Sensor]
    clock_deviation: float | None

    @classmethod
    def of(cls, study: Identify, case: Case) -> Sensors:
        """Read the samples of a study.

        Raises:
            CaseError: no probe belongs to a curve, its file cannot be read, it has no samples
                within the run, or nothing is measured of its second half.
        """
        late = 0.0 if study.clock_deviation is None else WIDE * study.clock_deviation
        end = case.time.end - late
        if end <= 0.0:
            raise CaseError(
                f"[identify] clock_deviation = {study.clock_deviation:g} s: three of them are as "
                f"long as the run, which ends at {case.time.end:g} s; give a smaller one"
            )
        sensors = [_sensor(one, case, end) for one in study.curves]
        _refuse_unmeasured(max(float(one.time[-1]) for one in sensors), late, case.time.end)
        return cls(sensors, study.clock_deviation)

    def with_rung_in(self, text: str) -> Sensor | None:
        """Return the sensor of whose row of probes one is quoted in a text; None: of none is."""
        for one in self.sensors:
            if any(f"'{name}'" in text for name in one.rung_names()):
                return one
        return None

    @property
    def measured(self) -> FloatArray:
        """All samples, (samples,)."""
        return np.concatenate([one.values for one in self.sensors])

    @property
    def noise(self) -> FloatArray:
        """Deviation of each sample, (samples,)."""
        return np.concatenate([np.full(len(one.time), one.asked.sigma) for one in self.sensors])

    def parts(self, samples: FloatArray) -> list[FloatArray]:
        """Return all samples, or rows of them, apart for each sensor."""
        ends = np.cumsum([len(one.time) for one in self.sensors])[:-1]
        return np.split(samples, ends)

    def computed(self, probes: Mapping[str, FloatArray], values: Mapping[str, float]) -> FloatArray:
        """Return all samples that a run gives, (samples,); see `Sensor.computed`."""
        return np.concatenate([one.computed(probes, values) for one in self.sensors])

    def unknowns(self) -> list[Unknown]:
        """Return depths and clock as a fit takes them."""
        found = [unknown for one in self.sensors if (unknown := one.unknown()) is not None]
        if self.clock_deviation is not None:
            wide = WIDE * self.clock_deviation
            step = min(OF_CLOCK, 0.1 * self.clock_deviation)
            found.append(
                Unknown(CLOCK, 0.0, step, self.clock_deviation, low=-wide, high=wide - 2.0 * step)
            )
        return found

    def probes(self, given: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
        """Return the probes of a run: those of the case, and the rows about the sensors.

        Args:
            given: those of the case as its file has them.
        """
        own = {str(one["name"]): one for one in given}
        rows = [row for one in self.sensors for row in one.rung_probes(own[one.probe.name])]
        return [*(dict(one) for one in given), *rows]


def _refuse_unmeasured(last: float, late: float, end: float) -> None:
    """Refuse samples that end in the first half of a run.

    Args:
        last: time of the last one [s].
        late: by which the clock may be off [s].
        end: of the run [s].
    """
    if last + late < COVERED * end:
        raise CaseError(
            f"[identify] the samples of all curves end at {last:g} s, and the run at {end:g} s: "
            "whatever is sought of the rest is guessed, and every run computes it; correct start "
            f"or time_unit of the curves, or end the run with them: time.end = {last + late:g}"
        )


def _sensor(asked: SensorCurve, case: Case, end: float) -> Sensor:
    probes = {one.name: one for one in case.probes}
    if asked.probe not in probes:
        known = among(asked.probe, list(probes), what="probes")
        raise CaseError(f"[identify] {asked.of}: there is no probe {asked.probe!r}; {known}")
    probe = probes[asked.probe]
    if asked.of.split(".")[1] not in probe.quantities:
        known = among("", list(probe.quantities), what="it has")
        raise CaseError(f"[identify] {asked.of}: the probe does not record it; {known}")
    curve = read_measurement(asked)
    inside = (curve.time >= 0.0) & (curve.time <= end)
    count = int(inside.sum())
    if count < FEWEST:
        raise CaseError(
            f"[identify] {asked.of}: {count} samples lie within the run, from 0 to {end:g} s, and "
            f"those of {asked.file.name} from {curve.time[0]:g} to {curve.time[-1]:g} s of its "
            f"time; at least {FEWEST} are needed: correct start or time_unit, or time.end"
        )
    share = float(np.ptp(curve.time[inside])) / case.time.end
    if share < COVERED:
        log.warning(
            "%s: its samples cover %.0f %% of the run, from %g to %g s",
            asked.of, 100.0 * share, curve.time[inside][0], curve.time[inside][-1],
        )  # fmt: skip
    return Sensor(asked, probe, curve.time[inside], curve.values[inside], _rungs(asked, probe))


def _rungs(asked: SensorCurve, probe: Probe) -> FloatArray:
    if asked.depth_deviation is None:
        return np.empty(0)
    if probe.below is None and asked.direction is None:
        raise CaseError(
            f"[identify] {asked.of}: depth_deviation needs to know where depth goes: give the "
            'probe below = "casting/mould" and its depth, or the curve a direction = [1, 0]'
        )
    if probe.below is None and asked.direction and len(asked.direction) != len(probe.at):
        raise CaseError(
            f"[identify] {asked.of}: direction = {list(asked.direction)} needs as many numbers as "
            f"the place of the probe, at = {list(probe.at)}"
        )
    if probe.below is not None and probe.depth <= 0.0:
        raise CaseError(f"[identify] {asked.of}: a sensor on the surface has no unknown depth")
    far = WIDE * asked.depth_deviation
    least = -min(far, probe.depth) if probe.below is not None else -far
    below = np.linspace(least, 0.0, RUNGS + 1)[:-1]
    return np.concatenate([below, np.linspace(0.0, far, RUNGS + 1)])
