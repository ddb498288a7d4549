"""Run the tests on any number of MPI ranks: shared fixtures, and one common verdict for each test.

Under ``mpirun -n 2 python3 -m pytest`` every rank runs the same tests. Only rank 0 prints. After
each phase of a test the ranks exchange their outcomes; a test that failed anywhere has failed
everywhere, so that they all go on together and rank 0 shows the tracebacks of all. A rank that
failed while others still wait for it inside a collective call ends the run after a grace period,
with its traceback.

Several runs on one rank can share the tests: each claims a file of them before its first test.
`--all` runs what is marked `slow`, and all parameters of what is marked `sampled`.
"""

from __future__ import annotations

import gc
import logging
import os
import sys
import time
from collections.abc import Callable, Generator, Iterator
from pathlib import Path

from mpi4py import MPI

import hypothesis
import pytest

from tests import communicators, compiled_forms, selection

# Examples that differ between ranks would end in different collective calls.
for profile, examples in (("quick", 25), ("all", 100)):
    hypothesis.settings.register_profile(
        profile, derandomize=True, database=None, deadline=None, max_examples=examples
    )

GRACE_SECONDS = 30.0
WORLD = MPI.COMM_WORLD
CLAIMS = pytest.StashKey[str | None]()
"""Folder in which the runs that share the tests leave their claims; None: nothing is shared."""
# The exchange between ranks must never be taken for a message of the test itself.
VERDICTS = WORLD.Dup()


@pytest.fixture
def comm() -> MPI.Intracomm:
    """Return the communicator of all ranks of this test run."""
    return WORLD


@pytest.fixture
def shared_tmp_path(tmp_path: Path) -> Path:
    """Return a temporary folder that is the same on all ranks."""
    return WORLD.bcast(tmp_path)


@pytest.fixture(scope="session")
def written_case(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Return what writes a case file into a new folder that is the same on all ranks."""

    def write(text: str) -> Path:
        file = Path(WORLD.bcast(tmp_path_factory.mktemp("case"))) / "case.toml"
        if WORLD.rank == 0:
            file.write_text(text)
        WORLD.Barrier()
        return file

    return write


@pytest.fixture(autouse=True)
def collect_garbage() -> Iterator[None]:
    """Free what the test left behind on all ranks together: PETSc's destructors are collective."""
    yield
    if WORLD.size > 1:
        gc.collect()
        if petsc := sys.modules.get("petsc4py.PETSc"):
            petsc.garbage_cleanup()
        WORLD.Barrier()


@pytest.fixture(autouse=True)
def restore_logging() -> Iterator[None]:
    """Undo what a command run inside the tests sets for the messages of castx."""
    logger = logging.getLogger("castx")
    before = logger.propagate, logger.level, list(logger.handlers)
    yield
    logger.propagate, logger.level, logger.handlers = before


def pytest_addoption(parser: pytest.Parser) -> None:
    """Offer to run everything."""
    parser.addoption("--all", action="store_true", help="slow tests and all parameters too")


def runs_everything(config: pytest.Config) -> bool:
    """Return whether slow tests run too, and all parameters of sampled ones."""
    return config.getoption("--all") or selection.named_by_hand(config.args)


@pytest.hookimpl(tryfirst=True)
def pytest_configure(config: pytest.Config) -> None:
    """Leave printing and result files to rank 0; runs that a test starts share nothing."""
    config.stash[CLAIMS] = os.environ.pop("CASTX_TEST_CLAIMS", None)
    hypothesis.settings.load_profile("all" if runs_everything(config) else "quick")
    compiled_forms.keep()
    if WORLD.rank > 0:
        sys.stdout = open(os.devnull, "w")  # the reporter keeps what it finds here
        config.option.xmlpath = None
    if communicators.are_scarce():
        config.pluginmanager.register(communicators)


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Pass over files without tests of the rank contract on several ranks."""
    if WORLD.size == 1 or not collection_path.is_file() or selection.named_by_hand(config.args):
        return None
    return None if selection.may_belong_to_contract(collection_path) else True


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what the markers say of this number of ranks."""
    if WORLD.size > 1 and selection.named_by_hand(config.args):
        return
    left_out = selection.left_out(items, WORLD.size, everything=runs_everything(config))
    if left_out:
        items[:] = [item for item in items if item not in left_out]
        config.hook.pytest_deselected(items=list(left_out))
    if config.stash[CLAIMS]:
        items[:] = selection.longest_first(items)


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item, nextitem: pytest.Item | None) -> bool | None:
    """Leave a test to the run that has claimed its file, if several runs share them."""
    folder = item.config.stash[CLAIMS]
    if folder is None or selection.is_own(item, Path(folder)):
        return None
    # The test before left standing what this one would have needed.
    item.session._setupstate.teardown_exact(nextitem)
    return True


def pytest_collection_finish(session: pytest.Session) -> None:
    """Refuse to start when the ranks found different tests."""
    gc.freeze()  # what the imports made stays, and need not be searched after each test
    found = (session.testsfailed, [item.nodeid for item in session.items])
    if any(other != found for other in VERDICTS.allgather(found)):
        pytest.exit("the ranks did not collect the same tests", returncode=2)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Give one phase of a test the same outcome on all ranks."""
    report = yield
    if VERDICTS.size == 1:
        return report
    wait_for_other_ranks(report)
    verdicts = VERDICTS.allgather((report.outcome, report.longreprtext))
    outcomes = {outcome for outcome, _ in verdicts}
    if "failed" in outcomes or len(outcomes) > 1:
        report.outcome = "failed"
        report.longrepr = "\n".join(
            f"---- {outcome} on ranks "
            f"{[rank for rank, own in enumerate(verdicts) if own == (outcome, text)]}\n{text}"
            for outcome, text in dict.fromkeys(verdicts)
        )
    return report


def wait_for_other_ranks(report: pytest.TestReport) -> None:
    """Wait until all ranks have finished this phase; end the run if a failure here stops them."""
    arrival = VERDICTS.Ibarrier()
    give_up = time.monotonic() + (GRACE_SECONDS if report.failed else float("inf"))
    while not arrival.Test():
        time.sleep(0.001)
        if time.monotonic() > give_up:
            print(
                f"\n{report.nodeid} ({report.when}) failed on rank {WORLD.rank}, and the other "
                f"ranks did not finish it within {GRACE_SECONDS:g} s: the run ends here.",
                report.longreprtext,
                sep="\n",
                file=sys.__stderr__,
                flush=True,
            )
            WORLD.Abort(1)
