"""The app as a user meets it: in a real browser, from the demo to the robot program."""

from __future__ import annotations

import re
import time
from importlib import resources

import numpy as np
import pytest

import zerorev as zr
from oracles.page_moves import DRAWN, MOVES
from zerorev.cli import main
from zerorev.cli.common import FINE
from zerorev.files.io import job_from_text, plan_from_text
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluate
from zerorev.motion.loads import lost_motion
from zerorev.report.scene.load_lines import senses
from zerorev.report.scene.twist_map import twist_map

pytestmark = pytest.mark.xdist_group("browser")
expect = pytest.importorskip("playwright.sync_api", reason="the tests in a browser need playwright").expect

DEMO = (resources.files("zerorev.web") / "demo.yaml").read_text(encoding="utf-8")
# how often the map has got a size: once as soon as it is watched
SIZED = """() => {
    window.sized = 0;
    new ResizeObserver(() => window.sized++).observe(document.querySelector(".zr-tw-plot"));
}"""

# whether the table of a thousand holes stands
STANDS = """() => {
    const text = (name) => document.querySelector(`[data-testid="${name}"]`)?.textContent ?? "";
    return text("holes-shown") === "1000 holes" && text("holes").includes("h0000");
}"""

# whether as many reversals are marked of each joint
MARKED = """wanted => {
    const marked = wanted.map(() => 0);
    for (const mark of document.querySelectorAll('[data-testid="reversal-mark"]')) marked[mark.dataset.joint - 1]++;
    return String(marked) === String(wanted);
}"""


@pytest.fixture(scope="module")
def job():
    """The demo."""
    return job_from_text(DEMO, "demo.yaml")


@pytest.fixture(scope="module")
def planned(job):
    """Position 1 of the demo as the library plans it."""
    return zr.plan(job.robot, job.tool, job.holes[0], job.settings)


@pytest.fixture
def ready(demo_page):
    """The page of the demo, its first hole planned, and drawn to its last piece."""
    expect(demo_page.get_by_test_id("reversals")).to_have_text("0", timeout=120_000)
    expect(demo_page.get_by_test_id("curves")).to_contain_text("→ 0")
    return demo_page


def spins(page):
    """Spins [deg] at start, target and end, as the handles state them."""
    return [float(page.get_by_test_id(f"handle-{name}").get_attribute("aria-valuenow")) for name in NAMES]


NAMES = ("start", "target", "end")
CELL = "document.querySelector('[data-testid=\"cell\"]')?.cell"


def score(job, planned, psi_deg):
    """What the library says of position 1 with these spins, on the planned branch; None where it cannot be run."""
    hole = job.holes[0]
    profile = Profile.straight(hole.depth, *np.deg2rad(psi_deg).tolist())
    return evaluate(job.robot, job.tool, hole, profile, planned.motion.branch, job.settings).score


def turning(job, planned, joint):
    """By how much [deg] the spin at the target is to be moved for a joint (1..6) to reverse, well on that side."""
    start, target, end = np.rad2deg(planned.motion.profile.psi)

    def counts(by):
        found = score(job, planned, (start, target + by, end))
        return None if found is None else found.reversals_per_joint

    for by in np.arange(2.0, 60.0, 1.0):
        for sign in (1, -1):
            here, beyond = counts(sign * by), counts(sign * (by + 2))
            if here is not None and here[joint - 1] and here == beyond:
                return sign * (by + 1)
    raise AssertionError(f"nothing makes joint {joint} reverse")


def grip(page, name):
    """The middle of a handle [px]."""
    box = page.get_by_test_id(f"handle-{name}").locator("circle").bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def pixels_per_degree(page):
    """How far downwards a degree of spin is, from two handles."""
    first, _, last = spins(page)
    return (grip(page, "end")[1] - grip(page, "start")[1]) / (last - first)


def drag_target(page, by, steps):
    """Move the point at the target by so many degrees, with the mouse, and hold it."""
    x, y = grip(page, "target")
    to = y + by * pixels_per_degree(page)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x, to, steps=steps)


def saved(page, click):
    """What is downloaded upon a click: its name and its bytes."""
    with page.expect_download(timeout=120_000) as waiting:
        click()
    return waiting.value.suggested_filename, waiting.value.path().read_bytes()


def from_menu(page, entry):
    page.get_by_test_id("download").click()
    page.get_by_test_id(entry).click()


def of_some(page, entry):
    """The same while holes are not planned yet, which is to be confirmed."""
    from_menu(page, entry)
    page.get_by_test_id("save-incomplete").click()


def test_the_demo_shows_zero_reversals(ready, planned):
    assert planned.score.reversals == 0
    expect(ready.get_by_test_id("reversal-mark")).to_have_count(0)
    expect(ready.get_by_test_id("summary-reversals")).to_contain_text("0")
    expect(ready.get_by_test_id("summary-reversals")).to_contain_text(str(planned.baseline.reversals))
    np.testing.assert_allclose(spins(ready), np.rad2deg(planned.motion.profile.psi), atol=0.006)


def test_from_a_drag_that_reverses_joint_4_to_the_program_of_the_command_line(ready, job, planned, tmp_path):
    drag_target(ready, turning(job, planned, 4), steps=12)
    expect(ready.get_by_test_id("reversals")).not_to_have_text("0")
    ready.mouse.up()
    expect(ready.get_by_test_id("keep-this-motion")).to_be_visible()
    wanted = score(job, planned, spins(ready))
    assert wanted.reversals_per_joint[3] >= 1
    expect(ready.get_by_test_id("reversals")).to_have_text(str(wanted.reversals))
    expect(ready.get_by_test_id("reversal-mark")).to_have_count(wanted.reversals)
    ready.wait_for_function(MARKED, arg=list(wanted.reversals_per_joint))  # not those of a move before the last
    expect(ready.get_by_test_id("summary-reversals")).to_contain_text(str(wanted.reversals))

    ready.get_by_test_id("plan").click()
    expect(ready.get_by_test_id("reversals")).to_have_text("0")
    expect(ready.get_by_test_id("reversal-mark")).to_have_count(0)

    ready.get_by_test_id("scope").get_by_text("All holes").click()
    ready.get_by_test_id("plan").click()
    expect(ready.get_by_test_id("outcome")).to_be_visible(timeout=120_000)
    _, plan = saved(ready, lambda: from_menu(ready, "download-plan"))
    from_menu(ready, "download-program")
    expect(ready.get_by_test_id("preflight")).to_be_visible()
    name, program = saved(ready, lambda: ready.get_by_test_id("save-program").click())

    (tmp_path / "demo.yaml").write_text(DEMO)
    assert main(["plan", str(tmp_path / "demo.yaml"), "-o", str(tmp_path / "plan.json")]) == FINE
    assert main(["export", str(tmp_path / "plan.json"), "--controller", "krl", "-o", str(tmp_path / name)]) == FINE
    assert plan == (tmp_path / "plan.json").read_bytes()
    exported = (tmp_path / name).read_bytes().splitlines(keepends=True)
    # the page has no file that the plan is in
    assert program == b"".join(line for line in exported if not line.startswith(b"; Plan file "))


def test_a_drag_is_taken_back_and_made_again(ready, job, planned):
    """By keys, with the focus on any element; and what the plan says of its margin is not said of a motion by hand."""
    before, bar = spins(ready), ready.locator(".zr-figures")
    expect(ready.get_by_test_id("undo")).to_be_disabled()
    assert re.search(r"margin\s*\+40\.8", bar.inner_text())
    drag_target(ready, turning(job, planned, 4), steps=6)
    ready.mouse.up()
    expect(ready.get_by_test_id("keep-this-motion")).to_be_visible()
    expect(bar).to_contain_text(re.compile(r"margin\s*–"))
    after = spins(ready)
    ready.keyboard.press("Control+z")
    expect(ready.get_by_test_id("handle-target")).to_have_attribute("aria-valuenow", f"{before[1]:.2f}")
    expect(ready.get_by_test_id("keep-this-motion")).to_be_hidden()
    expect(bar).to_contain_text(re.compile(r"margin\s*\+40\.8"))
    ready.evaluate("document.activeElement.blur()")
    ready.keyboard.press("Control+Shift+Z")
    expect(ready.get_by_test_id("handle-target")).to_have_attribute("aria-valuenow", f"{after[1]:.2f}")
    ready.get_by_test_id("handle-target").focus()
    ready.keyboard.press("Shift+ArrowUp")
    ready.keyboard.press("Control+z")  # at once: also before the key counts as let go
    expect(ready.get_by_test_id("handle-target")).to_have_attribute("aria-valuenow", f"{after[1]:.2f}")
    expect(ready.get_by_test_id("redo")).to_be_enabled()
    ready.get_by_test_id("undo").click()
    expect(ready.get_by_test_id("keep-this-motion")).to_be_hidden()
    ready.keyboard.press("Control+y")
    expect(ready.get_by_test_id("handle-target")).to_have_attribute("aria-valuenow", f"{after[1]:.2f}")


def test_dragging_is_answered_to_the_last_move(ready, job, planned, say):
    ready.evaluate(DRAWN)
    ready.evaluate(SIZED)
    x, y = grip(ready, "target")
    scale = pixels_per_degree(ready)
    ready.mouse.move(x, y)
    ready.mouse.down()
    ready.evaluate(MOVES, [x, y, 15 * scale, 150])
    ready.wait_for_function("window.drawn.length > 0")
    ready.mouse.up()
    expect(ready.get_by_test_id("keep-this-motion")).to_be_visible()
    last = spins(ready)
    assert abs(last[1] - np.rad2deg(planned.motion.profile.psi[1])) > 10
    wanted = score(job, planned, last)
    expect(ready.get_by_test_id("reversals")).to_have_text(str(wanted.reversals))
    # the handles state hundredths of a degree, the travel tenths, of spins with all their digits
    expect(ready.get_by_test_id("travel")).to_have_text(re.compile(r"^\d+\.\d$"))
    assert float(ready.get_by_test_id("travel").inner_text()) == pytest.approx(np.rad2deg(wanted.travel), abs=0.11)
    times = sorted(each["ms"] for each in ready.evaluate("window.drawn"))
    assert times
    assert ready.evaluate("window.sized") == 1, "words that come and go have moved the map"
    half, most = np.percentile(times, (50, 95))
    say(f"pointer to drawn count, position 1: {half:.0f} ms half of them, {most:.0f} ms 95 % of {len(times)}")


def test_the_lost_motion_follows_a_drag_and_the_loads_are_drawn_on_demand(ready, job, planned):
    lost = planned.lost_motion
    shown, twin = ready.get_by_test_id("lost"), ready.get_by_test_id("lost-twin")
    expect(shown).to_have_text(f"{lost.at_tip * 1e3:.3f}")
    expect(twin).to_have_text(f"{lost.twin_at_tip * 1e3:.3f}")
    expect(ready.get_by_test_id("lost-motion")).to_contain_text("friction, stiffness and gap", ignore_case=True)
    curves, switch = ready.locator(".zr-tw-load[data-level]"), ready.get_by_test_id("loads")
    expect(curves).to_have_count(0)
    expect(switch).to_have_attribute("aria-pressed", "false")
    switch.click()
    expect(switch).to_have_attribute("aria-pressed", "true")
    motion = planned.motion
    drilling = Drilling(job.robot, job.tool, job.holes[0])
    turning = senses(drilling, motion.profile, motion.branch)
    found = twist_map(drilling, motion.branch, corner=float(motion.profile.standoff.min())).load_lines
    both = sum(any(line.sense in turning[leg][line.joint - 1] for leg in line.legs) for line in found)
    expect(curves).to_have_count(both)
    assert 0 < both < len(found)
    drag_target(ready, -20, 4)
    by_hand = Profile(motion.profile.standoff, np.deg2rad(spins(ready)))
    expect(shown).to_have_text(f"{lost_motion(drilling, by_hand, motion.branch) * 1e3:.3f}")
    ready.mouse.up()
    switch.click()
    expect(curves).to_have_count(0)


def test_the_keyboard_is_enough(ready, job, planned):
    def tab_to(name):
        for _ in range(150):
            ready.keyboard.press("Tab")
            if ready.evaluate("document.activeElement?.closest('[data-testid]')?.dataset.testid") == name:
                return
        raise AssertionError(f"Tab does not lead to {name}")

    tab_to("handle-target")
    before = spins(ready)
    for _ in range(3):
        ready.keyboard.press("Shift+ArrowUp")
    expect(ready.get_by_test_id("handle-target")).to_have_attribute("aria-valuenow", f"{before[1] + 30:.2f}")
    wanted = score(job, planned, spins(ready))
    assert wanted.reversals > 0
    expect(ready.get_by_test_id("reversals")).to_have_text(str(wanted.reversals))
    ready.evaluate("document.activeElement.blur(); document.body.focus()")
    tab_to("plan")
    ready.keyboard.press("Enter")
    expect(ready.get_by_test_id("reversals")).to_have_text("0")
    tab_to("holes")
    ready.keyboard.press("ArrowDown")
    expect(ready.get_by_test_id("twist-map")).to_contain_text("reversals")
    ready.keyboard.press("ArrowDown")
    expect(ready.get_by_test_id("page")).to_contain_text("hole 2 of 3")
    expect(ready.get_by_test_id("reversals")).to_have_text("0")


def nudge(page):
    """Take the edited motion by a key; the spin at the target is then 10 degrees more."""
    before = spins(page)[1]
    page.get_by_test_id("handle-target").focus()
    page.keyboard.press("Shift+ArrowUp")
    return f"{before + 10:.2f}"


def test_two_pages_share_nothing_and_a_reload_loses_nothing(ready, open_page, demo):
    other = open_page(demo)
    expect(other.get_by_test_id("reversals")).to_have_text("0")
    before = spins(other)
    moved = nudge(ready)
    expect(ready.get_by_test_id("keep-this-motion")).to_be_visible()
    ready.reload()
    expect(ready.get_by_test_id("handle-target")).to_have_attribute("aria-valuenow", moved)
    expect(ready.get_by_test_id("keep-this-motion")).to_be_visible()
    assert spins(other) == before
    expect(other.get_by_test_id("keep-this-motion")).to_be_hidden()


def test_dark_is_kept_by_a_reload(ready):
    body = ready.locator("body")
    for looks in ("light", "dark"):
        ready.get_by_test_id("theme").click()
        expect(body).to_have_class(re.compile(f"body--{looks}"))
    nudge(ready)
    expect(body).to_have_class(re.compile("body--dark"))
    ready.reload()
    expect(ready.get_by_test_id("theme")).to_be_visible()
    expect(body).to_have_class(re.compile("body--dark"))


def test_a_lost_connection_loses_nothing(ready, job, planned):
    ready.expected += ["ERR_INTERNET_DISCONNECTED", "WebSocket"]
    moved = nudge(ready)
    expect(ready.get_by_test_id("keep-this-motion")).to_be_visible()
    ready.context.set_offline(True)
    ready.wait_for_timeout(1500)
    ready.context.set_offline(False)
    expect(ready.get_by_test_id("handle-target")).to_have_attribute("aria-valuenow", moved)
    again = nudge(ready)
    expect(ready.get_by_test_id("handle-target")).to_have_attribute("aria-valuenow", again)
    expect(ready.get_by_test_id("reversals")).to_have_text(str(score(job, planned, spins(ready)).reversals))


def test_bad_input_gets_a_message_beside_its_field_and_changes_nothing(ready):
    ready.get_by_test_id("add-hole").click()
    form = ready.get_by_test_id("hole-form")
    for name, bad in (("hole-x", "far"), ("hole-depth", "-5"), ("hole-depth", "1e999"), ("hole-id", "position_1")):
        field = form.get_by_test_id(name)
        good = field.input_value()
        field.fill(bad)
        form.get_by_test_id("form-done").click()
        message = form.locator("label", has=ready.get_by_test_id(name)).get_by_role("alert")
        expect(message).to_be_visible()
        expect(message).not_to_be_empty()
        field.fill(good)
    form.get_by_test_id("form-cancel").click()
    expect(ready.get_by_test_id("holes-shown")).to_have_text("3 holes")
    expect(ready.get_by_test_id("reversals")).to_have_text("0")


def test_a_map_of_cells_and_a_cell_that_becomes_a_hole(ready):
    ready.get_by_test_id("tab-map").click()
    ready.get_by_test_id("map-spacing").fill("0")
    ready.get_by_test_id("map").click()
    expect(ready.locator("label", has=ready.get_by_test_id("map-spacing")).get_by_role("alert")).to_be_visible()
    for name, value in (("width", "100"), ("height", "100"), ("spacing", "50")):
        ready.get_by_test_id(f"map-{name}").fill(value)
    ready.get_by_test_id("map").click()
    expect(ready.get_by_test_id("map-legend")).to_contain_text("mm", timeout=120_000)
    expect(ready.get_by_test_id("progress")).to_be_hidden(timeout=120_000)
    expect(ready.get_by_test_id("map-legend")).not_to_contain_text("not yet")
    ready.reload()
    ready.wait_for_function(f"() => {CELL}?.slice?.words.length === 9")  # a plane that was computed stays, too
    ready.get_by_test_id("tab-map").click()
    depth = float(re.search(r"([\d.]+) mm at", ready.get_by_test_id("map-best").inner_text()).group(1))
    ready.get_by_test_id("map-best").click()
    expect(ready.get_by_test_id("page")).to_contain_text("hole 4 of 4")
    ready.get_by_test_id("tab-holes").click()
    expect(ready.get_by_test_id("holes-shown")).to_have_text("4 holes")
    expect(ready.get_by_test_id("holes")).to_contain_text("cell ")
    expect(ready.get_by_test_id("reversals")).to_have_text("0")
    _, plan = saved(ready, lambda: of_some(ready, "download-plan"))
    made = plan_from_text(plan.decode(), "plan.json").holes[-1]
    assert made.hole.id.startswith("cell ")
    assert made.hole.depth * 1e3 == pytest.approx(depth, abs=0.06)
    assert (made.score.reversals, made.verified.passed) == (0, True)


def test_a_click_on_a_cell_in_the_picture_of_the_robot_plans_it(ready, on_screen):
    ready.get_by_test_id("tab-map").click()
    for name, value in (("width", "600"), ("height", "600"), ("spacing", "300")):
        ready.get_by_test_id(f"map-{name}").fill(value)
    ready.get_by_test_id("map").click()
    expect(ready.get_by_test_id("progress")).to_be_hidden(timeout=120_000)
    expect(ready.get_by_test_id("map-legend")).not_to_contain_text("not yet")
    ready.get_by_test_id("cell-camera-iso").click()
    # of the cells with a stroke, the one farthest from the hole in the plane's middle, which a click would pick first
    chosen = ready.evaluate(
        f"""() => {{ const {{ slice, camera }} = {CELL}, at = (n) => slice.at(n, camera.position.clone());
        const middle = at((slice.words.length - 1) / 2);
        const drilled = slice.words.map((_, n) => n).filter((n) => /\\d mm/.test(slice.words[n]));
        return drilled.sort((a, b) => at(b).distanceTo(middle) - at(a).distanceTo(middle))[0]; }}"""
    )
    ready.get_by_test_id("cell-canvas").scroll_into_view_if_needed()
    x, y = on_screen(ready, CELL, f"cell.slice.at({chosen}, cell.camera.position.clone())")
    ready.mouse.click(x, y)
    expect(ready.get_by_test_id("page")).to_contain_text("hole 4 of 4")
    expect(ready.get_by_test_id("reversals")).to_have_text("0")
    _, plan = saved(ready, lambda: of_some(ready, "download-plan"))
    made = plan_from_text(plan.decode(), "plan.json").holes[-1].hole
    wanted = ready.evaluate(f"{CELL}.slice.at({chosen}, {CELL}.camera.position.clone()).toArray()")
    np.testing.assert_allclose(made.target * 1e3, wanted, atol=1e-3)


def test_the_replay_opens_from_the_disk_without_a_network(ready, open_page, browser, tmp_path):
    name, page = saved(ready, lambda: of_some(ready, "download-replay"))
    (tmp_path / name).write_bytes(page)
    context = browser.new_context(offline=True)
    faults, asked = [], []
    try:
        replay = context.new_page()
        replay.on("console", lambda message: message.type == "error" and faults.append(message.text))
        replay.on("pageerror", lambda error: faults.append(str(error)))
        replay.on("request", lambda request: asked.append(request.url))
        replay.goto((tmp_path / name).as_uri())
        expect(replay.locator("canvas").first).to_be_visible()
        expect(replay.get_by_text("position_1").first).to_be_attached()
    finally:
        context.close()
    assert not faults
    assert [url for url in asked if not url.startswith(("data:", "blob:"))] == [(tmp_path / name).as_uri()]


def test_a_thousand_holes_open_and_stay_usable(serve, open_page, say, tmp_path_factory):
    folder = tmp_path_factory.mktemp("panel")
    rows = [
        f"h{n:04d},{450 + n % 10 * 10},{n // 10 % 10 * 20 + 200},{700 + n // 100 * 10},1,0,0,20" for n in range(1000)
    ]
    (folder / "panel.csv").write_text("id,x_mm,y_mm,z_mm,i,j,k,depth_mm\n" + "\n".join(rows) + "\n")
    (folder / "panel.yaml").write_text("robot: kuka_kr6_r700_2\ntool: thesis_drill\nholes: panel.csv\n")
    server = serve(folder / "panel.yaml")
    began = time.perf_counter()
    page = open_page(server)
    page.wait_for_function(STANDS)  # examined in every frame; an expectation looks after 0.1, 0.25, 0.5 and 1 s
    stands = time.perf_counter() - began
    expect(page.get_by_test_id("holes-shown")).to_have_text("1000 holes")
    expect(page.get_by_test_id("holes")).to_contain_text("h0000")
    say(f"1,000 holes: {stands:.1f} s until the table stands")
    began = time.perf_counter()
    page.get_by_test_id("filter").fill("h0777")
    expect(page.get_by_test_id("holes-shown")).to_have_text("1 of 1000")
    page.get_by_test_id("holes").get_by_text("h0777").click()
    expect(page.get_by_test_id("page")).to_contain_text("hole 778 of 1000")
    say(f"1,000 holes: {time.perf_counter() - began:.1f} s to filter and select one")
    expect(page.get_by_test_id("reversals")).not_to_have_text("–", timeout=120_000)


def test_ctrl_c_does_not_wait_for_a_compiler(serve, open_page, tmp_path):
    """The first page of a first start: plan and map compile their kernels, which takes a minute."""
    server = serve(variables={"NUMBA_CACHE_DIR": str(tmp_path)})
    page = open_page(server)
    page.expected += ["ERR_CONNECTION", "WebSocket", "ERR_EMPTY"]
    expect(page.get_by_test_id("map-cover")).to_be_visible()
    page.wait_for_timeout(2000)
    began = time.perf_counter()
    server.end()
    assert time.perf_counter() - began < 20
    assert any("compiling kernels" in line for line in server.lines)


def test_what_a_curve_is_under_the_pointer(ready, planned):
    box = ready.get_by_test_id("curves").bounding_box()
    ready.mouse.move(box["x"] + 0.1 * box["width"], box["y"] + 0.25 * box["height"])
    tip = ready.locator(".zr-tip:visible")
    expect(tip).to_contain_text("constant spin")
    expect(tip).to_contain_text("A1")
    ready.mouse.move(0, 0)
    expect(tip).to_have_count(0)
    ready.get_by_test_id("bracket").scroll_into_view_if_needed()
    box = ready.get_by_test_id("bracket").bounding_box()
    ready.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    expect(tip).to_contain_text("in deg/mm")
    assert [name in tip.inner_text() for name in ("A1", "A2", "A3", "A4", "A5", "A6")] == [True] * 6
