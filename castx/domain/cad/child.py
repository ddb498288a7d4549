"""The process that meshes CAD files, or tells their faces.

It gets in its arguments the file of the request, the file of the mesh to write, the file of the
answer, the exit code of a refusal, and perhaps the word `faces`. It ends with 0 after writing mesh
and report (JSON), or the faces, or after writing its reason with the code of a refusal, and with
`NO_CELLS` where solids are sound and only their mesh is refused.
"""

from __future__ import annotations

import ctypes
import json
import os
import pickle
import sys
from pathlib import Path

import gmsh

from castx.meshes.cad.description import NO_CELLS, NoCellsError
from castx.meshes.cad.part import mesh_part
from castx.meshes.cad.seen import see_part

FACES = "faces"
"""Last argument where faces are wanted and no mesh."""


def main() -> None:
    """Answer the request of the command line, and end the process."""
    request, mesh, answer, refused, *wanted = sys.argv[1:]
    part = pickle.loads(Path(request).read_bytes())  # written by the process that asks
    gmsh.initialize(argv=[], readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("General.NumThreads", 1)
    gmsh.model.add("castx")
    code = 0
    try:
        report = see_part(part, mesh) if wanted == [FACES] else mesh_part(part, mesh)
        Path(answer).write_text(json.dumps(report.as_data()))
    except ValueError as error:
        Path(answer).write_text(str(error))
        code = NO_CELLS if isinstance(error, NoCellsError) else int(refused)
    sys.stdout.flush()
    sys.stderr.flush()
    ctypes.CDLL(None).fflush(None)  # what gmsh has printed
    os._exit(code)  # gmsh need not tidy up


if __name__ == "__main__":
    main()
