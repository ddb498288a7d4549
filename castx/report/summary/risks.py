"""Risks of the casting: liquid that is cut off, and the extremes of the written foundry fields."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from castx.arrays import FloatArray
from castx.foundry.suction import CUT_OFFS
from castx.input.units import seconds_text
from castx.meshes.generators.declaration import PLANE_MODELS
from castx.report.summary.finding import Finding, Shown
from castx.report.summary.freezing import earlier
from castx.results.reading import Results
from castx.results.states.quantities import MARGINS


@dataclass(frozen=True)
class FieldRisk:
    """A field whose extreme value in the castings is a finding.

    A new field needs one line in `FIELD_RISKS`.

    Args:
        field: its name, at points or in cells.
        topic: what its extreme is called.
        unit: in which it is shown.
        factor: from SI to the unit.
        sentence: what the number means; {front} is where gradients are taken.
        extreme: of the values that are finite, by its index.
    """

    field: str
    topic: str
    unit: str
    factor: float
    sentence: str
    extreme: Callable[..., np.intp] = np.argmax


FIELD_RISKS = (
    FieldRisk("pore_fraction", "Shrinkage porosity", "%", 100.0,
              "Most fine pores where the suction of the mush reaches its limit, in metal that is "
              "fed to there; gas and feeding over a distance are left out. Cavities of pools that "
              "nothing feeds are the hot spots."),
    FieldRisk("niyama", "Least Niyama", "K^½ s^½/mm", 1e-3,
              "Shrinkage porosity is likely where G/√Ṫ at {front} is low; the limit depends on the "
              "alloy.", np.argmin),
    FieldRisk("dimensionless_niyama", "Least dimensionless Niyama", "", 1.0,
              "Pores open where it is low.", np.argmin),
    FieldRisk("clyne_davies", "Hot tearing", "", 1.0,
              "Largest ratio of Clyne and Davies: it compares places, without a limit, and has no "
              "stress in it."),
    FieldRisk("brittle_strain", "Strain in the brittle range", "%", 100.0,
              "Largest strain across the gradient gained from f_s = 0.9 to 0.99: what the alloy "
              "bears is another matter."),
    FieldRisk("brittle_strain_index", "Brittle strain over what the alloy bears", "", 1.0,
              "Above 1 it tears."),
    *(FieldRisk(f"{MARGINS}{cut_off!r}", f"Tearing margin at g_c = {cut_off:g}", "", 1.0,
                "Strain rate over the critical one of Rappaz, Drezet and Gremaud; above 1 it "
                "tears. Judge the band of all cut-offs.")
      for cut_off in CUT_OFFS),
    FieldRisk("suction_margin", "Suction margin", "", 1.0,
              "Largest computed suction of the mush until its dendrites have grown together, over "
              "the depression at which films of melt tear; above 1 they do. Take it beside the "
              "tearing margins, which see one column of mush each."),
    FieldRisk("cold_crack_index", "Cold-crack index", "", 1.0,
              "Largest σ_1/R_m(T) since the metal was solid; above 1 it cracks."),
)  # fmt: skip


def hot_spots(run: Results) -> Iterator[Finding]:
    """Yield the hot spot of each casting that lacks most, unless it lacks nothing, as of iron."""
    seen = set()
    plane = run.model in PLANE_MODELS
    factor, unit = (1e4, "cm² of the section") if plane else (1e6, "cm³")
    for spot in run.record.get("hot_spots", []):  # the worst first
        body = str(spot["body"])
        if body in seen:
            continue
        seen.add(body)
        lacks = spot["deficit"]
        if lacks is not None and lacks <= 0.0:
            continue
        what = (
            "what its freezing lacks, of which the shell takes a part back where mechanics has it "
            "(unfed_volume)"
            if lacks is not None
            else "liquid that is cut off"
        )
        isolated, ended = float(spot["isolated"]), spot.get("ended")
        last = run.times[-1] if ended is None else earlier(run.times, float(ended))
        yield Finding(
            "Worst hot spot", body, spot["volume"] if lacks is None else lacks, unit,
            f"Nothing feeds this pool from {seconds_text(isolated)} on; the number is {what}.",
            factor=factor, place=spot["place"], time=isolated,
            shown=Shown("solid_fraction", (body,), last),
        )  # fmt: skip


def unbounded(risk: FieldRisk, body: str, values: FloatArray, shown: Shown) -> Finding:
    """Return a finding with the share of infinite values of a field.

    Args:
        risk: the field.
        body: that has it.
        values: at its nodes, (nodes,).
        shown: the picture.
    """
    share = float(np.isposinf(values).mean())
    return Finding(
        f"{risk.topic} without bounds", body, share, "% of the nodes",
        "There it is infinite, so that the largest number below says too little: in a margin of "
        "tearing shrinkage alone opens pores, whatever the strain.",
        factor=100.0, shown=shown,
    )  # fmt: skip


def alloy_risks(run: Results) -> Iterator[Finding]:
    """Yield the indices of hot tearing of the alloys of the castings."""
    for body in run.freezing:
        indices = run.record["bodies"].get(body, {}).get("tearing")
        if not indices:
            continue
        yield Finding(
            "Kou's index of the alloy", body, float(indices["kou"]), "K",
            "Largest |dT/d√f_s| between f_s = 0.87 and 0.94: it ranks alloys, has no limit, and of "
            "a table of solid fractions it is the slope of its rows.",
        )  # fmt: skip
        if indices.get("clyne_davies") is not None:
            yield Finding(
                "Ratio of Clyne and Davies of the alloy", body, float(indices["clyne_davies"]), "",
                "(T_0.9 - T_0.99)/(T_0.4 - T_0.9) of even cooling: it ranks alloys.",
            )  # fmt: skip


def field_risks(run: Results) -> Iterator[Finding]:
    """Yield the extremes of the foundry fields that were written, at the end of the run."""
    for risk in FIELD_RISKS:
        for body in run.freezing:
            time = next((t for t in reversed(run.times) if body in run.grids(t)), None)
            grid = None if time is None else run.grids(time)[body]
            if grid is None or risk.field not in grid.array_names:
                continue
            values = np.asarray(grid[risk.field], dtype=np.float64)
            if np.isposinf(values).any():
                yield unbounded(risk, body, values, Shown(risk.field, (body,), time))
            finite = np.flatnonzero(np.isfinite(values))
            if finite.size == 0 or np.ptp(values[finite]) == 0.0:
                continue
            here = int(finite[risk.extreme(values[finite])])
            in_cells = risk.field in grid.cell_data
            point = grid.cell_centers().points[here] if in_cells else grid.points[here]
            yield Finding(
                risk.topic, body, float(values[here]), risk.unit,
                risk.sentence.replace("{front}", str(run.record.get("front", "f_s = 0.9"))),
                factor=risk.factor,
                place=[float(x) for x in point[: 3 if run.model == "3d" else 2]],
                shown=Shown(risk.field, (body,), time),
            )  # fmt: skip
