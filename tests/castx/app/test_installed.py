"""The page is refused where its packages are missing, and on several ranks."""

import pytest

from castx.app.installed import refuse_missing_server
from castx.errors import CaseError

pytestmark = pytest.mark.serial


def test_it_says_what_is_missing():
    refuse_missing_server(1)
    with pytest.raises(CaseError, match=r"needs no_such_package: pip install 'castx\[app\]'"):
        refuse_missing_server(1, ["starlette", "no_such_package"])
    with pytest.raises(CaseError, match="without mpirun"):
        refuse_missing_server(2)
