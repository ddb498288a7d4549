"""Names and numbers of the arrays of a state."""

import numpy as np
import pytest

from castx.stateful import (
    MOST_AT_NODE,
    Saved,
    joined,
    number,
    numbered_at_nodes,
    occurrence,
    part_of,
    restore_parts,
    saved_parts,
)

pytestmark = pytest.mark.serial


@pytest.mark.parametrize("values", [[], [5], [3, 1, 3, 3, 1, 2, 3], [0, 0, 0], [4, 3, 2]])
def test_occurrences_are_counted_from_the_start(values):
    expected = [values[:index].count(value) for index, value in enumerate(values)]
    assert occurrence(np.array(values, dtype=np.int64)).tolist() == expected


def test_entities_at_one_node_have_different_numbers_that_depend_on_the_node_alone():
    nodes = np.array([7, 2, 7, 7, 2], dtype=np.int64)
    numbering = numbered_at_nodes("pairs", nodes, ("a", "b"))
    assert (numbering.name, numbering.owned, numbering.bodies) == ("pairs", 5, ("a", "b"))
    assert len(set(numbering.numbers.tolist())) == 5
    assert np.array_equal(numbering.numbers // MOST_AT_NODE, nodes)
    alone = numbered_at_nodes("pairs", nodes[nodes == 7], ("a", "b"))
    assert np.array_equal(alone.numbers, numbering.numbers[nodes == 7])


class Counter:
    """Something that counts."""

    def __init__(self, count: float) -> None:
        self.count = count

    def saved(self):
        return {"count": number(self.count)}

    def restore(self, arrays):
        self.count = float(arrays["count"])


def test_parts_get_back_what_they_saved():
    first, second = Counter(1.5), Counter(-2.0)
    saved = saved_parts({"a": first, "a/b": second})
    assert set(saved) == {"a/count", "a/b/count"}
    arrays = {name: item.values for name, item in saved.items()}
    others = {"a": Counter(0.0), "a/b": Counter(0.0)}
    restore_parts(others, arrays)
    assert (others["a"].count, others["a/b"].count) == (1.5, -2.0)


def test_names_of_parts_are_no_beginnings_of_names():
    arrays = {"heat/T": np.ones(2), "heating/T": np.zeros(2), "heat/bodies/H": np.ones(1)}
    assert set(part_of(arrays, "heat")) == {"T", "bodies/H"}
    nested = joined({"heat": {"T": Saved(np.ones(2))}, "mechanics": {"u": Saved(np.ones(3))}})
    assert list(nested) == ["heat/T", "mechanics/u"]


def test_an_array_belongs_to_the_bodies_of_its_entities():
    pairs = numbered_at_nodes("pairs", np.array([1, 2]), ("casting", "mould"))
    assert Saved(np.ones(2), pairs).owners == ("casting", "mould")
    assert number(1.0, bodies=("core",)).owners == ("core",)
    assert number(1.0).owners == ()
