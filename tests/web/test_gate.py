"""The gate: nothing of the app answers but to its own page, which was opened with the token."""

from __future__ import annotations

import asyncio

import pytest

from zerorev.web import gate
from zerorev.web.gate import Gate

PORT, TOKEN, ONCE = 8123, "a-token-that-lasts", "a-token-for-once"
HERE = f"127.0.0.1:{PORT}"


async def behind(scope, receive, send):
    """An app that reads the whole of what it is sent, and says how much that was, and where it was asked."""
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.accept", "path": scope["path"], "query": scope["query_string"]})
        return
    length, more = 0, True
    while more:
        message = await receive()
        if message["type"] == "http.disconnect":
            raise ConnectionError("the client has gone")
        length += len(message["body"])
        more = message.get("more_body", False)
    await send({"type": "http.response.start", "status": 200, "headers": [(b"x-mine", b"1")], "scope": scope})
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
    guard,
    method="GET",
    path="/{key}/app",
    query="",
    *,
    host=HERE,
    origin=None,
    kind="http",
    body=(b"",),
    more=(),
    gone=False,
):
    """Ask something through the gate, behind it or at its door."""
    path = path.replace("{key}", guard.key)
    headers = [(b"host", host.encode())] if host else []
    headers += [(b"origin", origin.encode())] if origin else []
    scope = {"type": kind, "path": path, "raw_path": path.encode(), "query_string": query.encode()}
    scope["headers"] = [*headers, *more]
    if kind == "http":
        scope["method"] = method
    pieces = list(body)
    sent = []

    async def receive():
        if kind == "websocket":
            return {"type": "websocket.connect"}
        if not pieces:
            return {"type": "http.disconnect"}
        return {"type": "http.request", "body": pieces.pop(0), "more_body": bool(pieces) or gone}

    async def send(message):
        sent.append(message)

    asyncio.run(guard(scope, receive, send))
    return Asked(sent)


def shown(key):
    """A header in which the door shows a key."""
    return [(gate.SHOWN_IN.encode(), key.encode())]


@pytest.fixture
def guard():
    """A gate before an app that answers everything."""
    return Gate(behind, PORT, TOKEN, ONCE)


@pytest.fixture
def clock(monkeypatch):
    """The time that the gate reads [s]."""
    now = [1000.0]
    monkeypatch.setattr(gate.time, "monotonic", lambda: now[0])
    return now


def served(answer):
    """Whether an answer is of the app behind."""
    return answer.status == 200 and "x-mine" in answer.headers


def test_the_token_leads_to_a_page_that_is_served_once(guard):
    answer = ask(guard, path="/", query=f"token={TOKEN}")
    assert answer.status == 303
    path, _, ticket = answer.headers["location"].partition("?")
    assert path == "/"
    assert TOKEN not in ticket
    assert guard.key not in ticket
    assert answer.headers["cache-control"] == "no-store"
    assert "set-cookie" not in answer.headers
    page = ask(guard, path="/", query=ticket)
    assert served(page)
    scope = page.sent[0]["scope"]
    assert (scope["path"], scope["raw_path"], scope["query_string"]) == ("/", b"/", b"")
    again = ask(guard, path="/", query=ticket)
    assert not served(again)
    assert guard.key not in again.body


def test_the_door_holds_no_secret(guard):
    for answer in (ask(guard, path="/"), ask(guard, path="/", query="page=x"), ask(guard, path="/", query="token=x")):
        assert not served(answer)
        assert "<script>" in answer.body
        assert not any(secret in answer.body for secret in (guard.key, TOKEN, ONCE))
        assert answer.headers["connection"] == "close"
    assert ask(guard, path="/").status == 200


def test_the_door_gives_a_ticket_for_the_key(guard):
    ours = f"http://{HERE}"
    ticket = ask(guard, "POST", "/", origin=ours, more=shown(guard.key)).body
    assert served(ask(guard, path="/", query=f"page={ticket}"))
    for wrong in ("", "x", TOKEN, ticket, guard.key[:-1], "ü"):
        assert ask(guard, "POST", "/", origin=ours, more=shown(wrong)).status == 403
    assert ask(guard, "POST", "/", origin=ours, more=shown(guard.key) * 2).status == 403
    for origin in (None, "null", "http://127.0.0.1:9999"):
        assert ask(guard, "POST", "/", origin=origin, more=shown(guard.key)).status == 403


def test_a_ticket_lasts_a_minute_and_there_are_not_many(guard, clock):
    def tickets(count):
        return [ask(guard, path="/", query=f"token={TOKEN}").headers["location"][2:] for _ in range(count)]

    early, late = tickets(1)[0], tickets(1)[0]
    clock[0] += gate.TICKET_LASTS - 1
    assert served(ask(guard, path="/", query=early))
    clock[0] += 2
    assert not served(ask(guard, path="/", query=late))
    many = tickets(gate.MOST_TICKETS + 1)
    assert not served(ask(guard, path="/", query=many[0]))
    assert served(ask(guard, path="/", query=many[1]))


@pytest.mark.parametrize(
    "path",
    ["/app", "//app", "/x/app", f"/{TOKEN}/app", "/{key}", "/{key}x/app", "//{key}/app", "/x/{key}/app", "/favicon.ico",
     "/_nicegui/3.18.0/static/nicegui.js", "/_nicegui_ws/socket.io/", "", "*", "/%00/"],
)  # fmt: skip
def test_nothing_is_answered_without_the_key(guard, path):
    answer = ask(guard, path=path)
    assert (answer.status, answer.body) == (403, f"{gate.NO_TOKEN}\n")
    assert ask(guard, "POST", path, origin=f"http://{HERE}").status == 403
    assert ask(guard, kind="websocket", path=path, origin=f"http://{HERE}").status == "websocket.close"
    cookies = [(b"cookie", f"zerorev-{PORT}={guard.key}; zerorev-key={guard.key}".encode())]
    assert ask(guard, path=path, more=cookies).status == 403


def test_what_is_behind_knows_the_gate_by_its_prefix_alone(guard):
    forged = [(b"X-Forwarded-Prefix", b"/evil"), (b"x-forwarded-for", b"1.2.3.4")]
    answer = ask(guard, path="/{key}/a/b", query="c=d", more=forged)
    scope = answer.sent[0]["scope"]
    assert (scope["path"], scope["raw_path"], scope["query_string"]) == ("/a/b", b"/a/b", b"c=d")
    prefixes = [value for name, value in scope["headers"] if name.lower().startswith(b"x-forwarded")]
    assert prefixes == [f"/{guard.key}".encode()]
    socket = ask(guard, kind="websocket", path="/{key}/ws", query="c=d", origin=f"http://{HERE}")
    assert (socket.sent[0]["path"], socket.sent[0]["query"]) == ("/ws", b"c=d")


@pytest.mark.parametrize("query", ["token=wrong", "token=%00", "token=" + TOKEN[:-1], "token=%C3%BC"])
def test_a_wrong_token_opens_nothing(guard, query):
    assert ask(guard, path="/", query=query).status == 403


@pytest.mark.parametrize("query", ["", "token=", "tokens=" + TOKEN, "page=", "page=" + TOKEN])
def test_without_a_token_there_is_the_door_alone(guard, query):
    assert not served(ask(guard, path="/", query=query))


def test_the_token_counts_at_the_door_alone(guard):
    query, ours = f"token={TOKEN}", f"http://{HERE}"
    assert ask(guard, path="/x/_nicegui_ws/socket.io/", query=query).status == 403
    assert ask(guard, "POST", "/", query=query, origin=ours).status == 403
    assert ask(guard, kind="websocket", path="/", query=query, origin=ours).status == "websocket.close"


def test_the_address_that_a_browser_is_started_with_opens_once(guard):
    asked = [ask(guard, path="/", query=f"token={token}").status for token in (ONCE, ONCE, TOKEN, TOKEN)]
    assert asked == [303, 403, 303, 303]


def test_two_gates_have_two_keys(guard):
    other = Gate(behind, PORT, TOKEN)
    assert other.key != guard.key
    assert ask(guard, path=f"/{other.key}/app").status == 403


def test_the_page_has_its_browser_keep_the_key():
    assert '= "k-e_y";' in gate.keeping("/k-e_y")
    assert "history.replaceState" in gate.keeping("/k-e_y")


@pytest.mark.parametrize(
    "host",
    ["", "evil.example", f"evil.example:{PORT}", "127.0.0.1", "127.0.0.1:80", f"127.0.0.1.evil.example:{PORT}",
     f"localhost:{PORT}", f"[::1]:{PORT}"],
)  # fmt: skip
@pytest.mark.parametrize("kind", ["http", "websocket"])
def test_another_name_for_this_machine_is_refused(guard, host, kind):
    answer = ask(guard, host=host, kind=kind, origin=f"http://{host}" if kind == "websocket" else None)
    assert answer.status == (403 if kind == "http" else "websocket.close")
    if kind == "http":
        assert ask(guard, path="/", query=f"token={TOKEN}", host=host).status == 403


def test_two_hosts_are_none(guard):
    assert ask(guard, more=[(b"host", HERE.encode())]).status == 403


def test_our_own_page_may_post_and_open_sockets(guard):
    assert ask(guard, "POST", origin=f"http://{HERE}", body=(b"ab", b"c")).body == "3"
    assert ask(guard, kind="websocket", origin=f"http://{HERE}").status == "websocket.accept"


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


def test_whoever_goes_while_sending_is_not_a_fault(guard):
    with pytest.raises(IndexError):  # nobody is there to be answered
        ask(guard, "POST", origin=f"http://{HERE}", body=(b"ab",), gone=True)


def test_a_fault_of_the_app_is_not_hidden():
    async def broken(scope, receive, send):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        ask(Gate(broken, PORT, TOKEN))


@pytest.mark.parametrize("path", ["/{key}/app", "/", "/x"])
def test_every_answer_forbids_other_hosts_and_frames(guard, path):
    headers = ask(guard, path=path).headers
    policy = dict(part.split(" ", 1) for part in headers["content-security-policy"].split("; "))
    assert policy["default-src"] == "'self'"
    assert policy["frame-ancestors"] == "'none'"
    assert policy["connect-src"].split() == ["'self'", "data:", "blob:", f"ws://{HERE}"]
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
