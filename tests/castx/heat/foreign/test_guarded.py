"""A reader that crashes, hangs or is killed gives words, and its process is no rank of a run."""

import os
import signal
from pathlib import Path

import meshio
import numpy as np
import pytest

from castx.errors import CaseError
from castx.heat.foreign import guarded
from castx.heat.foreign.guarded import interpolated

pytestmark = pytest.mark.serial

POINT = np.array([[0.25, 0.25]])


@pytest.fixture
def file(tmp_path):
    points = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    mesh = meshio.Mesh(points, [("triangle", [[0, 1, 2]])], {"T": np.array([1.0, 2.0, 3.0])})
    mesh.write(tmp_path / "a.vtu")
    return tmp_path / "a.vtu"


def test_values_are_those_of_the_file(file):
    found = interpolated(file, "T", POINT)
    np.testing.assert_allclose(found.values, 1.75)
    np.testing.assert_allclose(found.distances, 0.0, atol=1e-12)
    np.testing.assert_allclose(found.sizes, np.sqrt(2.0))


def stub(monkeypatch, tmp_path: Path, code: str) -> None:
    """Let another program stand for the reader."""
    (tmp_path / "child.py").write_text(f"import os, sys, time\n{code}\n")
    monkeypatch.setattr(guarded, "__file__", str(tmp_path / "guarded.py"))


@pytest.mark.parametrize(
    ("code", "words"),
    [
        ("os.abort()", r"its reader ended by SIGABRT \(no word\); it is damaged, or needs more"),
        ("os.kill(os.getpid(), 11)", "its reader ended by SIGSEGV"),
        ("sys.exit('bad \\x1b[31m file')", r"with exit code 1 \(bad \\x1b\[31m file\)"),
        ("print(': no', end='', flush=True); os._exit(3)", "a.vtu: no$"),
        ("print('x' * 9999, end='', flush=True); os._exit(3)", r"a.vtux{300} \.\.\.$"),
        ("time.sleep(60)", "it took more than 1 s"),
    ],
)
def test_any_end_of_the_reader_is_a_refusal(file, monkeypatch, tmp_path, code, words):
    stub(monkeypatch, tmp_path, code)
    monkeypatch.setattr(guarded, "PATIENCE", 1.0)
    with pytest.raises(CaseError, match=words):
        interpolated(file, "T", POINT)


def test_a_reader_that_dies_before_it_has_read_all_ends_nothing_else(file, monkeypatch, tmp_path):
    """Broken pipes end a process in which PETSc is loaded."""
    stub(monkeypatch, tmp_path, "os.abort()")
    before = signal.signal(signal.SIGPIPE, lambda *_: pytest.fail("a broken pipe"))
    try:
        with pytest.raises(CaseError, match="SIGABRT"):
            interpolated(file, "T", np.zeros((100_000, 2)))
    finally:
        signal.signal(signal.SIGPIPE, before)


def test_an_answer_with_python_objects_is_not_read(file, monkeypatch, tmp_path):
    """To unpickle one would run what a reader that is no longer itself has written."""
    code = (
        "import io, sys, numpy; found = io.BytesIO(); "
        "numpy.savez(found, values=numpy.array([{}], dtype=object)); "
        "sys.stdout.buffer.write(found.getvalue())"
    )
    stub(monkeypatch, tmp_path, code)
    with pytest.raises(ValueError, match="allow_pickle=False"):
        interpolated(file, "T", POINT)


def test_the_reader_is_no_rank(file, monkeypatch, tmp_path):
    monkeypatch.setitem(os.environ, "PMIX_RANK", "0")
    monkeypatch.setitem(os.environ, "OMPI_COMM_WORLD_SIZE", "2")
    stub(monkeypatch, tmp_path, "print(': ', *sorted(os.environ), flush=True); os._exit(3)")
    with pytest.raises(CaseError) as refusal:
        interpolated(file, "T", POINT)
    assert "OPENBLAS_NUM_THREADS" in str(refusal.value) or "..." in str(refusal.value)
    assert "PMIX" not in str(refusal.value) and "OMPI_" not in str(refusal.value)


def test_a_missing_field_names_those_that_are_there(file):
    with pytest.raises(CaseError, match=r"a.vtu: no field 'temperature'; it has: T"):
        interpolated(file, "temperature", POINT)
