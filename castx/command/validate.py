"""Experiments on the command line: their list, their missing digits, comparison with a model."""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

from mpi4py import MPI

from rich.box import SIMPLE_HEAD
from rich.table import Table

from castx.command.studies import refuse_ranks
from castx.command.verify import Lines
from castx.proof.validation.band import BandedExperiment, banded, refuse_without_ranges
from castx.proof.validation.band_page import curve_text, write_band_page
from castx.proof.validation.experiment import CASE, Experiment, chosen, experiments
from castx.proof.validation.page import PAGE, Overlay, write_page
from castx.ranks import on_first_rank
from castx.results.reading import Results
from castx.studies.runs.executor import Executor
from castx.studies.runs.runner import study_folder


class Solve(Protocol):
    """Runs a case file into a results folder; collective."""

    def __call__(self, path: Path, *, output: Path, comm: MPI.Intracomm) -> object:
        """Return when it is done."""


def experiment_list(experiments: list[Experiment]) -> Table:
    """Return the table of experiments and of their missing digits."""
    table = Table("experiment", "title", "digits missing", box=SIMPLE_HEAD, pad_edge=False)
    for experiment in experiments:
        count = len(experiment.missing)
        table.add_row(experiment.name, experiment.facts.title, str(count) if count else "none")
    return table


def digit_table(experiment: Experiment) -> Table:
    """Return the digits that are known."""
    table = Table("digit", "value", "uncertainty", box=SIMPLE_HEAD, pad_edge=False)
    for digit in experiment.facts.digits:
        if not isinstance(digit.value, str):
            value = f"{digit.value:.6g} {digit.unit}".strip()
            given = digit.uncertainty
            table.add_row(digit.name, value, given if isinstance(given, str) else f"± {given:.3g}")
    return table


def ratio_lines(experiment: Experiment) -> list[str]:
    """Return a line for each ratio that can be compared although digits are missing."""
    lines = []
    for ratio in experiment.facts.ratios:
        measured = experiment.ratio(ratio)
        found = "digits missing" if measured is None else f"measured {measured:.4g}"
        model = "no answer of the model" if ratio.model is None else f"model {ratio.model:.4g}"
        if measured is not None and ratio.model is not None:
            model += f" ({100 * (ratio.model / measured - 1):+.2g} %)"
        lines.append(f"{ratio.name}: {found}, {model}: {ratio.because}")
    return lines


def list_or_validate(
    name: str | None,
    root: Path,
    output: Path,
    comm: MPI.Intracomm,
    console: Lines,
    solve: Solve,
    executor: Executor,
) -> None:
    """List the experiments of a folder, or compare with the one of a name as `validate` does."""
    if name is not None:
        experiment = on_first_rank(comm, lambda: chosen(root, name))
        show_facts(experiment, console)
        if experiment.facts.ranges:
            refuse_ranks(comm)
            validate_over_ranges(experiment, output / name, console, executor)
        else:
            validate(experiment, output / name, comm, console, solve)
        return
    console.print(experiment_list(on_first_rank(comm, lambda: experiments(root))))
    console.refuse_loss()


def show_facts(experiment: Experiment, console: Lines) -> None:
    """Show title, source, digits and ratios of an experiment."""
    console.print(f"{experiment.facts.title}\n{experiment.facts.source}", markup=False)
    if experiment.facts.digits:
        console.print(digit_table(experiment))
    for line in ratio_lines(experiment):
        console.print(line, markup=False)


def validate_over_ranges(
    experiment: Experiment, folder: Path, console: Lines, executor: Executor
) -> None:
    """Run the case of an experiment over its ranges, and show where what was measured lies.

    Args:
        experiment: to compare with.
        folder: of the study.
        console: of the first rank.
        executor: makes the runs.

    Raises:
        CaseError: a missing number of the case has no range; or what a study refuses.
    """
    refuse_without_ranges(experiment)
    with study_folder(folder.resolve()) as opened:
        found = banded(experiment, opened, executor)
        for line in band_lines(found):
            console.print(line, markup=False)
        page = write_band_page(opened, experiment, found)
    console.print(f"written: {page}", markup=False)


def band_lines(found: BandedExperiment) -> list[str]:
    """Return a line for each digit and curve of a banded experiment, and one for its runs."""
    lines = [f"{found.finished} of {len(found.runs)} runs have finished"]
    for one in found.answers:
        lines.append(
            f"{one.name}: {one.lowest:.3g} to {one.highest:.3g} {one.unit} in the runs, "
            f"{one.verdict}"
        )
    return [*lines, *(f"{curve.band.column}: {curve_text(curve)}" for curve in found.curves)]


def validate(
    experiment: Experiment,
    folder: Path,
    comm: MPI.Intracomm,
    console: Lines,
    solve: Solve,
) -> None:
    """Run the case of an experiment and compare measured with computed curves.

    Args:
        experiment: to compare with.
        folder: of the results.
        comm: the ranks.
        console: of the first rank.
        solve: runs a case file.

    Raises:
        CaseError: digits are missing, with the whole list; or what a run refuses.
    """
    experiment.refuse_incomplete()
    solve(experiment.folder / CASE, output=folder, comm=comm)
    made = on_first_rank(comm, lambda: write_page(folder, experiment, Results(folder)))
    for overlay in made:
        console.print(overlay_text(overlay), markup=False)
    console.print(f"written: {folder / PAGE}", markup=False)


def overlay_text(overlay: Overlay) -> str:
    """Return the deviation of a computed curve from the measured one as a line."""
    apart, unit = overlay.deviation, overlay.unit
    text = (
        f"{overlay.column}: RMS {apart.root_mean_square:.3g} {unit}, at most {apart.largest:+.3g} "
        f"{unit} at {apart.at:.4g} s, {apart.points} points, uncertainty {overlay.uncertainty_text}"
    )
    return text if overlay.within is None else f"{text}, within it {100 * overlay.within:.0f} %"
