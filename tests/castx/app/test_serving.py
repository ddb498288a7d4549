"""The command castx app: its address, a run under way when it ends, its folder and its port."""

import json
import signal
import socket

import pytest

from castx.app.serving import listening
from castx.errors import CaseError
from castx.results.files.run_json import read_record
from tests.castx.app.served import WINDOW
from tests.castx.command_line import CASE, start, wait_for

pytestmark = pytest.mark.serial


def asking(address):
    """Return what asks the server of an address, in the words of the page."""
    import http.client

    port, token = address.removeprefix("http://127.0.0.1:").split("/?token=")
    headers = {"Authorization": f"Bearer {token}", "Castx-Window": WINDOW,
               "Origin": f"http://127.0.0.1:{port}"}  # fmt: skip

    def ask(action, **asked):
        connection = http.client.HTTPConnection("127.0.0.1", int(port), timeout=60)
        connection.request("POST", f"/api/{action}", json.dumps(asked), headers)
        return json.loads(connection.getresponse().read())

    return ask


def test_ctrl_c_lets_a_run_end_after_its_step_with_its_state_on_disk(tmp_path):
    (tmp_path / "case.toml").write_text(CASE.replace("end = 0.2", "end = 1000"))
    page = start("castx", "app", str(tmp_path), "--no-browser")
    lines = [page.stdout.readline() for _ in range(4)]
    ask = asking(lines[2].strip())
    assert ask("claim", window=WINDOW)["claimed"]
    second = start("castx", "app", str(tmp_path), "--no-browser")
    assert ask("command", command="run", path="case.toml")["text"] == "castx run case.toml"
    assert "still runs" in ask("command", command="check", path="case.toml")["error"]
    assert "is open on" in " ".join(second.communicate(timeout=60)[1].split())
    assert second.returncode == 2

    def under_way():
        run = ask("state", results="results/case")["run"]
        return run.get("steps", 0) >= 2 and len(run["curves"]) > 0

    wait_for(under_way, page)
    page.send_signal(signal.SIGINT)
    said, wrong = page.communicate(timeout=60)
    assert page.returncode == 0, wrong
    assert "castx run case.toml has ended with exit code 130" in said and "Traceback" not in wrong
    record = read_record(tmp_path / "results" / "case" / "run.json")
    assert record["exit"]["reason"] == "interrupted"
    assert (tmp_path / "results" / "case" / "checkpoint").is_dir()


def test_a_port_in_use_is_refused_with_a_cure():
    with listening(0) as listener:
        port = listener.getsockname()[1]
        assert listener.getsockname()[0] == "127.0.0.1"
        with pytest.raises(CaseError, match=f"--port {port}"), listening(port):
            pass
        with socket.create_connection(("127.0.0.1", port)):
            pass
