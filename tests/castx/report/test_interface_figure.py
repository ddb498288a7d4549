"""The curve of an interface over its gap: lines, the band of its ranges, files of each kind."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from castx.errors import CaseError
from castx.report.interface_figure import GAPS, band, curve, write_interface_figure
from castx.transfer.database import interface_entry, interface_names

pytestmark = pytest.mark.serial


@pytest.mark.parametrize("name", interface_names())
def test_the_band_holds_the_curve(name):
    entry = interface_entry(name)
    low, high = band(entry)
    at_hundred = curve(entry.heat, 100.0)
    assert at_hundred.shape == GAPS.shape and (low > 0.0).all()
    assert (low <= at_hundred).all() and (at_hundred <= high).all() and (low < high).any()


def test_the_band_is_that_of_the_ends_of_the_ranges():
    low, high = band(interface_entry("aluminium-steel-coated"))
    np.testing.assert_allclose(low, 1.0 / (1.0 / 500.0 + GAPS / 0.024))
    np.testing.assert_allclose(high, 1.0 / (1.0 / 3000.0 + GAPS / 0.085))
    low, high = band(interface_entry("aluminium-steel-coating-layer"))
    thick = 0.5 * np.hypot(1e-4, 1e-4) / 0.024 + 500e-6 / 0.2
    np.testing.assert_allclose(low, 1.0 / (thick + GAPS / 0.024))
    thin = 0.5 * np.hypot(1e-5, 2.5e-5) / 0.085 + 20e-6 / 0.5
    np.testing.assert_allclose(high, 1.0 / (thin + GAPS / 0.085))


def test_the_curve_is_the_law():
    np.testing.assert_allclose(
        curve(interface_entry("steel-sand").heat, 900.0), 1.0 / (1e-3 + GAPS / 0.0764)
    )


@pytest.mark.parametrize(
    ("ending", "start"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")]
)
def test_files(tmp_path, ending, start):
    path = tmp_path / f"a.{ending}"
    write_interface_figure("steel-sand", path)
    assert path.read_bytes().startswith(start)


def test_refusals(tmp_path):
    with pytest.raises(CaseError, match=r"cannot draw .*a.bmp: the name must end in .png"):
        write_interface_figure("steel-sand", tmp_path / "a.bmp")
    with pytest.raises(CaseError, match=r"cannot write /nowhere/a.png"):
        write_interface_figure("steel-sand", Path("/nowhere/a.png"))
    with pytest.raises(CaseError, match="unknown interface 'steel'"):
        write_interface_figure("steel", tmp_path / "a.png")
