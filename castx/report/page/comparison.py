"""comparison.html: runs beside each other, findings in a table with pictures, and curves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

from castx.errors import CaseError
from castx.report.page.assets import CURVES_ONLY, page
from castx.report.page.beside import picture_rows
from castx.report.page.charts import NUMERICS, Section, merged, run_sections
from castx.report.page.report import write_report
from castx.report.reported import ReportedRun
from castx.report.summary.finding import Finding
from castx.report.summary.registry import findings
from castx.report.summary.rows import Rows, further_rows, numeric_rows
from castx.results.files.folder import store_text

COMPARISON = "comparison.html"
MARK = '<meta name="generator" content="castx">'
"""What a page of castx has in its first lines."""
LOOKED_AT = 400


@dataclass(frozen=True)
class ComparedRun:
    """Data of one run in a comparison.

    Attributes:
        label: in headings and legends, unlike those of the others.
        run: the results.
        findings: by their names.
        sections: its curves.
    """

    label: str
    run: ReportedRun
    findings: Mapping[str, Finding]
    sections: Sequence[Section]

    @property
    def names(self) -> set[str]:
        """Names of its findings and curves of the casting; those of the effort say nothing."""
        curves = {
            f"{panel.label}, {line}"
            for section in self.sections if section.title != NUMERICS
            for panel in section.panels for line in panel.lines
        }  # fmt: skip
        return curves | set(self.findings)


def write_page(folders: Sequence[Path], output: Path | None) -> Path:
    """Write the report of one run, or the comparison of several, and return its path.

    Args:
        folders: results folders.
        output: the page of a comparison; None: comparison.html in the present folder.

    Raises:
        CaseError: see `write_report` and `write_comparison`.
    """
    if len(folders) > 1:
        return write_comparison(folders, output or Path(COMPARISON))
    if output is not None:
        raise CaseError("the report of one run is written into its folder: leave --output out")
    return write_report(folders[0])


def write_comparison(folders: Sequence[Path], target: Path) -> Path:
    """Write a page that compares runs, and return its path.

    Args:
        folders: their results folders, two or more.
        target: the page; an older one of castx is written over.

    Raises:
        CaseError: a folder holds no results or is named twice, the runs share neither findings nor
            curves, or the target is a file of somebody else.
        StorageError: the page cannot be written.
    """
    runs = compared(folders)
    refuse_strangers(runs)
    refuse_foreign(target)
    content = page(
        "comparison.html.j2",
        CURVES_ONLY,
        runs=runs,
        names=ordered([list(run.findings) for run in runs]),
        pictures=picture_rows([(run.run, run.findings) for run in runs]),
        cell=cell,
        tables=[
            ("Course", text_rows(runs, [further_rows(run.run) for run in runs])),
            ("Effort", text_rows(runs, [numeric_rows(run.run) for run in runs])),
        ],
        curves=merged({run.label: run.sections for run in runs}),
    )
    store_text(target, content)
    return target


def compared(folders: Sequence[Path]) -> list[ComparedRun]:
    """Return the runs with labels: the names of their folders, their paths where these are equal.

    Raises:
        CaseError: a folder holds no results, or is named twice.
    """
    whole = [folder.resolve() for folder in folders]
    for first, second in combinations(range(len(whole)), 2):
        if whole[first] == whole[second]:
            raise CaseError(f"{folders[second]} is named twice; compare different results folders")
    short = [path.name for path in whole]
    labels = short if len(set(short)) == len(short) else [str(path) for path in whole]
    return [opened(label, path) for label, path in zip(labels, whole, strict=True)]


def opened(label: str, folder: Path) -> ComparedRun:
    """Return the run of a results folder with the findings and sections to compare."""
    run = ReportedRun(folder)
    found = {finding.name: finding for finding in findings(run)}
    return ComparedRun(label, run, found, run_sections(run))


def refuse_strangers(runs: Sequence[ComparedRun]) -> None:
    """Refuse a run that shares nothing with any other one.

    Raises:
        CaseError: with the bodies and probes of all.
    """
    for run in runs:
        others = [other for other in runs if other is not run]
        if not any(run.names & other.names for other in others):
            has = "; ".join(f"{one.label} has {what_it_has(one)}" for one in runs)
            raise CaseError(
                f"{run.label} shares neither findings nor curves with the other runs: {has}. Runs "
                "are compared by the names of their bodies, interfaces and probes"
            )


def what_it_has(run: ComparedRun) -> str:
    """Return the names of bodies and probes of a run."""
    probes = sorted({name.partition(".")[0] for name in run.run.probes} - {"time"})
    return f"bodies {', '.join(run.run.bodies)} and probes {', '.join(probes) or 'none'}"


def refuse_foreign(target: Path) -> None:
    """Refuse to write over a file that is not a page of castx.

    Raises:
        CaseError: with the cure.
    """
    if target.is_dir():
        raise CaseError(f"{target} is a folder; name a file with --output FILE.html")
    if target.exists():
        with target.open(encoding="utf-8", errors="replace") as file:
            if MARK not in file.read(LOOKED_AT):
                raise CaseError(f"{target} is not a page of castx; choose another --output")


def ordered(lists: Sequence[Sequence[str]]) -> list[str]:
    """Return all names of some lists once, in the order of their first appearance."""
    return list(dict.fromkeys(name for names in lists for name in names))


def cell(run: ComparedRun, name: str, first: ComparedRun) -> tuple[str, str, str]:
    """Return the number of a finding of a run, how it differs from the first run, and where it is.

    Args:
        run: the run.
        name: of the finding.
        first: the run with which it is compared.
    """
    found, base = run.findings.get(name), first.findings.get(name)
    if found is None:
        return "–", "", ""
    apart = ""
    if base is not None and run is not first and base.value != 0.0:
        apart = f"{100.0 * (found.value - base.value) / abs(base.value):+.3g} %"
    return found.number, apart, found.where(run.run.model)


def text_rows(runs: Sequence[ComparedRun], rows: Sequence[Rows]) -> list[tuple[str, list[str]]]:
    """Return rows of several runs beside each other: name, and text of each run."""
    by_run = [dict(of) for of in rows]
    names = ordered([list(of) for of in by_run])
    return [(name, [of.get(name, "–") for of in by_run]) for name in names]
