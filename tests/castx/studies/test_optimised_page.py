"""The page of an optimisation: best numbers, answers with their limits, the best one so far."""

import numpy as np
import pytest

from castx.studies.asked.optimise import Optimise
from castx.studies.optimised_page import best_answers, best_numbers, best_so_far, optimised_page
from castx.studies.runs.answers import RunAnswer
from castx.studies.runs.kept import KeptRun
from castx.studies.table import StudyTable

pytestmark = pytest.mark.serial

INPUT = {"of": "bodies.0.temperature", "name": "pouring", "low": 640, "high": 700}


def study(**keys):
    return Optimise.read({"goal": "time", "inputs": [INPUT], **keys})


def table():
    """Three runs, the second of which has failed."""
    runs = [
        KeptRun(
            digest="", changes={}, ended=ended, said=said, seconds=1.0, processor_seconds=1.0,
            folder=f"runs/<{k}>",
        )
        for k, (ended, said) in enumerate(
            [("finished", ""), ("broken", "why & how"), ("finished", "")]
        )
    ]  # fmt: skip
    found = [
        {"time": RunAnswer("time", t, "s", 1.0), "gap": RunAnswer("gap", g, "mm", 1e3)}
        for t, g in ((3.0, 1e-4), (4.0, 2e-4))
    ]
    values = np.array([[650.0], [660.0], [670.0]])
    return StudyTable(["pouring"], ["°C"], values, runs, [found[0], {}, found[1]])


def test_the_best_so_far_is_that_within_limits():
    goal = np.array([2.0, np.nan, 5.0, 1.0, 4.0])
    within = np.array([False, False, True, True, True])
    np.testing.assert_array_equal(best_so_far(goal, within, "least"), [np.nan, np.nan, 5, 1, 1])
    np.testing.assert_array_equal(best_so_far(goal, within, "most"), [np.nan, np.nan, 5, 5, 5])


def test_answers_stand_with_their_limits():
    limits = [{"of": "gap", "most": 0.3}, {"of": "time", "least": 1, "most": 5}]
    assert best_answers(study(limits=limits), table(), 2) == [
        ("time [s]", "4 (at least 1, at most 5)"), ("gap [mm]", "0.2 (at most 0.3)"),
    ]  # fmt: skip
    assert best_answers(study(), table(), 0) == [("time [s]", "3")]
    assert best_numbers(table(), 2) == [("pouring [°C]", "670")]


def test_the_page_tells_all_and_escapes_it():
    text = optimised_page("bar <b>", study(), table(), np.array([True, False, True]), 0, [])
    assert "bar &lt;b&gt;" in text and "1 failed" in text and "broken: why &amp; how" in text
    assert text.count("data:image/png;base64,") == 1 and "this one is nearest" not in text
    told = ["No run keeps all limits; this one is nearest.", "More may find better ones."]
    text = optimised_page("bar", study(), table(), np.zeros(3, dtype=bool), 0, told)
    assert " ".join(told) in text
