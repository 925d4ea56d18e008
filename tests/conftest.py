"""What many tests start from: the thesis' robot, tool and positions, and every robot that ships."""

from __future__ import annotations

import os
import shutil
import signal

import pytest
from hypothesis import settings

from oracles.published import POSITIONS, Position
from robots import TRIED
from zerorev.files.io import read_robot, read_tool

if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:  # started in the background: what tests start would inherit it
    signal.signal(signal.SIGINT, signal.default_int_handler)

FLAGS = (
    "--no-sandbox", "--enable-unsafe-swiftshader", "--disable-gpu-compositing", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
)  # fmt: skip
WITHIN = 20_000  # [ms] an expectation waits

settings.register_profile("deterministic", derandomize=True, deadline=None, database=None, max_examples=50)
settings.load_profile("deterministic")


def pytest_terminal_summary(terminalreporter):
    """Tell the figures that tests have measured, which go with their reports, also from the processes of xdist."""
    reports = [report for kind in terminalreporter.stats.values() for report in kind]
    reported = [
        text
        for report in reports
        for name, text in getattr(report, "user_properties", ())
        if name == "measured" and report.when == "call"
    ]
    if reported:
        terminalreporter.section("measured")
        for text in reported:
            terminalreporter.write_line(text)


@pytest.fixture(scope="session", autouse=True)
def checked_files(tmp_path_factory):
    """The folder in which it is kept which plan files were checked: never the user's own."""
    folder = tmp_path_factory.mktemp("cache") / "checked"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("zerorev.files.checked_files._folder", lambda: folder)
        yield folder


@pytest.fixture(scope="session")
def robot():
    """KR 6 R700-2, the thesis' robot."""
    return read_robot("kuka_kr6_r700_2")


@pytest.fixture(scope="session")
def tool():
    """The thesis' drill."""
    return read_tool("thesis_drill")


@pytest.fixture(scope="session")
def positions():
    """Positions 1 to 3 of the thesis."""
    return POSITIONS


@pytest.fixture(params=POSITIONS, ids=lambda position: position.name)
def position(request) -> Position:
    """Each of the three published positions."""
    return request.param


@pytest.fixture(params=TRIED, scope="session")
def any_robot(request):
    """Robots of each maker."""
    return read_robot(request.param)


@pytest.fixture(scope="session")
def chromium_path() -> str:
    """Where chromium is; a machine without it skips these tests, but CI does not."""
    found = shutil.which("chromium") or shutil.which("chromium-browser")
    if found is None:
        message = "no chromium is installed (Debian: apt-get install chromium), so no page is tested in a browser"
        pytest.fail(message) if os.environ.get("CI") else pytest.skip(message)
    return found


@pytest.fixture(scope="module")
def browser(chromium_path):
    """A browser without a window, of one test file: while it is there, no other event loop may run in the process."""
    from playwright.sync_api import expect, sync_playwright

    expect.set_options(timeout=WITHIN)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium_path, args=list(FLAGS))
        yield browser
        browser.close()
