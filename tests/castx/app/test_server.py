"""Requests and answers: refusals in words, reports without the rights of the page."""

import pytest

from castx.app.server import SANDBOXED
from tests.castx.app.served import served
from tests.castx.command_line import CASE

pytestmark = pytest.mark.serial


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("served")
    (folder / "case.toml").write_text(CASE)
    (folder / "report.html").write_text("<script>1</script>")
    with served(folder) as found:
        yield found


def test_a_case_is_opened(page):
    status, answer = page.ask("open", path="case.toml")
    assert status == 200 and answer["text"] == CASE and answer["problems"] == []


def test_refusals_come_in_words(page):
    status, answer = page.ask("open", path="../case.toml")
    assert status == 400 and "no path" in answer["error"]
    assert page.ask("open", path=5)[0] == 400
    for body in (b"", b"[1]", b"{", b"[" * 100_000):
        status, _, answer = page.request("POST", "/api/open", page.headers(), body)
        assert status == 400 and b"the page has sent no" in answer
    assert page.request("POST", "/api/none", page.headers(), b"{}")[0] == 404
    assert page.request("GET", "/api/files", page.headers())[0] == 405


def test_an_error_inside_tells_the_page_no_more_than_that(page, monkeypatch, caplog):
    def fail(*_):
        raise ZeroDivisionError("the inside")

    monkeypatch.setattr("castx.app.actions.checked", fail)
    status, answer = page.ask("open", path="case.toml")
    assert status == 500 and "the inside" not in answer["error"]


def test_a_report_is_shown_by_its_ticket_and_reaches_nothing(page):
    _, answer = page.ask("show", path="report.html")
    status, headers, body = page.request("GET", answer["address"], {})
    assert status == 200 and body == b"<script>1</script>"
    policy = headers["content-security-policy"]
    assert policy == SANDBOXED and policy.startswith("sandbox allow-scripts;")
    assert "connect-src" not in policy and "allow-same-origin" not in policy
    target = page.folder / "report.html"
    target.unlink()
    target.symlink_to("/etc/hostname")
    assert page.request("GET", answer["address"], {})[0] == 400


def test_the_page_has_its_policy(page):
    status, headers, body = page.request("GET", f"/?token={page.session.token}", {})
    assert status == 200 and b"<title>castx app</title>" in body
    assert "default-src 'none'" in headers["content-security-policy"]
