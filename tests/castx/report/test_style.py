"""The style of figures."""

import matplotlib as mpl
import matplotlib.image
import pytest

from castx.report.style import COLOURS, figure

pytestmark = pytest.mark.serial


def test_a_figure_has_the_size_and_the_colours_of_the_report():
    before = mpl.rcParams["legend.frameon"]
    with figure(4.0, 2.0) as (canvas, stream):
        axis = canvas.subplots()
        (line,) = axis.plot([0, 1], [0, 1])
        canvas.savefig(stream, dpi=50)
        assert line.get_color() == COLOURS[0] and not mpl.rcParams["legend.frameon"]
    stream.seek(0)
    assert matplotlib.image.imread(stream).shape[:2] == (100, 200)
    assert mpl.rcParams["legend.frameon"] == before
