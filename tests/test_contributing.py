"""The examples of CONTRIBUTING.md: as files of the library they pass the tests of all entries."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from bench.mutation import copy_of_checkout, environment

pytestmark = pytest.mark.serial

PROJECT = Path(__file__).parents[1]
EXAMPLES = re.findall(r"```python\n(.*?)```", (PROJECT / "CONTRIBUTING.md").read_text(), re.S)
DECLARED = re.compile(r"^[A-Z]+ = (\w+)\(\n    (?:name=\"([\w-]+)\"|mesh=(\w+)),$", re.M)
FOLDERS = {
    "GapHeatLaw": "castx/transfer/laws",
    "HeatConditionKind": "castx/transfer/conditions",
    "ContactMethod": "castx/contact/methods",
    "FlowRule": "castx/materials/flow_rules",
    "HardeningRule": "castx/materials/hardening",
    "Generator": "meshes/generators",
}
"""Where the files of each kind of declaration stand."""

OVER_ALL = (
    "tests/castx/transfer/test_registry.py",
    "tests/castx/transfer/test_keys.py",
    "tests/castx/transfer/conditions/test_registry.py",
    "tests/castx/contact/methods/test_registry.py",
    "tests/castx/contact/methods/test_pair_laws.py",
    "tests/castx/materials/test_inelastic.py",
    "tests/castx/materials/rules/test_flow_rule.py",
    "tests/castx/materials/rules/test_hardening_rule.py",
    "tests/castx/mechanics/constitutive/test_return_mapping.py",
    "tests/castx/heat/test_boundaries.py",
    "tests/meshes/test_generators.py",
    "tests/test_docs.py",
)
"""Tests that hold for all entries of a registry."""

RUN = """
import sys, pytest
from docs.generator.tables import write_tables
write_tables()
sys.exit(pytest.main(sys.argv[1:]))
"""


def places() -> dict[str, str]:
    """Return the examples by the path that each has; a test stands behind what it tests."""
    found: dict[str, str] = {}
    file = ""
    for example in EXAMPLES:
        declared = DECLARED.search(example)
        if declared is not None:
            name = (declared[2] or declared[3]).replace("-", "_")
            file = f"{FOLDERS[declared[1]]}/{name}.py"
            found[file] = example
        elif "pytestmark = " in example:
            folder, _, name = file.rpartition("/")
            found[f"tests/{folder}/test_{name}"] = example
        else:  # output fields have a test of their example beside their registry
            assert "\nFIELDS = (" in example, f"no test knows the example:\n{example}"
    return found


def test_there_is_an_example_of_each_kind():
    folders = {path.rpartition("/")[0] for path in places() if not path.startswith("tests/")}
    assert folders == set(FOLDERS.values()) - {FOLDERS["HardeningRule"]}
    assert "tests/castx/materials/flow_rules/test_eyring.py" in places()


def test_examples_pass_the_tests_over_all_entries(tmp_path):
    """In a copy of the checkout with the tables of the manual written anew."""
    copy = copy_of_checkout(tmp_path)
    examples = places()
    for path, text in examples.items():
        assert not (copy / path).exists(), f"{path} is there already: rename the example"
        (copy / path).write_text(text)
    names = [Path(path).stem for path in examples]
    chosen = " or ".join({*names, *(name.replace("_", "-") for name in names), "every_file"})
    own = [path for path in examples if path.startswith("tests/")]
    options = ["-v", "-p", "no:cacheprovider", "-k", f"{chosen} or tables"]
    run = subprocess.run(
        [sys.executable, "-c", RUN, *options, *OVER_ALL, *own],
        cwd=copy, env=environment(copy), capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert run.returncode == 0, run.stdout[-20_000:] + run.stderr[-5_000:]
    passed = [line for line in run.stdout.splitlines() if " PASSED" in line]
    for name in (Path(path).stem.removeprefix("test_") for path in examples):
        known = [line for line in passed if name in line.replace("-", "_").partition("::")[2]]
        assert len(known) >= 3, f"few tests over all entries ran with {name}:\n{run.stdout}"
