"""Which pool a region goes on as, by hand."""

from __future__ import annotations

from castx.foundry.pools.heritage import Heritage, largest


def test_a_first_region_is_a_new_pool_without_parent():
    found = Heritage.of({}, 1, [], 1)
    assert (found.numbers, found.parents, found.gone) == ([1], {1: None}, [])


def test_the_larger_part_keeps_the_number_and_the_other_remembers_it():
    found = Heritage.of({(1, 0): 2.0, (1, 1): 5.0, (1, 2): 1.0}, 3, [1], 4)
    assert found.numbers == [4, 1, 5]
    assert found.parents == {4: 1, 5: 1}
    assert not found.merged and not found.gone


def test_of_equal_parts_the_first_one_keeps_it_whatever_rounding_says():
    for error in (-1e-12, 0.0, 1e-12):
        assert Heritage.of({(1, 0): 1.0, (1, 1): 1.0 + error}, 2, [1], 2).numbers == [1, 2]
    assert Heritage.of({(1, 0): 1.0, (1, 1): 1.0 + 1e-4}, 2, [1], 2).numbers == [2, 1]


def test_of_pools_that_merge_the_lowest_number_stays_though_another_one_is_larger():
    found = Heritage.of({(2, 0): 1.0, (5, 0): 9.0, (7, 0): 2.0}, 1, [7, 5, 2], 8)
    assert found.numbers == [2]
    assert found.merged == {2: [5, 7]}
    assert not found.parents


def test_a_bridge_takes_a_small_part_of_a_pool_along():
    """Pool 1 splits, and the small part joins pool 2: both go on with their numbers."""
    found = Heritage.of({(1, 0): 5.0, (1, 1): 1.0, (2, 1): 3.0}, 2, [1, 2], 3)
    assert found.numbers == [1, 2]
    assert not found.parents and not found.merged


def test_a_pool_without_liquid_is_gone_and_its_number_is_not_given_again():
    found = Heritage.of({(2, 0): 1.0}, 2, [1, 2], 3)
    assert found.gone == [1]
    assert found.numbers == [2, 3] and found.parents == {3: None}


def test_the_largest_of_volumes():
    assert largest({3: 1.0, 1: 2.0, 2: 2.0}) == 1
