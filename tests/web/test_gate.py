"""The gate: nothing of the app answers but to its own page, which showed the token."""

from __future__ import annotations

import asyncio

import pytest

from zerorev.web import gate
from zerorev.web.gate import Gate

PORT, TOKEN, ONCE = 8123, "a-token-that-lasts", "a-token-for-once"
HERE = f"127.0.0.1:{PORT}"
COOKIE = f"zerorev-{PORT}={TOKEN}"


async def behind(scope, receive, send):
    """An app that reads the whole of what it is sent, and says how much that was."""
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.accept"})
        return
    length, more = 0, True
    while more:
        message = await receive()
        if message["type"] == "http.disconnect":
            raise ConnectionError("the client has gone")
        length += len(message["body"])
        more = message.get("more_body", False)
    await send({"type": "http.response.start", "status": 200, "headers": [(b"x-mine", b"1")]})
    await send({"type": "http.response.body", "body": str(length).encode()})


class Asked:
    """What became of a request or of a socket."""

    def __init__(self, sent):
        self.sent = sent
        first = sent[0]
        self.status = first.get("status", first["type"])
        self.headers = {name.decode(): value.decode() for name, value in first.get("headers", ())}
        self.body = b"".join(message.get("body", b"") for message in sent).decode()


def ask(
    guard, method="GET", path="/", query="", *, host=HERE, origin=None, cookie=COOKIE, kind="http", body=(b"",), more=()
):
    """Ask something through the gate."""
    headers = [(b"host", host.encode())] if host else []
    headers += [(b"origin", origin.encode())] if origin else []
    headers += [(b"cookie", cookie.encode())] if cookie else []
    scope = {"type": kind, "path": path, "query_string": query.encode(), "headers": [*headers, *more]}
    if kind == "http":
        scope["method"] = method
    pieces = list(body)
    sent = []

    async def receive():
        if kind == "websocket":
            return {"type": "websocket.connect"}
        return {"type": "http.request", "body": pieces.pop(0), "more_body": bool(pieces)}

    async def send(message):
        sent.append(message)

    asyncio.run(guard(scope, receive, send))
    return Asked(sent)


@pytest.fixture
def guard():
    """A gate before an app that answers everything."""
    return Gate(behind, PORT, TOKEN, ONCE)


def test_the_token_gives_a_cookie_and_leaves_the_address(guard):
    answer = ask(guard, query=f"token={TOKEN}", cookie=None)
    assert answer.status == 303
    assert answer.headers["location"] == "/"
    assert answer.headers["set-cookie"] == f"{COOKIE}; Path=/; HttpOnly; SameSite=Strict"
    assert answer.headers["cache-control"] == "no-store"
    assert ask(guard).status == 200


@pytest.mark.parametrize("path", ["/", "/_nicegui/3.18.0/static/nicegui.js", "/_nicegui_ws/socket.io/", "/favicon.ico"])
@pytest.mark.parametrize(
    "cookie", [None, "", f"zerorev-{PORT}=", f"zerorev-{PORT}=wrong", f"zerorev-9999={TOKEN}", f"x{COOKIE}", "ü=ü"]
)
def test_nothing_is_answered_without_the_token(guard, path, cookie):
    answer = ask(guard, path=path, cookie=cookie)
    assert (answer.status, answer.body) == (403, f"{gate.NO_TOKEN}\n")


@pytest.mark.parametrize("query", ["token=wrong", "token=", "token=%00", "token=" + TOKEN[:-1], "tokens=" + TOKEN])
def test_a_wrong_token_opens_nothing(guard, query):
    assert ask(guard, query=query, cookie=None).status == 403


def test_the_token_in_an_address_counts_on_the_first_page_alone(guard):
    query = f"token={TOKEN}"
    assert ask(guard, path="/_nicegui_ws/socket.io/", query=query, cookie=None).status == 403
    assert ask(guard, "POST", query=query, cookie=None, origin=f"http://{HERE}").status == 403
    assert ask(guard, kind="websocket", query=query, cookie=None, origin=f"http://{HERE}").status == "websocket.close"


def test_the_address_that_a_browser_is_started_with_opens_once(guard):
    assert ask(guard, query=f"token={ONCE}", cookie=None).status == 303
    assert ask(guard, query=f"token={ONCE}", cookie=None).status == 403
    assert ask(guard, query=f"token={TOKEN}", cookie=None).status == 303
    assert ask(guard, query=f"token={TOKEN}", cookie=None).status == 303


@pytest.mark.parametrize(
    "host", ["", "evil.example", f"evil.example:{PORT}", "127.0.0.1", "127.0.0.1:80", f"127.0.0.1.evil.example:{PORT}"]
)
@pytest.mark.parametrize("kind", ["http", "websocket"])
def test_another_name_for_this_machine_is_refused(guard, host, kind):
    answer = ask(guard, host=host, kind=kind, origin=f"http://{host}" if kind == "websocket" else None)
    assert answer.status == (403 if kind == "http" else "websocket.close")


def test_two_hosts_are_none(guard):
    assert ask(guard, more=[(b"host", HERE.encode())]).status == 403


@pytest.mark.parametrize("host", [HERE, f"localhost:{PORT}"])
def test_our_own_page_may_post_and_open_sockets(guard, host):
    assert ask(guard, "POST", host=host, origin=f"http://{host}", body=(b"ab", b"c")).body == "3"
    assert ask(guard, kind="websocket", host=host, origin=f"http://{host}").status == "websocket.accept"


@pytest.mark.parametrize(
    "origin",
    [None, "null", "http://evil.example", "http://127.0.0.1:9999", f"https://{HERE}", f"http://localhost:{PORT}"],
)
def test_other_pages_may_neither_post_nor_open_sockets(guard, origin):
    assert ask(guard, "POST", origin=origin).status == 403
    assert ask(guard, "DELETE", origin=origin).status == 403
    closed = ask(guard, kind="websocket", origin=origin)
    assert [message["type"] for message in closed.sent] == ["websocket.close"]
    assert ask(guard, "GET", origin=origin).status == (200 if origin is None else 403)


@pytest.mark.parametrize("length", [str(gate.LARGEST + 1), "9" * 40, "-1", "many"])
def test_too_large_a_body_is_refused_before_it_is_read(guard, length):
    answer = ask(guard, "POST", origin=f"http://{HERE}", body=(), more=[(b"content-length", length.encode())])
    assert (answer.status, answer.body) == (413, f"{gate.TOO_LARGE}\n")


def test_too_large_a_body_is_refused_while_it_is_read(guard):
    piece = b"x" * (gate.LARGEST // 3)
    assert ask(guard, "POST", origin=f"http://{HERE}", body=(piece,) * 3).body == str(3 * len(piece))
    answer = ask(guard, "POST", origin=f"http://{HERE}", body=(piece,) * 5)
    assert answer.status == 413
    assert len(answer.sent) == 2  # of the app behind, not a word


def test_a_fault_of_the_app_is_not_hidden():
    async def broken(scope, receive, send):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        ask(Gate(broken, PORT, TOKEN))


@pytest.mark.parametrize("cookie", [COOKIE, None])
def test_every_answer_forbids_other_hosts_and_frames(guard, cookie):
    headers = ask(guard, cookie=cookie).headers
    policy = dict(part.split(" ", 1) for part in headers["content-security-policy"].split("; "))
    assert policy["default-src"] == "'self'"
    assert policy["frame-ancestors"] == "'none'"
    assert policy["connect-src"].split() == ["'self'", "data:", "blob:", f"ws://{HERE}", f"ws://localhost:{PORT}"]
    assert "http" not in "".join(policy.values())
    assert headers["referrer-policy"] == "no-referrer"
    assert headers["x-content-type-options"] == "nosniff"
    assert headers["cross-origin-resource-policy"] == "same-origin"


def test_the_lifespan_goes_through():
    heard = []

    async def app(scope, receive, send):
        heard.append(scope["type"])

    asyncio.run(Gate(app, PORT, TOKEN)({"type": "lifespan"}, None, None))
    assert heard == ["lifespan"]
