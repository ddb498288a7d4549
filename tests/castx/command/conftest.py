"""The small case on disk, what commands have printed about it, and what they have logged."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from functools import partial

import pytest

from tests.castx import command_line


@pytest.fixture
def case_file(comm, shared_tmp_path):
    """Return the path of the small coupled case."""
    path = shared_tmp_path / "case.toml"
    if comm.rank == 0:
        path.write_text(command_line.CASE)
    comm.Barrier()
    return path


@pytest.fixture
def said(comm, capsys):
    """Return what tells what rank 0 has printed since it was asked last."""
    return partial(command_line.said, comm, capsys)


class Heard(logging.Handler):
    """Keeps what is logged, whatever the command line did to the loggers above."""

    def __init__(self) -> None:
        super().__init__()
        self.messages: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.messages.append(record.getMessage())


@pytest.fixture
def heard(request) -> Iterator[list[str]]:
    """Return the messages of the logger that the tests of a file name LISTENED."""
    handler, logger = Heard(), logging.getLogger(request.module.LISTENED)
    logger.addHandler(handler)
    yield handler.messages
    logger.removeHandler(handler)
