"""Where values stand in the text of a case file."""

import pytest

from castx.app.text.toml_lines import line_of

pytestmark = pytest.mark.serial

TEXT = """# a case
name = "x"
[geometry]
size = 1 # [not, a, table]
surfaces = { top = { normal = "+z" } }
[[bodies]]
name = "casting"
[[bodies]]
name = "mould"
text = '''
name = "of nothing"
[time]
'''
table = [
  [20, 1],
]
[bodies.start]
temperature = 20
[time]
end = 3
"step".first = 4
"""


@pytest.mark.parametrize(
    ("path", "line"),
    [
        (("name",), 2),
        (("geometry",), 3),
        (("geometry", "size"), 4),
        (("geometry", "surfaces", "top", "normal"), 5),
        (("geometry", "unknown"), 3),
        (("bodies", 0, "name"), 7),
        (("bodies", 1), 8),
        (("bodies", 1, "name"), 9),
        (("bodies", 1, "table", 0, 1), 14),
        (("bodies", 1, "start", "temperature"), 18),
        (("time", "end"), 20),
        (("time", "step", "first"), 21),
        (("bodies", 2), None),
        ((), None),
    ],
)
def test_a_value_stands_in_its_line(path, line):
    assert line_of(TEXT, path) == line
