"""The time of a first run grows with its cells."""

import pytest

from castx.case.cad.cost import first_run_time

pytestmark = pytest.mark.serial


@pytest.mark.parametrize(
    ("cells", "words"),
    [
        (500, "less than a minute"),
        (3000, "some 1 to 5 minutes"),
        (20_000, "some 7 to 30 minutes"),
        (400_000, "some 2 to 10 hours"),
    ],
)
def test_the_time_in_words(cells, words):
    assert first_run_time(cells) == words
