"""Foreign names, origins, users and large bodies are refused, each alone."""

import pytest

from castx.app.guard import LARGEST_BODY
from tests.castx.app.served import served

pytestmark = pytest.mark.serial


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    with served(tmp_path_factory.mktemp("guarded")) as found:
        yield found


def status(page, path="/api/files", method="POST", body=b"{}", drop=(), **headers):
    sent = {key: value for key, value in page.headers(**headers).items() if key not in drop}
    return page.request(method, path, sent, body)[0]


def test_the_page_itself_is_answered(page):
    assert status(page) == 200
    local = f"localhost:{page.port}"
    assert status(page, Host=local, Origin=f"http://{local}") == 200


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:{port}", "127.0.0.1", "127.0.0.1:1", "[::1]:{port}", ""]
)
def test_a_foreign_name_that_leads_here_is_refused(page, host):
    """DNS rebinding: the origin is that of the name, so that only the name tells."""
    named = host.format(port=page.port)
    assert status(page, Host=named, Origin=f"http://{named}") == 421
    address = f"/?token={page.session.token}"
    assert status(page, address, "GET", b"", ("Origin",), Host=named) == 421


@pytest.mark.parametrize(
    "origin",
    ["https://evil.example", "null", "http://127.0.0.1", "http://127.0.0.1:1",
     "https://127.0.0.1:{port}", "http://localhost:{port}"],
)  # fmt: skip
def test_a_foreign_origin_is_refused(page, origin):
    assert status(page, Origin=origin.format(port=page.port)) == 403


def test_a_change_without_an_origin_is_refused(page):
    assert status(page, drop=("Origin",)) == 403


def test_what_a_browser_says_of_another_site_is_refused(page):
    assert status(page, Sec_Fetch_Site="same-origin") == 200
    for site in ("cross-site", "same-site", "none"):
        assert status(page, Sec_Fetch_Site=site) == 403


def test_a_request_without_the_token_is_refused(page):
    assert status(page, drop=("Authorization",)) == 403
    assert status(page, Authorization="Bearer " + page.session.token[:-1]) == 403
    assert status(page, "/api/claim", drop=("Authorization",)) == 403
    assert status(page, "/nothing", drop=("Authorization",)) == 403
    assert status(page, "/", "GET", b"", ("Origin",)) == 403
    assert status(page, "/?token=", "GET", b"", ("Origin", "Authorization")) == 403
    opened = f"/?token={page.session.token}"
    assert status(page, opened, "GET", b"", ("Origin", "Authorization")) == 200
    assert status(page, "/show/guessed", "GET", b"", ("Origin",)) == 403


def test_a_cookie_is_no_token(page):
    cookie = f"token={page.session.token}"
    assert status(page, drop=("Authorization",), Cookie=cookie) == 403


def test_another_window_is_refused(page):
    assert status(page, Castx_Window="another") == 409
    assert status(page, drop=("Castx-Window",)) == 409


def test_a_large_body_is_refused_said_or_not(page):
    assert status(page, Content_Length=str(LARGEST_BODY + 1)) == 413
    chunk = b"%x\r\n%s\r\n" % (1 << 20, b" " * (1 << 20))
    few, many = chunk + b"0\r\n\r\n", chunk * (LARGEST_BODY // (1 << 20) + 1) + b"0\r\n\r\n"
    assert status(page, body=few, Transfer_Encoding="chunked") == 400  # blanks are no JSON
    assert status(page, body=many, Transfer_Encoding="chunked") == 413


@pytest.mark.parametrize("method", ["PUT", "DELETE", "OPTIONS", "TRACE"])
def test_other_methods_are_refused(page, method):
    assert status(page, method=method) == 405


def test_answers_are_kept_nowhere_and_shown_in_no_frame(page):
    _, headers, _ = page.request("POST", "/api/files", page.headers(), b"{}")
    assert headers["cache-control"] == "no-store" and headers["x-frame-options"] == "DENY"
    assert headers["referrer-policy"] == "no-referrer"
    assert "set-cookie" not in headers and "access-control-allow-origin" not in headers
