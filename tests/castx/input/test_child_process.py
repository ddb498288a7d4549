"""A child process is no rank, ends in time, and its end is told in one line."""

import json
import signal
import subprocess
from tempfile import TemporaryFile

import pytest

from castx.input.child_process import SHOWN, end_of, run_apart, shortened

pytestmark = pytest.mark.serial

ENVIRONMENT = "import json, os; print(json.dumps(dict(os.environ)))"
BOTH = "import os; os.write(1, b'answer'); os.write(2, b'word'); os._exit(3)"


def test_it_is_no_rank_and_has_one_thread(monkeypatch):
    monkeypatch.setenv("OMPI_COMM_WORLD_SIZE", "2")
    monkeypatch.setenv("PMIX_RANK", "1")
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "8")
    monkeypatch.setenv("KEPT", "as it is")
    found = json.loads(run_apart(["-c", ENVIRONMENT], 60.0).stdout)
    assert not [name for name in found if name.startswith(("OMPI_", "PMIX_"))]
    assert (found["OPENBLAS_NUM_THREADS"], found["KEPT"]) == ("1", "as it is")


def test_it_reads_a_file_or_nothing():
    echo = "import sys; sys.stdout.write(sys.stdin.read())"
    with TemporaryFile() as file:
        file.write(b"given")
        file.seek(0)
        assert run_apart(["-c", echo], 60.0, given=file).stdout == b"given"
    assert run_apart(["-c", echo], 60.0).stdout == b""


def test_its_errors_stand_apart_or_among_its_output():
    apart, together = (
        run_apart(["-c", BOTH], 60.0, errors=errors)
        for errors in (subprocess.PIPE, subprocess.STDOUT)
    )
    assert (apart.returncode, apart.stdout, apart.stderr) == (3, b"answer", b"word")
    assert (together.stdout, together.stderr) == (b"answerword", None)


def test_it_is_killed_when_it_takes_too_long():
    with pytest.raises(subprocess.TimeoutExpired):
        run_apart(["-c", "import time; time.sleep(60)"], 0.3)


@pytest.mark.parametrize(
    "code, said, text",
    [
        (1, b"first\n last \n\n", "its reader ended with exit code 1 ( last )"),
        (-signal.SIGSEGV, b"", "its reader ended by SIGSEGV (no word)"),
        (2, b"\x1b[31m red \xff", "its reader ended with exit code 2 (\\x1b[31m red \ufffd)"),
    ],
)
def test_the_end_in_words(code, said, text):
    assert end_of("reader", code, said) == text


def test_long_words_are_cut():
    assert shortened("a\nb") == "a b"
    assert shortened("x" * SHOWN) == "x" * SHOWN
    assert shortened("x" * (SHOWN + 1)) == "x" * SHOWN + " ..."
