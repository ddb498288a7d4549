"""A page needs no network, its scripts are well-formed, and no text breaks out of its data."""

import json
import re

import pytest

from castx.report.page.assets import CURVES_ONLY, SCRIPTS, data, text, uplot
from tests.castx.app.browser import evaluated

pytestmark = pytest.mark.serial


def test_no_text_ends_the_element_of_the_data():
    hostile = {"</script><script>alert(1)</script>": "<!-- & \u2028 ]]>"}
    found = str(data(hostile))
    assert not set("<>&\u2028") & set(found)
    assert json.loads(found) == hostile


def test_the_library_has_its_licence_and_no_address():
    assert "MIT License" in text("vendor/uPlot.LICENSE") and "Leon Sorokin" in text(
        "vendor/uPlot.LICENSE"
    )
    library = uplot()
    assert library.startswith("/*! leeoniya/uPlot") and not re.search(r"https?:", library)
    assert len(library) > 40_000


@pytest.mark.parametrize("name", SCRIPTS)
def test_scripts_end_no_element_of_the_page(name):
    assert "</script" not in text(f"scripts/{name}.js").lower()


def test_scripts_are_well_formed(tmp_path):
    scripts = {name: text(f"scripts/{name}.js") for name in SCRIPTS} | {"malformed": "let ="}
    malformed = evaluated(
        f"""const malformed = [];
        for (const [name, script] of Object.entries({json.dumps(scripts)})) {{
          try {{ new Function(script); }} catch (error) {{ malformed.push(name); }}
        }}
        return malformed;""",
        tmp_path,
    )
    assert malformed == ["malformed"]


def test_a_page_without_a_view_has_the_scripts_of_its_curves():
    assert set(CURVES_ONLY) < set(SCRIPTS)


CUTS = """
const cube = {
  kind: "hexahedron", cells: Uint16Array.from([0, 1, 2, 3, 4, 5, 6, 7]),
  points: Float64Array.from([0,0,0, 1,0,0, 1,1,0, 0,1,0, 0,0,1, 1,0,1, 1,1,1, 0,1,1]),
};
cube.shape = castx.geometry.shape(cube);
const area = ({ triangles: v, nodes }, body = cube) => {
  const points = nodes.values(body.points, 3);
  const at = (i) => [0, 1, 2].map((k) => {
    const [p, q] = [points[3 * v.a[i] + k], points[3 * v.b[i] + k]];
    return p + v.t[i] * (q - p);
  });
  let sum = 0;
  for (let i = 0; i < v.length; i += 3) {
    const [p, q, r] = [at(i), at(i + 1), at(i + 2)];
    const side = (s) => s.map((x, k) => x - p[k]);
    sum += 0.5 * Math.hypot(...castx.geometry.cross(side(q), side(r)));
  }
  return sum;
};
const cut = (plane, sunk) => area(castx.geometry.drawn(cube, plane, sunk));
const third = 1 / Math.sqrt(3), height = Float32Array.from([0, 0, 0, 0, 1, 1, 1, 1]);
const sunk = { values: height, level: 0.25 }, half = { normal: [1, 0, 0], offset: 0.5 };
const faces = [[0,3,2], [0,2,1], [4,5,6], [4,6,7], [0,1,5], [0,5,4], [1,2,6], [1,6,5], [2,3,7],
  [2,7,6], [3,0,4], [3,4,7]];
const shell = { kind: "triangle", cells: Uint16Array.from(faces.flat()), points: cube.points,
  inner: Uint16Array.from([0,1,2,6, 0,2,3,6, 0,3,7,6, 0,7,4,6, 0,4,5,6, 0,5,1,6]) };
shell.shape = castx.geometry.shape(shell);
const ofShell = (plane) => area(castx.geometry.drawn(shell, plane, sunk), shell);
const { segments } = castx.geometry.drawn(cube, null, sunk);
return [
  cut(null), cut({ normal: [0, 0, 1], offset: 0.25 }),
  cut({ normal: [third, third, third], offset: 1.5 * third }), cube.shape.edges.length,
  [1e-14, 612.34567, 0, null].map(castx.text),
  [cut(null, sunk), cut(half, sunk), segments.length / 2],
  [ofShell(null), ofShell(half)],
];
"""


def test_a_cut_of_a_cube_has_its_area(tmp_path):
    """A quarter of its height: 2 + 4/4; across its diagonal: half its sides and a hexagon.

    Sunk to a quarter it has the same area, and 12 edges with the four on which it ends; its half
    has 7/4, and 1/4 less where only its shell is there.
    """
    scripts = "\n".join([text("scripts/data.js"), text("scripts/geometry.js"), CUTS])
    whole, quarter, diagonal, edges, texts, sunk, shell = evaluated(scripts, tmp_path)
    assert (whole, quarter, edges) == (6.0, 3.0, 12)
    assert diagonal == pytest.approx(3.0 + 0.75 * 3.0**0.5)
    assert texts == ["1e-14", "612.3", "0", "–"]
    assert sunk == [3.0, 1.75, 12]
    assert shell == pytest.approx([3.0, 1.5])
