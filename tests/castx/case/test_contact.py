"""Description of contact: method, its numbers and the initial gap."""

import numpy as np
import pytest

from castx.case.contact import InterfaceContact
from castx.input.problems import Refusal

pytestmark = pytest.mark.serial

PLANE = np.array([[0.0, 1.0], [0.5, 2.0], [2.0, 3.0]])
SPACE = np.array([[3.0, 4.0, 1.0], [0.0, 0.5, 2.0]])


@pytest.mark.parametrize(
    "gap, points, expected",
    [
        ("-25 um", PLANE, [-25e-6] * 3),
        ({"along": "x", "table": [[0, 0], [1, "1 mm"]]}, PLANE, [0.0, 5e-4, 1e-3]),
        ({"along": "r", "table": [[0, 0], [1, "1 mm"]]}, PLANE, [0.0, 5e-4, 1e-3]),
        ({"along": "y", "table": [[1, 0], [3, 2]]}, PLANE, [0.0, 1.0, 2.0]),
        ({"along": "z", "table": [[1, 0], [3, 2]]}, PLANE, [0.0, 1.0, 2.0]),
        ({"along": "y", "table": [[0, 0], [4, 4]]}, SPACE, [4.0, 0.5]),
        ({"along": "z", "table": [[1, 0], [2, 1]]}, SPACE, [0.0, 1.0]),
        ({"along": "r", "table": [[0, 0], [5, 5]]}, SPACE, [5.0, 0.5]),
    ],
)
def test_initial_gap(gap, points, expected):
    contact = InterfaceContact.read({"initial_gap": gap})
    np.testing.assert_allclose(contact.initial_gap.at(points), expected, atol=1e-15)


def test_contact_by_default():
    contact = InterfaceContact.read({})
    assert (contact.method, contact.normals) == ("condensed", "automatic")
    np.testing.assert_array_equal(contact.initial_gap.at(PLANE), np.zeros(3))


def test_what_asks_for_nothing_is_accepted():
    InterfaceContact.read({"pairing": "node-to-node", "friction": 0.0, "fallback": []})


@pytest.mark.parametrize(
    "contact, text",
    [
        ({"method": "condensd"}, r'method: unknown.*did you mean "condensed"\?'),
        ({"method": "penalty", "blocks": "bodies"}, "blocks: the method 'penalty' does not use it"),
        ({"method": "block-iterative", "blocks": "nodes"}, "blocks: unknown"),
        ({"method": "block-iterative", "block_solver": "direct"}, "block_solver: unknown"),
        ({"method": "block-iterative", "block_iterations": 0}, "block_iterations: a whole number"),
        ({"penalty": "auto"}, "penalty: the method 'condensed' does not use it; methods that do"),
        ({"method": "penalty", "penalty": 0}, "penalty: must be positive"),
        ({"method": "penalty", "penalty": "1 GPa"}, 'not a unit of pressure per length.*or "auto"'),
        ({"method": "penalty", "augmentations": 2}, "augmentations: the method 'penalty' does not"),
        ({"method": "augmented-lagrangian", "augmentation": "never"}, "augmentation: unknown"),
        ({"method": "augmented-lagrangian", "augmentations": -1}, "augmentations: a whole number"),
        ({"method": "tied", "initial_gap": 1e-3}, "initial_gap: the method 'tied' has no gap"),
        ({"normals": "patches", "method": "tied"}, "normals: the method 'tied' has no normals"),
        ({"normals": "patches", "sharp_angle": 200}, "sharp_angle: must be .* at most 180"),
        ({"sharp_angle": 20}, 'sharp_angle: belongs to normals = "patches"'),
        ({"friction": -0.2}, "friction: must be at least 0"),
        ({"friction": 0.2, "method": "multipliers"}, "friction: method 'multipliers' has no fric"),
        ({"friction": 0.2, "fallback": ["penalty"]}, "friction: what has slipped is known to one"),
        ({"friction": 0.2, "normals": "patches"}, "friction: friction needs pairing"),
        ({"surfaces": ["a", "b"]}, 'surfaces: belongs to pairing = "node-to-face"'),
        ({"surfaces": ["a"], "pairing": "node-to-face"}, "surfaces: two names are needed"),
        ({"meshed_gap": "ignored"}, 'meshed_gap: belongs to pairing = "node-to-face"'),
        ({"search_distance": 1e-3}, 'search_distance: belongs to pairing = "node-to-face"'),
        ({"normals": "patches", "pairing": "node-to-face"}, "normals: from node to face only"),
        ({"fallback": "penalty"}, "fallback: a list of methods is needed"),
        ({"fallback": ["tied"]}, r"fallback\[0\]: unknown; allowed: condensed, multipliers"),
        ({"fallback": ["penalty", "penalty"]}, r"fallback\[1\]: is there already"),
        ({"fallback": ["condensed"]}, "fallback: begins with the method 'condensed' itself"),
        ({"method": "rigid", "fallback": ["penalty"]}, "fallback: the method 'rigid' has none"),
        ({"initial_gap": "1 s"}, "initial_gap: 's' is not a unit of length"),
        ({"initial_gap": {"along": "x"}}, "initial_gap.table: missing; both along and table"),
        (
            {"initial_gap": {"along": "t", "table": [[0, 1]]}},
            "initial_gap.along: unknown; allowed: x",
        ),
        ({"initial_gap": {"along": "x", "tabel": [[0, 1]]}}, 'tabel: unknown key.*mean "table"'),
        (
            {"initial_gap": {"along": "x", "table": [[0, 1], [0, 2]]}},
            r"initial_gap.table\[1\]: the",
        ),
    ],
)
def test_refused_contact(contact, text):
    with pytest.raises(Refusal, match=text):
        InterfaceContact.read(contact)


def test_numbers_of_a_fallback_are_accepted():
    data = {"fallback": ["block-iterative"], "penalty": 1e12, "blocks": "bodies"}
    contact = InterfaceContact.read(data)
    assert (contact.fallback, contact.penalty) == (("block-iterative",), 1e12)


def test_penalties_carry_units():
    assert InterfaceContact.read({"method": "penalty", "penalty": "2 GPa/mm"}).penalty == 2e12
    assert InterfaceContact.read({"method": "augmented-lagrangian"}).penalty == "auto"
