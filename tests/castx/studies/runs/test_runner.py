"""The runner: runs are made once, kept, taken again after a kill, and failed ones stay so."""

import pytest

from castx.errors import CaseError
from castx.results.files.folder import FolderLock
from castx.studies.runs.executor import Ended
from castx.studies.runs.kept import NOT_CONVERGED, OUT_OF_TIME, REFUSED
from castx.studies.runs.runner import Runner, refuse_living, study_folder
from tests.castx.many_runs import CASE, Formulas

pytestmark = pytest.mark.serial

TEMPERATURE = "bodies.0.temperature"


def answered(content):
    temperature = content["bodies"][0]["temperature"]
    if temperature == 666.0:
        raise RuntimeError("too hot")
    return {"time": 2.0 * temperature}, {"time": [0.0, 1.0], "near.temperature": [0.0, 1.0]}


@pytest.fixture
def case_file(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(CASE)
    return path


def runner(case_file, executor, **keys):
    return Runner(case_file, (), case_file.parent / "study", executor, **keys)


def wanted(*temperatures):
    return [{TEMPERATURE: value} for value in temperatures]


def test_each_is_made_once_and_returned_in_order(case_file):
    executor = Formulas(answered)
    first = runner(case_file, executor)
    runs = first.runs(wanted(650.0, 660.0, 650.0))
    assert [run.changes[TEMPERATURE] for run in runs] == [650.0, 660.0, 650.0]
    assert len(executor.made) == first.made == 2 and runs[0] is runs[2]
    again = runner(case_file, executor)
    assert again.runs(wanted(660.0, 670.0))[0] == runs[1]
    assert len(executor.made) == 3 and again.made == 1
    assert all((first.results(run) / "probes.csv").is_file() for run in runs)


def test_a_killed_study_goes_on(case_file):
    dying = Formulas(answered, dies_after=2)
    with pytest.raises(KeyboardInterrupt):
        runner(case_file, dying).runs(wanted(650.0, 655.0, 660.0))
    living = Formulas(answered)
    runs = runner(case_file, living).runs(wanted(650.0, 655.0, 660.0))
    assert len(living.made) == 1 and all(run.is_finished for run in runs)


def test_a_failed_run_is_kept_until_it_is_asked_anew(case_file):
    executor = Formulas(answered)
    (run,) = runner(case_file, executor).runs(wanted(666.0))
    assert run.ended == NOT_CONVERGED and "too hot" in run.said
    runner(case_file, executor).runs(wanted(666.0))
    assert len(executor.made) == 1
    anew = runner(case_file, executor, anew=True)
    anew.runs(wanted(666.0))
    anew.runs(wanted(666.0))
    assert len(executor.made) == 2


def test_a_value_that_the_case_refuses_is_a_refused_run(case_file):
    executor = Formulas(answered)
    (run,) = runner(case_file, executor).runs(wanted(-300.0))
    assert run.ended == REFUSED and "below absolute zero" in run.said and not executor.made


def test_a_case_file_that_changes_meanwhile_is_refused(case_file):
    def meddling(content):
        case_file.write_text(CASE.replace("end = 6", "end = 7"))
        return answered(content)

    class Late(Formulas):
        def ended(self, tasks):
            case_file.write_text(CASE.replace("end = 6", "end = 7"))
            yield from super().ended(tasks)

    with pytest.raises(CaseError, match="has changed while its study ran"):
        runner(case_file, Late(answered)).runs(wanted(650.0))
    executor = Formulas(answered)
    runner(case_file, executor).runs(wanted(650.0))
    assert executor.made[0]["time"]["end"] == 7


def test_time_limit_and_overrides_are_handed_on(case_file):
    seen = []

    class Watching(Formulas):
        def ended(self, tasks):
            seen.extend(task.arguments for task in tasks)
            return iter(())

    one = Runner(case_file, ("time.end=3",), case_file.parent / "s", Watching(answered), 60.0)
    with pytest.raises(KeyError):
        one.runs(wanted(650.0))
    (arguments,) = seen
    assert arguments[-4:] == ("--set", "time.end=3", "--set", f"{TEMPERATURE}=650.0")
    assert arguments[arguments.index("--time-limit") + 1] == "60.0"


def test_a_run_out_of_time_does_not_say_how_to_go_on(case_file):
    class Slow(Formulas):
        def ended(self, tasks):
            yield 0, Ended(130, "interrupted: the time limit of 1 s; go on with", 1.0, 1.0)

    (run,) = runner(case_file, Slow(answered)).runs(wanted(650.0))
    assert (run.ended, run.said) == (OUT_OF_TIME, "the time limit of 1 s")


def test_a_folder_belongs_to_one_study(tmp_path):
    with study_folder(tmp_path / "s") as folder:
        with pytest.raises(CaseError, match=r"in use by process \d+"), study_folder(folder):
            pass
    with study_folder(folder):
        pass
    (tmp_path / "file").touch()
    with pytest.raises(CaseError, match="holds files that are no study"), study_folder(tmp_path):
        pass


def test_a_run_that_still_lives_is_not_made_anew(tmp_path):
    refuse_living(tmp_path / "none")
    lock = FolderLock(tmp_path)
    assert lock.acquire() is None
    with pytest.raises(CaseError, match="a run of a study that was killed"):
        refuse_living(tmp_path)
    lock.release()
    refuse_living(tmp_path)
