"""The launcher: what a batch system leaves out, and what it asks bubblewrap for."""

from __future__ import annotations

import hashlib
import json
import os
import platform
import pty
import pwd
import re
import shlex
import signal
import subprocess
import sys
import tempfile
from itertools import pairwise
from pathlib import Path

import pytest

pytestmark = pytest.mark.serial

PROJECT = Path(__file__).parents[1]
LAUNCHER = PROJECT / "bin/with-fenicsx"

BWRAP = """#!/bin/sh
# Stands for bubblewrap: shows its arguments, and what the command would get.
[ "$1" = --info-fd ] || exit 0
echo '{"child-pid": 1}' >&4
printf 'argument %s\\n' "$@"
echo "TMPDIR ${TMPDIR-none} HOME ${HOME-none}"
echo "input $(cat)"
"""


FORWARDING = """#!{python}
# Stands for bubblewrap: its child is the command, which ends at a signal.
import os, signal, sys
if sys.argv[1] != "--info-fd":
    sys.exit()
names = sys.argv[sys.argv.index("env") + 1].removeprefix("--default-signal=").split(",")
with open(4, "w") as info:
    info.write('{{"child-pid": %d}}' % os.getpid())
if (command := os.fork()) == 0:
    for name in names:
        signal.signal(getattr(signal, "SIG" + name), lambda number, frame: os._exit(number))
    print("ready", flush=True)
    while True:
        signal.pause()
sys.exit(os.waitstatus_to_exitcode(os.waitpid(command, 0)[1]))
"""


@pytest.fixture
def debian(tmp_path):
    """Return the environment of a machine whose Debian 13 is there, and whose bwrap is a stub."""
    recipe = b"".join(
        (PROJECT / "bin" / name).read_bytes()
        for name in ("build-root", "debian-packages.txt", "dpkg-excludes.conf")
    )
    digest = hashlib.sha256(recipe).hexdigest()[:12]
    (tmp_path / "cache" / "castx" / f"debian-13-{platform.machine()}-{digest}").mkdir(parents=True)
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "bwrap").write_text(BWRAP)
    (tmp_path / "bin" / "bwrap").chmod(0o755)
    return {
        "PATH": f"{tmp_path / 'bin'}:/usr/bin:/bin",
        "HOME": str(tmp_path),
        "XDG_CACHE_HOME": str(tmp_path / "cache"),
        "CASTX_FENICSX": "debian",
    }


def launch(environment, redirection="", cwd=PROJECT):
    """Start `castx info` from a shell with redirections."""
    line = f"exec {shlex.quote(str(LAUNCHER))} castx info {redirection}"
    with tempfile.TemporaryFile() as typed:  # no pipe, whose reader may leave
        typed.write(b"typed")
        typed.seek(0)
        return subprocess.run(
            ["sh", "-c", line], env=environment, cwd=cwd, capture_output=True, text=True,
            timeout=60, stdin=typed, check=False,
        )  # fmt: skip


def which(environment, **more):
    """Return what the launcher says of its road, and its status."""
    ended = subprocess.run(
        [LAUNCHER, "--which"], env=environment | more, capture_output=True, text=True, timeout=60,
        check=False,
    )  # fmt: skip
    return ended.stdout + ended.stderr, ended.returncode


@pytest.mark.parametrize("road", ["native", "debian", "pip"])
def test_the_road_that_is_asked_for_is_taken(debian, road):
    assert which(debian, CASTX_FENICSX=road) == (f"{road}: CASTX_FENICSX={road}\n", 0)


def test_an_unknown_road_is_refused(debian):
    said, status = which(debian, CASTX_FENICSX="conda")
    assert status == 125
    assert "CASTX_FENICSX=conda is no road to FEniCSx: native, debian or pip" in said


@pytest.fixture
def without_dolfinx(debian):
    """A machine as above on which nobody asked for a road, and whose python3 has no DOLFINx."""
    del debian["CASTX_FENICSX"]
    program = Path(debian["HOME"]) / "bin" / "python3"
    program.write_text("#!/bin/sh\nexit 1\n")
    program.chmod(0o755)
    return debian


def test_the_debian_that_is_built_goes_before_all_others(without_dolfinx):
    said, status = which(without_dolfinx)
    assert said.startswith("debian: it is built in ") and status == 0


def test_a_python_with_dolfinx_goes_before_a_debian_that_is_not_built(without_dolfinx):
    next(Path(without_dolfinx["XDG_CACHE_HOME"]).glob("castx/debian-13-*")).rmdir()
    said, _ = which(without_dolfinx)
    assert "DOLFINx 0.9 or newer" in said
    (Path(without_dolfinx["HOME"]) / "bin" / "python3").write_text("#!/bin/sh\nexit 0\n")
    said, _ = which(without_dolfinx)
    assert said.startswith("native: ") and "has DOLFINx" in said


def test_wheels_serve_where_no_debian_can_be_built(without_dolfinx):
    """Wheels that are there are taken; they are no reason to leave a Debian 13 that is built."""
    cache = Path(without_dolfinx["XDG_CACHE_HOME"]) / "castx"
    wheels = cache / wheels_folder(without_dolfinx)
    wheels.mkdir()
    (wheels / "complete").touch()
    assert which(without_dolfinx)[0].startswith("debian: it is built")
    next(cache.glob("debian-13-*")).rmdir()
    said, status = which(without_dolfinx)
    assert said == f"pip: the wheels of PyPI are installed in {wheels}\n" and status == 0


def wheels_folder(environment):
    """Return the name of the folder that the launcher looks into."""
    ended = subprocess.run(
        ["sh", "-x", LAUNCHER, "--which"], env=environment, capture_output=True, text=True,
        timeout=60, check=False,
    )  # fmt: skip
    return re.findall(r"^\+ wheels=.*/(wheels-\S+)$", ended.stderr, re.M)[0]


def test_the_command_gets_streams_and_folders(debian):
    ended = launch(debian)
    assert ended.returncode == 0, ended.stderr
    lines = ended.stdout.splitlines()
    assert lines[-1] == "input typed" and lines[-2] == f"TMPDIR none HOME {debian['HOME']}"
    arguments = [line.removeprefix("argument ") for line in lines]
    assert arguments[-5:-2] == [str(LAUNCHER), "castx", "info"]


def test_a_closed_input_is_an_empty_one(debian):
    ended = launch(debian, "<&-")
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.endswith("input \n")


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGUSR1])
def test_signals_reach_the_command(debian, tmp_path, number):
    (tmp_path / "bin" / "bwrap").write_text(FORWARDING.format(python=sys.executable))
    with subprocess.Popen(
        [LAUNCHER, "castx", "info"], env=debian, stdout=subprocess.PIPE, text=True
    ) as started:
        assert started.stdout is not None and started.stdout.readline() == "ready\n"
        started.send_signal(number)
        assert started.wait(30) == number


WAITING = """
trap 'handled=$(sleep 0.4; echo late)' USR1
sh -c "sleep 0.1; kill -USR1 $$; sleep 0.1; exit 9" &
wait_for $!
"""


def test_a_command_that_ends_while_a_signal_is_handled_keeps_its_status(tmp_path):
    """The shell takes note of the end of the command inside its trap."""
    function = re.findall(r"^wait_for\(\) \{.*?^\}", LAUNCHER.read_text(), re.M | re.S)
    (tmp_path / "waiting").write_text(function[0] + WAITING)
    assert subprocess.run(["sh", tmp_path / "waiting"], timeout=60, check=False).returncode == 9


@pytest.mark.parametrize(
    ("free", "chosen"),
    [
        ({"/tmp": 9, "/var/tmp": 9}, "/tmp"),
        ({"/tmp": 2, "/var/tmp": 9}, "/var/tmp"),
        ({"/tmp": 2, "/var/tmp": 2}, ""),
    ],
)
def test_a_debian_is_unpacked_where_there_is_room(tmp_path, free, chosen):
    """On Debian 13 /tmp lies in memory, and may be smaller than what is unpacked."""
    functions = re.findall(
        r"^free_space\(\) \{.*?\}$|^folder_to_unpack\(\) \{.*?^\}",
        LAUNCHER.read_text(),
        re.M | re.S,
    )
    lines = [f'case $2 in {folder}) echo "d 0 0 {gigabytes}000000 0% /" ;; esac'
             for folder, gigabytes in free.items()]  # fmt: skip
    (tmp_path / "df").write_text("\n".join(["#!/bin/sh", "echo header", *lines]))
    (tmp_path / "df").chmod(0o755)
    ended = subprocess.run(
        ["sh", "-c", "\n".join([*functions, "folder_to_unpack"])],
        env={"PATH": f"{tmp_path}:/usr/bin:/bin"}, capture_output=True, text=True, timeout=60,
        check=False,
    )  # fmt: skip
    assert (ended.stdout.strip(), ended.returncode) == (chosen, 0)


@pytest.mark.parametrize("redirection", [">&-", "2>&-", "<&- >&- 2>&-"])
def test_closed_outputs_lose_only_what_is_written(debian, redirection):
    assert launch(debian, redirection).returncode == 0


@pytest.mark.parametrize("folder", ["/nowhere/at/all", "/etc/passwd"])
def test_temporary_files_go_elsewhere_when_their_folder_is_missing(debian, folder):
    ended = launch(debian | {"TMPDIR": folder})
    assert ended.returncode == 0
    assert f"castx: TMPDIR={folder} is no folder to write to; /tmp is used" in ended.stderr
    assert "TMPDIR none" in ended.stdout


def test_without_home_the_one_of_the_user_counts(debian):
    del debian["HOME"]
    ended = launch(debian)
    assert ended.returncode == 0
    assert f"HOME {pwd.getpwuid(os.getuid()).pw_dir}" in ended.stdout


def test_without_any_place_for_a_cache_it_is_not_started(debian, tmp_path):
    """A user whom nobody knows, without HOME."""
    del debian["HOME"], debian["XDG_CACHE_HOME"]
    (tmp_path / "bin" / "getent").write_text("#!/bin/sh\nexit 2\n")
    (tmp_path / "bin" / "getent").chmod(0o755)
    ended = launch(debian)
    assert ended.returncode == 125
    assert "castx: neither HOME nor XDG_CACHE_HOME is set" in ended.stderr


def test_a_shell_finds_castx_after_its_own_start_up_file(tmp_path):
    """Such a file puts the Python of pyenv or conda in front of all others."""
    for name in ("python3", "there"):
        (tmp_path / name).write_text("#!/bin/sh\necho strange\n")
        (tmp_path / name).chmod(0o755)
    (tmp_path / ".bashrc").write_text(f"PATH={tmp_path}:$PATH\nHERE=read\n")
    cache = os.environ.get("XDG_CACHE_HOME", str(Path.home() / ".cache"))
    environment = {**os.environ, "HOME": str(tmp_path), "XDG_CACHE_HOME": cache}
    environment.pop("CASTX_CHECKOUT", None)
    typed, terminal = pty.openpty()
    os.write(typed, b'python3 -c "import castx; print(castx.__name__)"; echo $HERE; there; exit\n')
    said = subprocess.run(
        [LAUNCHER, "bash"], stdin=terminal, stderr=terminal, stdout=subprocess.PIPE, text=True,
        env=environment, timeout=60, check=True,
    ).stdout  # fmt: skip
    os.close(typed)
    os.close(terminal)
    assert said.split() == ["castx", "read", "strange"]


@pytest.mark.skipif(os.getuid() != 0, reason="only root has rights to give up")
def test_root_gives_up_what_is_not_needed(debian):
    arguments = [line.removeprefix("argument ") for line in launch(debian).stdout.splitlines()]
    kept = {b for a, b in pairwise(arguments) if a == "--cap-add"}
    dropped = [b for a, b in pairwise(arguments) if a == "--cap-drop"]
    assert dropped == ["ALL"]
    assert kept == {"CAP_DAC_OVERRIDE", "CAP_FOWNER", "CAP_SYS_PTRACE"}


@pytest.mark.parametrize(
    "command", [["-m", "castx", "--help"], ["-c", "import castx; castx.load_case; print('metal')"]]
)
def test_a_checkout_called_castx_does_not_hide_the_package(tmp_path, command):
    """Seen from above it is a folder of that name without __init__.py."""
    (tmp_path / "castx" / "castx").mkdir(parents=True)
    ended = subprocess.run(
        [sys.executable, *command], cwd=tmp_path, capture_output=True, text=True, timeout=60,
        check=False,
    )  # fmt: skip
    assert ended.returncode == 0, ended.stderr
    assert "metal" in ended.stdout


SINGLE = {
    "OMPI_MCA_btl": "self,sm",
    "PRTE_MCA_plm": "^slurm",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
}


@pytest.mark.parametrize(
    ("batch", "hosts", "alone"),
    [
        ({}, "", True),
        ({"SLURM_JOB_NUM_NODES": "1"}, "", True),
        ({"SLURM_JOB_NUM_NODES": "2"}, "", False),
        ({"PBS_NODEFILE": "{hosts}"}, "a\na\n", True),
        ({"PBS_NODEFILE": "{hosts}"}, "a\na\nb\nb\n", False),
        ({"PE_HOSTFILE": "{hosts}"}, "a 2 all.q\nb 2 all.q\n", False),
        ({"LSB_DJOB_HOSTFILE": "/no/such/file"}, "", True),
    ],
)
def test_mpi_stays_on_a_single_machine_only_where_there_is_one(batch, hosts, alone, tmp_path):
    (tmp_path / "hosts").write_text(hosts)
    set_by_it = (*SINGLE, "CASTX_CHECKOUT", "OMP_NUM_THREADS")
    environment = {key: value for key, value in os.environ.items() if key not in set_by_it}
    environment |= {key: value.format(hosts=tmp_path / "hosts") for key, value in batch.items()}
    ended = subprocess.run(
        [LAUNCHER, "env"], env=environment, capture_output=True, text=True, timeout=60, check=True
    )
    found = dict(line.split("=", 1) for line in ended.stdout.splitlines() if "=" in line)
    assert {key: found[key] for key in SINGLE if key in found} == (SINGLE if alone else {})
    assert found["OMP_NUM_THREADS"] == "1"


JUPYTER = """#!/bin/sh
echo "lab in $(dirname "$0"): $*"
echo "kernels in $JUPYTER_PATH"
"""


@pytest.fixture
def notebooks(tmp_path):
    """Return an environment with a cache of its own that has the virtual environment of castx."""
    cache = tmp_path / "cache" / "castx"
    cache.mkdir(parents=True)
    venv = Path(os.environ["VIRTUAL_ENV"])
    (cache / venv.name).symlink_to(venv)
    unset = ("CASTX_CHECKOUT", "PATH")
    environment = {key: value for key, value in os.environ.items() if key not in unset}
    path = os.environ["PATH"].split(os.pathsep)
    elsewhere = [folder for folder in path if not (Path(folder) / "jupyter").exists()]
    return environment | {"XDG_CACHE_HOME": str(tmp_path / "cache"), "PIP_NO_INDEX": "1",
                          "PATH": os.pathsep.join(elsewhere)}  # fmt: skip


def jupyter(environment, *arguments):
    """Start jupyter by the launcher."""
    return subprocess.run(
        [LAUNCHER, "jupyter", *arguments], env=environment, capture_output=True, text=True,
        timeout=60, check=False,
    )  # fmt: skip


def test_jupyter_that_cannot_be_installed_is_said_with_the_cure(notebooks):
    ended = jupyter(notebooks, "lab")
    assert ended.returncode == 125
    assert "castx: installing JupyterLab of PyPI in " in ended.stderr
    assert "No matching distribution found for jupyterlab" in ended.stderr
    folder = re.findall(r"By hand: python3 -m venv (\S+/cache/castx/jupyter-\w+);", ended.stderr)
    assert folder and not (Path(folder[0]) / "complete").exists()


def test_jupyter_stands_beside_castx_and_has_its_kernel(notebooks):
    said = jupyter(notebooks).stderr
    folder = Path(re.findall(r"By hand: python3 -m venv ([^\s;]+);", said)[0])
    (folder / "bin" / "jupyter").write_text(JUPYTER)
    (folder / "bin" / "jupyter").chmod(0o755)
    (folder / "complete").touch()
    ended = jupyter(notebooks, "lab", "--no-browser")
    assert ended.returncode == 0 and not ended.stderr
    lab, kernels = ended.stdout.splitlines()
    assert lab == f"lab in {folder / 'bin'}: lab --no-browser"
    found = Path(kernels.removeprefix("kernels in ").partition(":")[0])
    kernel = json.loads((found / "kernels" / "python3" / "kernel.json").read_text())
    assert Path(kernel["argv"][0]).parent.parent.name == Path(os.environ["VIRTUAL_ENV"]).name
