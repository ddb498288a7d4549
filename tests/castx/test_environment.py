"""The start-up check and the versions that go into the record of a run."""

from __future__ import annotations

import pytest

import castx
from castx import environment
from castx.commit import commit

pytestmark = pytest.mark.serial


def test_versions_name_castx_and_what_it_stands_on(monkeypatch):
    packages = {"numpy": "numpy", "no-such-package": "no_such_module"}
    monkeypatch.setattr(environment, "PACKAGES", packages)
    found = environment.versions()
    assert found["castx"] == castx.__version__
    assert found["commit"] == commit()
    assert found["numpy"].count(".") >= 1
    assert found["no-such-package"] == "missing"


def test_a_module_that_another_package_brings_says_its_version_itself(monkeypatch):
    """The wheels of PyPI bring DOLFINx and petsc4py in a package of another name."""
    monkeypatch.setattr(environment, "PACKAGES", {"no-such-package": "castx"})
    assert environment.versions()["no-such-package"] == castx.__version__


def test_every_package_of_the_record_is_known():
    assert "missing" not in environment.versions().values()


def test_this_environment_has_a_fast_blas():
    assert environment.blas_warning(environment.blas_advantage()) is None


def test_slow_blas_is_reported_with_its_cure():
    assert "libopenblas0-pthread" in (environment.blas_warning(0.9) or "")
