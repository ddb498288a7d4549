"""Rows travel to chunks by ascending number, and back with ghosts."""

from __future__ import annotations

import numpy as np
import pytest

from castx.checkpoint import chunks
from castx.checkpoint.chunks import ChunkedRows
from castx.stateful import Numbering, Saved

ENTITIES = 23
FAR = 10**12
"""Numbers need not be consecutive."""


def numbering(comm, empty: bool = False, count: int = ENTITIES) -> Numbering:
    """Return entities dealt out to the ranks, with ghosts from all of them behind the owned ones.

    Args:
        comm: ranks.
        empty: whether the last rank owns nothing.
        count: how many entities there are.
    """
    dealers = comm.size - (empty and comm.size > 1)
    order = np.random.default_rng(5).permutation(count)
    own = order[comm.rank :: dealers] if comm.rank < dealers else order[:0]
    ghosts = np.setdiff1d(order, own)[:4]
    numbers = FAR + 3 * np.concatenate((own, ghosts))
    return Numbering(f"{count} entities", numbers, len(own), ("casting",))


def dealt(comm, count: int, width: int = 2, empty: bool = False) -> dict[str, Saved]:
    """Return arrays of entities dealt out to the ranks, and one without entities."""
    entities = numbering(comm, empty, count)
    rows = np.sqrt(entities.numbers)[:, None] + np.arange(width)
    # A rank without rows of its own may know nothing of their shape.
    rows = rows if len(rows) else np.empty((0, 1))
    few = numbering(comm, count=3)
    return {
        "rows": Saved(rows, entities),
        "number": Saved(np.array(1.0 / 3.0)),
        "flags": Saved(entities.numbers % 2 == 0, entities),
        "few": Saved(few.numbers, few),
    }


def values_of(numbers: np.ndarray, kind: str) -> np.ndarray:
    """Return rows that tell their numbers."""
    match kind:
        case "scalar":
            return np.sqrt(numbers.astype(np.float64))
        case "tensor":
            return numbers[:, None, None] * np.array([[1.0, 2.0], [3.0, 4.0]])
        case "flag":
            return (numbers // 3) % 2 == 0
        case _:
            return np.zeros((len(numbers), 0))


@pytest.mark.ranks
@pytest.mark.parametrize("rows", [chunks.ROWS, 1, 4])
@pytest.mark.parametrize("empty", [False, True])
@pytest.mark.parametrize("kind", ["scalar", "tensor", "flag", "nothing"])
def test_rows_go_to_chunks_by_number_and_back_with_ghosts(comm, monkeypatch, kind, empty, rows):
    """Also where a rank has nothing, and where there are many chunks."""
    monkeypatch.setattr(chunks, "ROWS", rows)
    assert_rows_travel(comm, numbering(comm, empty), kind, rows)


@pytest.mark.ranks
def test_each_rank_may_have_the_numbers_of_one_range(comm):
    """And the last one, which has the highest, one number of the first."""
    owner = np.arange(ENTITIES) * comm.size // ENTITIES
    owner[7] = comm.size - 1
    part = FAR + 3 * np.flatnonzero(owner == comm.rank)
    own = Numbering("cells", part, len(part), ("casting",))
    assert_rows_travel(comm, own, "scalar", chunks.ROWS)


def assert_rows_travel(comm, own, kind, rows):
    local = values_of(own.numbers, kind)
    spoilt = local.copy()
    spoilt[own.owned :] = 0  # rows of ghosts are not sent
    moving = ChunkedRows(comm, own, ghosts=False)
    width = spoilt.itemsize * int(np.prod(spoilt.shape[1:]))
    mine = {start: chunk.copy() for start, chunk in moving.collected(spoilt, width)}
    assert moving.count == ENTITIES
    assert [(start // rows) % comm.size for start in mine] == [comm.rank] * len(mine)
    assert all(0 < len(chunk) <= rows for chunk in mine.values())
    every = {start: chunk for part in comm.allgather(mine) for start, chunk in part.items()}
    whole = np.concatenate([every[start] for start in sorted(every)])
    expected = values_of(FAR + 3 * np.arange(ENTITIES), kind)
    assert whole.tobytes() == expected.tobytes() and len(whole) == ENTITIES
    back = ChunkedRows(comm, own, ghosts=True).handed_out(
        whole.shape[1], lambda start, count: whole[start : start + count]
    )
    assert len(back) == len(local) and back.tobytes() == local.tobytes()


@pytest.mark.ranks
def test_nothing_at_all_travels_as_well(comm):
    none = Numbering("pairs", np.empty(0, dtype=np.int64), 0, ("casting",))
    moving = ChunkedRows(comm, none, ghosts=False)
    assert moving.count == 0 and list(moving.collected(np.empty((0, 3)), 24)) == []
