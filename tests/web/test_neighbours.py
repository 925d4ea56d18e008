"""The app beside strangers on the same machine: servers of other ports, pages of theirs in the same browser."""

from __future__ import annotations

import json
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import httpx
import pytest

pytestmark = pytest.mark.xdist_group("browser")
expect = pytest.importorskip("playwright.sync_api", reason="the tests in a browser need playwright").expect

PATIENCE = 60.0
# what a page of another port can try: everything that a browser lets it ask, and what it can read of the answers
TRIES = """async (origin) => {
    const seen = {cookie: document.cookie, stored: {...localStorage}, referrer: document.referrer, answers: []};
    const paths = ["/", "/?page=x", "/?token=x", "/favicon.ico", "/_nicegui_ws/socket.io/?EIO=4&transport=polling"];
    for (const mode of ["cors", "no-cors"])
        for (const method of ["GET", "POST"])
            for (const path of paths) {
                const asked = fetch(origin + path, {mode, method, credentials: "include"});
                seen.answers.push(await asked.then((answer) => answer.text(), (error) => ""));
            }
    seen.socket = await new Promise((done) => {
        const path = "/_nicegui_ws/socket.io/?EIO=4&transport=websocket";
        const socket = new WebSocket(origin.replace("http", "ws") + path);
        socket.onopen = () => done("open");
        socket.onerror = () => done("closed");
    });
    seen.frame = await new Promise((done) => {
        const frame = document.body.appendChild(document.createElement("iframe"));
        frame.onload = () => { try { done(frame.contentDocument?.body.innerText ?? "") } catch { done("") } };
        frame.src = origin;
    });
    seen.script = await new Promise((done) => {
        const script = document.createElement("script");
        script.onload = () => done("loaded");
        script.onerror = () => done("refused");
        script.src = origin + "/";
        document.head.append(script);
    });
    const opened = window.open(origin);
    await new Promise((done) => setTimeout(done, 1500));
    try { seen.opened = opened?.document?.body?.innerText ?? "" } catch { seen.opened = "" }
    return seen;
}"""


class Neighbour(ThreadingHTTPServer):
    """Serves another port of this machine; keeps all that browsers send it."""

    def __init__(self):
        self.heard = []
        heard = self.heard

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self):
                heard.append((self.path, list(self.headers.items())))
                self.send_response(200)
                self.send_header("content-type", "text/html")
                self.end_headers()
                self.wfile.write(b"<!doctype html><title>neighbour</title><link rel=icon href='data:,'><body>")

            def log_message(self, *_):
                pass

        super().__init__(("127.0.0.1", 0), Handler)
        threading.Thread(target=self.serve_forever, daemon=True).start()

    @property
    def port(self):
        return self.server_address[1]


@pytest.fixture
def neighbour():
    server = Neighbour()
    yield server
    server.shutdown()
    server.server_close()


@pytest.fixture
def secrets_of():
    """What nobody else may see of an opened page: the token, the key, the numbers of client and tab."""

    def found(server, page):
        client, tab = page.evaluate("[window.clientId, sessionStorage.__nicegui_tab_id]")
        key = page.evaluate("window.path_prefix").strip("/")
        assert len(key) == 32
        return [server.address.partition("token=")[2], key, client, tab]

    return found


def planned(page):
    expect(page.get_by_test_id("reversals")).to_have_text("0", timeout=120_000)


def test_a_server_of_another_port_gets_nothing_and_can_do_nothing(demo, open_page, neighbour, secrets_of):
    page = open_page(demo)
    planned(page)
    page.expected += [f"asked for http://{host}:{neighbour.port}" for host in ("127.0.0.1", "localhost")]
    assert page.context.cookies() == []
    hidden = secrets_of(demo, page)
    for host in ("127.0.0.1", "localhost"):
        stranger = page.context.new_page()
        stranger.goto(f"http://{host}:{neighbour.port}/")
        seen = stranger.evaluate(TRIES, demo.origin)
        assert (seen["cookie"], seen["stored"], seen["referrer"]) == ("", {}, "")
        assert set(seen["answers"]) == {""}
        assert (seen["socket"], seen["script"]) == ("closed", "refused")
        assert (seen["frame"], seen["opened"]) == ("", "")
        assert not any(secret in json.dumps(seen) for secret in hidden)
    # from our own page to theirs, as by a link
    page.evaluate("address => window.open(address)", f"http://127.0.0.1:{neighbour.port}/linked")
    page.wait_for_timeout(500)
    assert "/linked" in [path for path, _ in neighbour.heard]
    said = json.dumps(neighbour.heard)
    assert not any(secret in said for secret in hidden)
    for path, headers in neighbour.heard:
        names = {name.lower() for name, _ in headers}
        assert not names & {"cookie", "authorization", "referer"}, path
        replay(demo, dict(headers))
    page.reload()
    planned(page)


def replay(server, headers):
    """What a program can do that has got all of a browser's headers, and forges the rest."""
    forged = {**headers, "Host": server.origin.removeprefix("http://"), "Origin": server.origin}
    with httpx.Client(base_url=server.origin, timeout=PATIENCE, trust_env=False, headers=forged) as client:
        for path in ("/", "/?page=", "/_nicegui_ws/socket.io/?EIO=4&transport=polling", "/_nicegui/client/x/upload/1"):
            for method in ("GET", "POST"):
                answer = client.request(method, path)
                assert answer.status_code == 403 or (path.startswith("/?") or path == "/"), path
                assert "createApp" not in answer.text
                assert "location" not in answer.headers


def test_a_cookie_that_a_neighbour_sets_changes_nothing(demo, open_page, neighbour):
    page = open_page(demo)
    planned(page)
    port = demo.origin.rpartition(":")[2]
    names = ("zerorev-key", f"zerorev-{port}", "key")
    page.context.add_cookies([{"name": name, "value": "x", "url": f"http://127.0.0.1:{port}"} for name in names])
    page.reload()
    planned(page)


def test_the_address_is_bare_and_stays_usable(demo, open_page):
    page = open_page(demo)
    planned(page)
    assert page.url == f"{demo.origin}/"
    page.reload()
    planned(page)
    typed = page.context.new_page()
    typed.goto(demo.origin)  # without a token, in the same browser
    planned(typed)
    typed.goto(demo.address)
    planned(typed)
    assert typed.url == f"{demo.origin}/"


def test_a_browser_that_never_had_the_token_stands_at_the_door(demo, open_page):
    page = open_page(demo, address=demo.origin)
    expect(page.get_by_test_id("door")).to_contain_text("the address that `zerorev view` printed")
    page.expected += ["403"]
    page.goto(demo.origin + "/?token=wrong")
    expect(page.get_by_test_id("door")).to_contain_text("the address that `zerorev view` printed")
    page.evaluate("localStorage['zerorev-key'] = 'a key of yesterday'")
    page.goto(demo.origin)
    expect(page.get_by_test_id("door")).to_contain_text("the address that `zerorev view` printed")


def test_a_doubled_tab_continues_on_its_own(demo, open_page):
    page = open_page(demo)
    planned(page)
    page.get_by_test_id("holes").get_by_text("position_2").first.click()
    expect(page.get_by_test_id("page")).to_contain_text("hole 2 of 3")
    with page.expect_popup() as opened:
        page.evaluate("void window.open('/')")  # takes the storage of the tab along, as doubling it does
    double = opened.value
    expect(double.get_by_test_id("page")).to_contain_text("hole 2 of 3", timeout=60_000)
    double.get_by_test_id("holes").get_by_text("position_3").first.click()
    expect(double.get_by_test_id("page")).to_contain_text("hole 3 of 3")
    expect(page.get_by_test_id("page")).to_contain_text("hole 2 of 3")


def test_two_users_share_nothing(serve, demo, open_page, secrets_of):
    other = serve()
    pages = [open_page(server) for server in (demo, other)]
    for page in pages:
        planned(page)
    (token, key, client, tab), theirs = (
        secrets_of(server, page) for server, page in zip((demo, other), pages, strict=True)
    )
    assert not {token, key, client, tab} & set(theirs)
    with httpx.Client(base_url=other.origin, timeout=PATIENCE, trust_env=False) as stranger:
        assert stranger.get("/", params={"token": token}).status_code == 403
        assert stranger.get(f"/{key}/_nicegui_ws/socket.io/?EIO=4&transport=polling").status_code == 403
        shown = {"origin": other.origin, "x-zerorev-key": key}
        assert stranger.post("/", headers=shown).status_code == 403
    pages[0].get_by_test_id("holes").get_by_text("position_2").first.click()
    expect(pages[0].get_by_test_id("page")).to_contain_text("hole 2 of 3")
    expect(pages[1].get_by_test_id("page")).to_contain_text("hole 1 of 3")
