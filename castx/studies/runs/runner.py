"""The runner: many runs of one case, each made once and kept by the digest of its changed case."""

from __future__ import annotations

import logging
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import Any

from castx.case.reading.read import load_case
from castx.errors import CaseError
from castx.input.toml_written import toml_value
from castx.results.files.folder import FolderLock, reason_of, record_of
from castx.studies.runs.executor import Ended, Executor, Task
from castx.studies.runs.kept import (
    BROKEN,
    BY_CODE,
    FINISHED,
    LOG,
    OUT_OF_TIME,
    REFUSED,
    RESULTS,
    KeptRun,
    read_kept,
    write_kept,
)
from castx.version import __version__

Changes = Mapping[str, Any]
"""Values, of the types of JSON, by their paths in the case file."""
RUNS = "runs"
STUDY_MARK = ".castx-study"
_DIGITS = 16
log = logging.getLogger(__name__)


def changes_as_overrides(changes: Changes) -> list[str]:
    """Return changes as `--set` takes them."""
    return [f"{path}={toml_value(value)}" for path, value in changes.items()]


class Runner:
    """Makes runs of a case and keeps them.

    A run that has ended is never made again, whether it has failed or not: a study that was killed
    goes on where it was, and one that asks for more takes what is there.

    Args:
        case_file: the case.
        overrides: values that replace those of the file in all runs.
        folder: of the study.
        executor: makes the runs.
        time_limit: wall clock time of each run [s]; None: no limit.
        anew: whether runs that have failed are made again.
    """

    def __init__(
        self,
        case_file: Path,
        overrides: Sequence[str],
        folder: Path,
        executor: Executor,
        time_limit: float | None = None,
        anew: bool = False,
    ) -> None:
        self.case_file, self.overrides, self.folder = case_file, tuple(overrides), folder
        self._executor, self._time_limit = executor, time_limit
        self._anew = anew
        self._known: dict[str, KeptRun] = {}
        self._digests: dict[tuple[str, ...], str] = {}
        self.made = 0
        """How many runs were made, not taken from those that are kept."""
        self.used: set[str] = set()
        """Digests of all runs that were asked for, made or kept."""
        self.processor_seconds = 0.0
        """Time of processors that those took [s]."""

    def digest(self, changes: Changes) -> str:
        """Return the key of a run: the digest of its case, and the version of castx.

        Raises:
            CaseError: the case does not take these values.
        """
        given = tuple(self._set(changes))
        if given not in self._digests:
            self._digests[given] = f"{__version__} {load_case(self.case_file, given).digest}"
        return self._digests[given]

    def _set(self, changes: Changes) -> list[str]:
        return [*self.overrides, *changes_as_overrides(changes)]

    def results(self, run: KeptRun) -> Path:
        """Return the results folder of a run."""
        return self.folder / run.folder / RESULTS

    def runs(self, wanted: Sequence[Changes]) -> list[KeptRun]:
        """Return the runs of some changes, in their order; those that are not there are made.

        Raises:
            CaseError: a folder is in use by another run, or the case file has changed meanwhile.
        """
        found: dict[int, KeptRun] = {}
        missing: dict[str, list[int]] = {}
        for index, changes in enumerate(wanted):
            try:
                digest = self.digest(changes)
            except CaseError as error:
                found[index] = self._refused(changes, str(error))
                continue
            self.used.add(digest)
            kept = self._kept(digest)
            if kept is None:
                missing.setdefault(digest, []).append(index)
            else:
                found[index] = kept
        for digest, run in self._make({key: wanted[at[0]] for key, at in missing.items()}):
            found |= {index: run for index in missing[digest]}
        return [found[index] for index in range(len(wanted))]

    def _kept(self, digest: str) -> KeptRun | None:
        run = self._known.get(digest) or read_kept(self._folder(digest))
        if run is None or (self._anew and not run.is_finished and digest not in self._known):
            return None
        self._known[digest] = run
        return run

    def _folder(self, digest: str) -> Path:
        return self.folder / RUNS / sha256(digest.encode()).hexdigest()[:_DIGITS]

    def _refused(self, changes: Changes, why: str) -> KeptRun:
        return KeptRun(
            digest="",
            changes=dict(changes),
            ended=REFUSED,
            said=why,
            seconds=0.0,
            processor_seconds=0.0,
            folder="",
        )

    def _make(self, wanted: Mapping[str, Changes]) -> Iterator[tuple[str, KeptRun]]:
        """Yield digest and run of changes that are not there yet, as they end."""
        digests = list(wanted)
        tasks = [self._task(digest, wanted[digest]) for digest in digests]
        for count, (index, ended) in enumerate(self._executor.ended(tasks), start=1):
            digest = digests[index]
            run = self._ended(digest, wanted[digest], ended)
            write_kept(self._folder(digest), run)
            self._known[digest] = run
            self.made += 1
            self.processor_seconds += ended.processor_seconds
            why = "" if run.is_finished else f": {run.said}"
            log.info(
                "run %d of %d: %s in %.3g s%s", count, len(tasks), run.ended, ended.seconds, why
            )
            yield digest, run

    def _task(self, digest: str, changes: Changes) -> Task:
        folder = self._folder(digest)
        refuse_living(folder / RESULTS)
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        limit = () if self._time_limit is None else ("--time-limit", f"{self._time_limit!r}")
        given = (part for one in self._set(changes) for part in ("--set", one))
        arguments = ("run", str(self.case_file), "--output", str(folder / RESULTS), *limit, *given)
        return Task(arguments, folder / LOG)

    def _ended(self, digest: str, changes: Changes, ended: Ended) -> KeptRun:
        how = BY_CODE.get(ended.code, BROKEN)
        folder = self._folder(digest)
        if how == FINISHED:
            record = record_of(folder / RESULTS)
            if record is None or f"{__version__} {record['case']['digest']}" != digest:
                shutil.rmtree(folder, ignore_errors=True)
                raise CaseError(
                    f"{self.case_file} has changed while its study ran; start the study again: it "
                    "makes anew what the change concerns"
                )
        said = "" if how == FINISHED else ended.said.removeprefix(f"{how}: ")
        if how == OUT_OF_TIME:  # what castx run says of going on is none of a study's business
            said = said.removeprefix("interrupted: ").partition("; go on with")[0]
        return KeptRun(
            digest=digest, changes=dict(changes), ended=how, said=said, seconds=ended.seconds,
            processor_seconds=ended.processor_seconds, folder=str(folder.relative_to(self.folder)),
        )  # fmt: skip


def refuse_living(folder: Path) -> None:
    """Refuse to make a run anew while an earlier one still writes into its folder.

    Raises:
        CaseError: with the process that does.
    """
    if not folder.is_dir():
        return
    lock = FolderLock(folder)
    holder = lock.acquire()
    lock.release()
    if holder is not None:
        raise CaseError(f"{folder} is in use by {holder}, a run of a study that was killed; wait")


@contextmanager
def study_folder(folder: Path) -> Iterator[Path]:
    """Lock the folder of a study, which is made if it is not there.

    Raises:
        CaseError: it cannot be written, holds something else, or another study uses it.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if any(folder.iterdir()) and not (folder / STUDY_MARK).exists():
            raise CaseError(
                f"{folder} holds files that are no study of castx; choose another --output"
            )
        (folder / STUDY_MARK).touch()
        lock = FolderLock(folder)
        holder = lock.acquire()
    except OSError as error:
        raise CaseError(f"{folder} cannot be written: {reason_of(error)}") from None
    if holder is not None:
        raise CaseError(f"{folder} is in use by {holder}; wait for it, or choose another --output")
    try:
        yield folder
    finally:
        lock.release()
