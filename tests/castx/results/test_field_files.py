"""The format of a case decides which files its fields have."""

import pytest

from castx.case.output import FORMATS, Output
from castx.errors import CaseError
from castx.input.problems import Refusal
from castx.results.field_files import field_files
from castx.results.files.disk import Disk
from castx.results.files.vtu import Piece
from castx.results.hdf_fields import HdfFields
from castx.results.vtu_fields import VtuFields
from tests.castx.fakes import cylinder_mesh


def test_every_format_has_files(comm, shared_tmp_path):
    mesh = cylinder_mesh(comm, size=1e-2)
    pieces = {name: Piece.of(body) for name, body in mesh.bodies.items()}
    kinds = {"vtkhdf": HdfFields, "vtu": VtuFields}
    assert set(kinds) == set(FORMATS)
    for form, kind in kinds.items():
        found = field_files(form, shared_tmp_path, mesh, pieces, {}, Disk(comm))
        assert isinstance(found, kind) and found.last is None and found.notes() == []


@pytest.mark.serial
def test_other_formats_are_refused():
    with pytest.raises((CaseError, Refusal), match="vtkhdf"):
        Output.read({"format": "xdmf"})
