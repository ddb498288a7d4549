import base64
import io
import re

import numpy as np
import pytest
from PIL import Image

from castx.command.run import run
from castx.proof.validation.experiment import read_experiment
from castx.proof.validation.page import write_page
from castx.results.reading import Results
from tests.castx.proof.validation.synthetic import DISTURBANCE, write_experiment

pytestmark = pytest.mark.serial


@pytest.fixture(scope="module")
def shown(tmp_path_factory):
    root = tmp_path_factory.mktemp("validation")
    experiment = read_experiment(write_experiment(root / "lumped"))
    folder = run(experiment.folder / "case.toml", output=root / "results")
    made = write_page(folder, experiment, Results(folder))
    return made, (folder / "validation.html").read_text()


def test_differences_are_those_that_were_put_in(shown):
    (overlay,), _ = shown
    apart = overlay.deviation
    rms = np.sqrt(np.mean(DISTURBANCE**2))
    # Implicit Euler steps of 0.1 s are 0.5 K off at most.
    assert apart.root_mean_square == pytest.approx(rms, abs=0.2)
    assert apart.largest == pytest.approx(3.0, abs=0.5) and apart.at == pytest.approx(12.0)
    assert apart.points == len(DISTURBANCE)
    within = np.count_nonzero(np.abs(DISTURBANCE) < 2.5) / len(DISTURBANCE)
    assert overlay.within == pytest.approx(within, abs=0.06)
    assert (overlay.unit, overlay.uncertainty_text) == ("K", "± 2.5 K")


def test_the_page_has_curve_numbers_and_source(shown):
    (overlay,), text = shown
    for part in ("A lumped body cools", "synthetic", "computed by hand", "± 2.5 K", "600 °C"):
        assert part in text
    assert f"{overlay.deviation.root_mean_square:.3g} K" in text
    (png,) = re.findall(r"data:image/png;base64,([^\"]+)", text)
    pixels = np.asarray(Image.open(io.BytesIO(base64.b64decode(png))).convert("RGB"))
    assert np.ptp(pixels) > 100
    assert not re.search(r'(src|href)="(?!data:|#)', text), "nothing is loaded from elsewhere"
