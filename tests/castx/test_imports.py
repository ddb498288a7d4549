"""Imports without a search for garbage: it is on again afterwards, also behind an error."""

import gc

import pytest

from castx.imports import kept, unsearched

pytestmark = pytest.mark.serial


def test_nothing_is_searched_meanwhile():
    assert gc.isenabled()
    with unsearched():
        assert not gc.isenabled()
    assert gc.isenabled()
    with pytest.raises(ImportError), unsearched():
        raise ImportError
    assert gc.isenabled()


def test_who_has_turned_it_off_finds_it_so():
    gc.disable()
    try:
        with unsearched():
            pass
        assert not gc.isenabled()
    finally:
        gc.enable()


def test_what_is_kept_is_left_out_of_later_searches():
    before = gc.get_freeze_count()
    try:
        with kept():
            found = [[] for _ in range(10)]
            assert gc.get_freeze_count() == before
        assert gc.get_freeze_count() >= before + len(found)
        assert gc.isenabled()
    finally:
        gc.unfreeze()
