"""Files in the browser: read beside the page, with any content; and as large as the command line takes them."""

from __future__ import annotations

import json
import time

import pytest

from zerorev.files.io import job_from_text, write_plan
from zerorev.planning.job import plan_job

pytestmark = pytest.mark.xdist_group("browser")
expect = pytest.importorskip("playwright.sync_api", reason="the tests in a browser need playwright").expect

JOB = """\
robot: kuka_kr6_r700_2
tool: thesis_drill
holes:
  - {id: first, target_mm: [500, 300, 800], direction: [1, 0, 0], depth_mm: 20}
  - {id: second, target_mm: [500, 300, 790], direction: [1, 0, 0], depth_mm: 20}
"""
# takes long to check
MANY_EMPTY = b'{"format": "zerorev.plan/1", "holes": [' + b"{}," * 100_000 + b"{}]}"


def uploaded(page, name, content):
    """Pick a file, given by its content or its path, in the browser's dialog."""
    page.get_by_test_id("open").click()
    with page.expect_file_chooser() as waiting:
        page.get_by_test_id("open-file").click()
    in_memory = isinstance(content, bytes)
    waiting.value.set_files({"name": name, "mimeType": "text/plain", "buffer": content} if in_memory else content)


@pytest.fixture
def ready(demo_page):
    expect(demo_page.get_by_test_id("reversals")).to_have_text("0", timeout=120_000)
    return demo_page


def test_a_job_is_uploaded(ready):
    uploaded(ready, "mine.yaml", JOB.encode())
    expect(ready.get_by_test_id("page")).to_contain_text("hole 1 of 2")
    expect(ready.get_by_test_id("waiting")).to_have_count(0)
    uploaded(ready, "bad.yaml", b"robot: [")
    expect(ready.get_by_role("alert").filter(has_text="bad.yaml, line ")).to_be_visible()
    expect(ready.get_by_test_id("page")).to_contain_text("hole 1 of 2")


def test_a_file_that_is_long_to_read_holds_up_nobody(ready, open_page, demo, say):
    """Neither its own page nor another, until it is refused."""
    other = open_page(demo)
    expect(other.get_by_test_id("reversals")).to_have_text("0", timeout=120_000)
    uploaded(ready, "empty.json", MANY_EMPTY)
    waits = []
    for page in (other, ready):
        asked = time.perf_counter()
        page.get_by_test_id("holes").get_by_text("position_2").first.click()
        expect(page.get_by_test_id("page")).to_contain_text("hole 2 of 3")
        waits.append(time.perf_counter() - asked)
    say(f"while a hostile file is read, a click on a hole shows it within {max(waits):.2f} s")
    expect(ready.get_by_test_id("waiting")).to_have_count(0)
    expect(ready.get_by_role("alert").filter(has_text="empty.json")).to_be_visible()
    expect(ready.get_by_test_id("page")).to_contain_text("hole 2 of 3")
    ready.reload()
    expect(ready.get_by_test_id("page")).to_contain_text("hole 2 of 3")


def test_ten_thousand_rows_are_pasted_beside_the_page(ready, say):
    ready.get_by_test_id("paste").click()
    rows = [f"p{n},{400 + n % 100},{n // 100},700,1,0,0,20" for n in range(10_000)]
    began = time.perf_counter()
    with ready.expect_file_chooser() as waiting:
        ready.get_by_test_id("paste-file").click()
    waiting.value.set_files({"name": "a.csv", "mimeType": "text/csv", "buffer": "\n".join([*rows, "bad"]).encode()})
    expect(ready.get_by_test_id("paste-verdict")).to_have_text("10000 good, 1 not; only the good ones are taken")
    say(f"10,000 rows of a CSV file: shown as understood after {time.perf_counter() - began:.1f} s")
    expect(ready.get_by_test_id("paste-rows")).to_contain_text("and 9801 rows more")
    ready.get_by_test_id("form-done").click()
    expect(ready.get_by_test_id("holes-shown")).to_have_text("10003 holes")


MANY = 10_000
# how long [ms] it takes until the page shows a hole and has drawn it
SHOWN = """number => new Promise((done) => {
    const began = performance.now(), page = document.querySelector('[data-testid="page"]');
    const look = () => page.textContent.includes(`hole ${number} of`)
        ? requestAnimationFrame(() => setTimeout(() => done(performance.now() - began))) : requestAnimationFrame(look);
    look();
})"""


# how long [ms] a frame of the cell takes with the holes and without, the quickest of five each
FRAMES = """() => {
    const { renderer, scene, camera, holes } = document.querySelector('[data-testid="cell"]').cell;
    const context = renderer.getContext(), pixel = new Uint8Array(4);
    const frame = (seen) => {
        holes.root.visible = seen;
        const began = performance.now();
        renderer.render(scene, camera);
        context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, pixel);
        return performance.now() - began;
    };
    const quickest = (seen) => Math.min(...Array.from({ length: 5 }, () => frame(seen)));
    const without = quickest(false);
    return [quickest(true), without];
}"""


@pytest.fixture(scope="module")
def large_plan(tmp_path_factory):
    """A plan of 30 MB: one hole's answer under ten thousand names."""
    path = tmp_path_factory.mktemp("large") / "large.plan.json"
    one = JOB.replace("  - {id: second, target_mm: [500, 300, 790], direction: [1, 0, 0], depth_mm: 20}\n", "")
    write_plan(plan_job(job_from_text(one, "one.yaml")), path)
    data = json.loads(path.read_text())
    (answer,) = data["holes"]
    data["holes"] = [answer | {"id": f"h{n:05d}"} for n in range(MANY)]
    data |= {"order": None, "transitions": None, "cycle_time_s": None}  # they are of the one hole
    path.write_text(json.dumps(data, indent=1))
    assert path.stat().st_size > 25e6
    return path


@pytest.mark.long
def test_ten_thousand_holes_are_usable_from_a_path_and_from_an_upload(serve, open_page, large_plan, say):
    began = time.perf_counter()
    server = serve(large_plan)
    page = open_page(server)
    expect(page.get_by_test_id("holes-shown")).to_have_text("10000 holes", timeout=60_000)
    say(f"10,000 planned holes, a plan of {large_plan.stat().st_size / 1e6:.0f} MB: "
        f"{time.perf_counter() - began:.1f} s from the command to the table")  # fmt: skip
    expect(page.get_by_test_id("curves")).to_contain_text("A1", timeout=60_000)
    page.get_by_test_id("holes").get_by_text("h00000").first.click()
    times = []
    for number in range(2, 8):
        page.wait_for_timeout(500)
        page.evaluate(f"void (window.shown = ({SHOWN})({number}))")
        page.keyboard.press("ArrowDown")
        times.append(page.evaluate("window.shown"))
    say(f"10,000 holes: the next is drawn after {min(times):.0f} to {max(times):.0f} ms")
    assert min(times) < 1000
    drawn, empty = page.evaluate(FRAMES)
    say(f"10,000 holes: a frame of the cell takes {drawn:.0f} ms without a graphics card, {empty:.0f} ms without holes")
    assert drawn < 5 * empty
    uploaded(page, large_plan.name, large_plan)
    page.locator(".q-notification").get_by_text("Cancel").click()
    expect(page.get_by_test_id("waiting")).to_have_count(0)
    uploaded(page, large_plan.name, large_plan)
    expect(page.get_by_test_id("waiting")).to_contain_text("Reading")
    page.get_by_test_id("hole-next").click()
    expect(page.get_by_test_id("page")).to_contain_text("hole 8 of 10000")
    expect(page.get_by_test_id("waiting")).to_have_count(0, timeout=120_000)
    expect(page.get_by_test_id("page")).to_contain_text("hole 1 of 10000", timeout=60_000)
    expect(page.get_by_test_id("holes-shown")).to_have_text("10000 holes", timeout=60_000)
