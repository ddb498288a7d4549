"""The process that draws a scene: it meshes a case, or reads the fields of a run.

It gets in its arguments the file of the request (JSON), the file of the answer to write, and the
exit code of a refusal, with which it ends after writing its reason.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from castx.app.scenes.asking import MESH
from castx.app.scenes.mesh import mesh_scene
from castx.app.scenes.moment import moment_scene
from castx.errors import CaseError, MeshError


def main() -> None:
    """Answer the request of the command line, and end the process."""
    request, answer, refused = sys.argv[1:]
    asked = json.loads(Path(request).read_text())
    try:
        if asked["scene"] == MESH:
            found = mesh_scene(asked["text"], Path(asked["path"]))
        else:
            found = moment_scene(Path(asked["path"]), asked["field"])
    except (CaseError, MeshError) as error:
        Path(answer).write_text(str(error))
        sys.exit(int(refused))
    Path(answer).write_text(json.dumps(found))


if __name__ == "__main__":
    main()
