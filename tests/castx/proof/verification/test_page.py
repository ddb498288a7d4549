import base64
import io
import re

import numpy as np
import pytest
from PIL import Image

from castx.proof.verification.page import PAGE, error_text, write_page
from castx.proof.verification.verdict import verified
from castx.proof.verification.verification import Answer
from tests.castx.proof.verification.test_verdict import made

pytestmark = pytest.mark.serial


def page(comm, folder, *verifications):
    verdicts = [verified(verification, comm) for verification in verifications]
    return write_page(folder / "new", verdicts, quick=False, ranks=1).read_text()


def test_the_page_has_numbers_picture_and_verdict(comm, tmp_path):
    text = page(comm, tmp_path, made())
    assert (tmp_path / "new" / PAGE).is_file()
    for part in ("V98", "made up", "y = x", "here", "2.00", "1.01 m", "all 1 within", "1 %", "2 %"):
        assert part in text
    assert "missed<" not in text
    (picture,) = re.findall(r"data:image/webp;base64,([^\"]+)", text)
    pixels = np.asarray(Image.open(io.BytesIO(base64.b64decode(picture))).convert("RGB"))
    assert pixels.shape[1] > 500 and np.ptp(pixels) > 100
    assert not re.search(r'(src|href)="(?!data:|#)', text), "nothing is loaded from elsewhere"


def test_what_is_missed_is_said_at_the_top(comm, tmp_path):
    text = page(comm, tmp_path, made(tolerance=1e-3), made(fails_below=1.0))
    assert "missed: V98, V98" in text and "no solution" in text
    assert page(comm, tmp_path, made(order=0.5, tolerance=9)).count("does not fall") == 1


def test_errors_are_shares_or_have_the_unit_of_what_differs():
    assert error_text(0.0123, Answer.relative("p", 1, 1, "Pa", 0.1)) == "1.2 %"
    assert error_text(1.25, Answer.difference("T", 1, "K", 2)) == "1.2 K"
    assert error_text(0.05, Answer.difference("σ", 1, "Pa", 2, 4e7)) == "5 %"
