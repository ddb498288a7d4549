"""A results folder opened by a person: findings, curves and tables at a word, also in notebooks."""

from __future__ import annotations

import html
from collections.abc import Iterable
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
from matplotlib.figure import Figure

from castx.arrays import FloatArray
from castx.errors import CaseError
from castx.input.problems import among
from castx.report.style import STYLE
from castx.report.summary.finding import Finding
from castx.report.summary.registry import findings
from castx.results.files.run_tables import TIME
from castx.results.reading import Results

if TYPE_CHECKING:
    import pandas

TABLES = ("probes", "history", "findings")
"""What `OpenedResults.data_frame` gives."""
NO_UNIT = "1"


class FindingList(list[Finding]):
    """Findings of a run, which a notebook shows as a table.

    Args:
        found: the findings.
        model: geometric model of the run, which names the axes.
    """

    def __init__(self, found: Iterable[Finding], model: str) -> None:
        super().__init__(found)
        self._model = model

    def rows(self) -> list[tuple[str, str, str, str]]:
        """Return topic, owner, number with its error, and place and time of each finding."""
        return [
            (found.topic, found.of, " ".join((found.number, found.error)).strip(),
             found.where(self._model))
            for found in self
        ]  # fmt: skip

    def __repr__(self) -> str:
        return "\n".join(
            f"{topic} ({of}): {number}" + (f"  [{where}]" if where else "")
            for topic, of, number, where in self.rows()
        )

    def _repr_html_(self) -> str:
        """Return the table that a notebook shows."""
        return html_table(("", "of", "value", "where and when"), self.rows())


class OpenedResults(Results):
    """The results folder of a run on any number of ranks, finished or still going on.

    >>> import castx
    >>> folder = castx.run("cylinder.toml", ["time.end=0.1", "geometry.size=1e-2"])
    t 0 s  step 0  ...
    >>> results = castx.Results(folder)
    >>> results
    aluminium cylinder in a steel mould: axisymmetric, finished at t = 0.1 s
      bodies      casting, mould
      interfaces  casting/mould
      fields      2 moments, 0 to 0.1 s
    >>> results.record["exit"]["reason"], results.bodies
    ('finished', ('casting', 'mould'))
    >>> print(f"{results.probes['centre.temperature'][0]:.1f} °C")
    670.0 °C
    >>> results.history["step"].tolist()
    [0.0, 0.05, 0.05]
    >>> temperature = results.field("temperature", "casting")  # at the last time, here 0.1 s
    >>> temperature.values.shape == (len(temperature.points),)
    True
    >>> results.units("casting")["displacement"], results.unit("centre.temperature")
    ('m', '°C')
    >>> results.over_time("temperature", "casting").values.shape[0]  # moments
    2
    >>> mould = results.grids(0.0)["mould"]  # for pyvista
    >>> print(f"{mould['temperature'].max():.1f} °C")
    200.0 °C
    >>> gap = next(found for found in results.findings() if found.topic == "Largest gap")
    >>> gap.of, gap.unit
    ('casting/mould', 'µm')
    >>> figure = results.plot("centre.temperature")  # of matplotlib
    >>> figure.axes[0].get_ylabel()
    'centre.temperature [°C]'

    `RunTables` has what is not a field: record, tables, probes, hot spots, ends of stages.

    Args:
        folder: the results folder.

    Raises:
        CaseError: it is none, or a file is missing or broken.
    """

    def findings(self) -> FindingList:
        """Return all findings of the report, as numbers with place, time and a sentence."""
        return FindingList(findings(self), self.model)

    def plot(self, *columns: str) -> Figure:
        """Return curves over time, a diagram for each unit, with what was measured as points.

        Args:
            columns: of probes.csv or history.csv; none: all of probes.csv.

        Raises:
            CaseError: there is no such column; with those that exist.
        """
        names = columns or tuple(name for name in self.probes if name != TIME)
        curves = {name: self._curve(name) for name in names}
        if not curves:
            known = among("", [name for name in self.history if name != TIME], what="there are")
            raise CaseError(f"the run has no probes; name a column of its history: {known}")
        units = list(dict.fromkeys(unit for _, _, unit in curves.values()))
        with mpl.rc_context(STYLE):
            drawn = Figure(figsize=(7.0, 3.0 * len(units)), layout="constrained")
            diagrams = drawn.subplots(len(units), squeeze=False, sharex=True)[:, 0]
            for unit, axes in zip(units, diagrams, strict=True):
                here = {name: curve for name, curve in curves.items() if curve[2] == unit}
                for name, (time, values, _) in here.items():
                    (line,) = axes.plot(time, values, label=name)
                    if name in self.measured:
                        curve = self.measured[name]
                        axes.plot(
                            curve.time, curve.values, ".", color=line.get_color(),
                            label=f"{name}, measured",
                        )  # fmt: skip
                label = next(iter(here)) if len(here) == 1 else ""
                axes.set_ylabel(f"{label} [{unit}]".strip() if unit != NO_UNIT else label)
                if len(axes.lines) > 1:
                    axes.legend()
            diagrams[-1].set_xlabel("time [s]")
        return drawn

    def _curve(self, name: str) -> tuple[FloatArray, FloatArray, str]:
        """Return times, values and unit of a column of either table."""
        if name in self.history and name not in self.probes:
            return self.history[TIME], self.history[name], self.history_unit(name)
        if name not in self.probes:
            known = [key for key in (*self.probes, *self.history) if key != TIME]
            raise CaseError(f"there is no {name!r}; {among(name, known, what='there are')}")
        return self.probes[TIME], self.probes[name], self.unit(name)

    def data_frame(self, table: str = "probes") -> pandas.DataFrame:
        """Return a table for pandas; the time is the index of the first two.

        Args:
            table: "probes", "history", or "findings", whose values are in SI.

        Raises:
            CaseError: there is no such table, or pandas is not installed.
        """
        if table not in TABLES:
            raise CaseError(f"no table {table!r}; {among(table, TABLES)}")
        if find_spec("pandas") is None:
            raise CaseError(
                "a data frame needs pandas, which is not installed: apt install python3-pandas, or "
                "pip install pandas"
            )
        from pandas import DataFrame

        if table == "findings":
            return DataFrame([finding_row(found) for found in self.findings()])
        columns = self.probes if table == "probes" else self.history
        return DataFrame(dict(columns)).set_index(TIME)

    def rows(self) -> list[tuple[str, str]]:
        """Return bodies, interfaces and moments of fields, as pairs of name and text."""
        rows = [("bodies", ", ".join(self.bodies)), ("interfaces", ", ".join(self.interfaces))]
        try:
            first, last = self.times[0], self.times[-1]
            moments = f"{len(self.times)} moments, {first:g} to {last:g} s"
        except CaseError:
            moments = "none"
        return [row for row in [*rows, ("fields", moments)] if row[1]]

    def _title(self) -> str:
        ended = self.record["exit"]["reason"] or "without an end"
        name = self.case["name"] or self.folder.name
        return f"{name}: {self.model}, {ended} at t = {self.record['time_reached']:g} s"

    def __repr__(self) -> str:
        lines = [f"  {name:<10}  {text}" for name, text in self.rows()]
        return "\n".join([self._title(), *lines])

    def _repr_html_(self) -> str:
        """Return the run and its findings as the tables that a notebook shows."""
        head = f"<p><b>{html.escape(self._title())}</b></p>"
        return head + html_table(("", ""), self.rows()) + self.findings()._repr_html_()


def finding_row(found: Finding) -> dict[str, Any]:
    """Return a finding as a row of a table, its value in SI."""
    return {
        "topic": found.topic, "of": found.of, "value": found.value, "shown": found.number,
        "error": found.error, "time": found.time,
        "place": None if found.place is None else tuple(found.place), "sentence": found.sentence,
    }  # fmt: skip


def html_table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a table for a notebook, with all texts escaped."""

    def line(cells: Iterable[str], kind: str) -> str:
        return "".join(f"<{kind}>{html.escape(cell)}</{kind}>" for cell in cells)

    body = "".join(f"<tr>{line(row, 'td')}</tr>" for row in rows)
    return f"<table><thead><tr>{line(head, 'th')}</tr></thead><tbody>{body}</tbody></table>"
