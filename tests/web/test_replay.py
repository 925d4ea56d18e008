"""The replay file in a real browser: from disk, with the network off, and it asks for nothing."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest

from oracles.published import POSITIONS
from zerorev.files.io import job_from_dict, read_robot
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import HolePlan, Plan
from zerorev.model.profile import Profile
from zerorev.motion.evaluation import evaluate
from zerorev.motion.kinematics import forward, tcp_pose, wrist_offset
from zerorev.motion.links import link_frames
from zerorev.planning.job import plan_job
from zerorev.report.scene.cell_data import slice_data
from zerorev.report.scene.replay import replay_page
from zerorev.report.scene.urdf_meshes import Mesh

NASTY = "</script><img src=x onerror=alert(1)>"
NO_WEBGL = "HTMLCanvasElement.prototype.getContext = () => null"


@pytest.fixture(scope="module")
def plan(robot, tool):
    """Two published positions, the first made to reverse in its legs; and a hole without a motion, with a nasty id."""
    answers = []
    for position, psi_deg in zip(POSITIONS, [(14.0, -5.0, 40.0), (180.0, 178.1, 142.49)], strict=False):
        profile = replace(position.profile, psi=np.deg2rad(psi_deg))
        found = evaluate(robot, tool, position.hole, profile, position.branch)
        answers.append(HolePlan(position.hole, "evaluated", wrist_offset(robot, tool), found.motion, found.score, None))
    lost = Hole(NASTY, np.array([0.5, 0.1, 0.8]), np.array([1.0, 0, 0]), 0.03)
    return Plan(robot, tool, Settings(), (*answers, HolePlan(lost, "infeasible", 0.1)))


@pytest.fixture
def open_replay(browser, plan, tmp_path):
    """Opens the file offline; looks at its end at what it did unseen."""
    path = tmp_path / "replay.html"
    path.write_text(replay_page(plan), encoding="utf-8")
    faults, contexts = [], []

    def opened(script=""):
        context = browser.new_context(viewport={"width": 1000, "height": 700}, offline=True, reduced_motion="reduce")
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda message: message.type in ("error", "warning") and noted(message))
        page.on("pageerror", lambda error: faults.append(f"error in the page: {error}"))
        page.on("dialog", lambda dialog: faults.append(f"dialog: {dialog.message}"))
        page.on(
            "request", lambda request: request.url.startswith(("file:", "data:", "blob:")) or faults.append(request.url)
        )
        if script:
            page.add_init_script(script)
        page.goto(path.as_uri())
        page.get_by_test_id("replay-verdict").wait_for()
        return page

    def noted(message):
        if "GPU stall" not in message.text:  # a screenshot by the software renderer
            faults.append(message.text)

    yield opened
    for context in contexts:
        context.close()
    assert not faults, "\n".join(faults)


CELL = "document.getElementById('cell').cell"


def place(page, x_mm):
    page.get_by_test_id("cell-scrub").evaluate("(e, x) => { e.value = x; e.dispatchEvent(new Event('input')) }", x_mm)


def until(page, expression, patience=20.0):
    """Wait until it is true; the page itself must not be asked to (its policy forbids to evaluate text)."""
    end = time.monotonic() + patience
    while not page.evaluate(expression):
        assert time.monotonic() < end, f"never true: {expression}"
        page.wait_for_timeout(30)


def test_the_arm_that_is_drawn_is_the_arm_that_is_planned(open_replay, robot, tool, plan):
    """Places and turns of the links in the browser, against the frames by numpy, and the tip against the hole."""
    page = open_replay()
    hole, profile = plan.holes[0].hole, plan.holes[0].motion.profile
    for x_mm in (-50.0, -17.3, 0.0, 31.0, 50.0):
        place(page, x_mm)
        frames, tip, joints = page.evaluate(
            f"""() => {{ const cell = {CELL}; cell.scene.updateMatrixWorld(true);
            const rows = (o) => o.matrixWorld.clone().transpose().elements;
            return [cell.arm.frames.map(rows), rows(cell.arm.tip), cell.track.at(cell.x).joints]; }}"""
        )
        drawn = np.array(frames).reshape(6, 4, 4)
        drawn[:, :3, 3] *= 1e-3
        assert drawn == pytest.approx(link_frames(robot, np.deg2rad(joints)), abs=1e-6)
        # between two samples the joints are interpolated: the tip may leave its line by micrometres
        standoff, psi = profile.at(profile.distance[profile.corner] + np.array([x_mm * 1e-3]))
        expected = tcp_pose(hole, standoff, psi)[0, :3, 3]
        assert np.array(tip).reshape(4, 4)[:3, 3] * 1e-3 == pytest.approx(expected, abs=2e-5)


def test_a_joint_that_reverses_is_marked_where_it_does(open_replay, plan):
    page = open_replay()
    score = plan.holes[0].score
    assert page.get_by_test_id("cell-mark").count() == score.reversals > 0
    event = score.events[0]
    place(page, event.standoff * 1e3 * (-1 if event.leg == "plunge" else 1))
    assert page.evaluate(f"{CELL}.arm.halos[{event.joint - 1}].visible")
    name = plan.robot.joint_names[event.joint - 1]
    page.locator(".zrc-reverses:visible", has_text=f"{name} reverses").wait_for()
    place(page, -50)
    assert page.evaluate(f"{CELL}.arm.halos.every((halo) => !halo.visible)")
    page.locator(".zrc-reverses:visible").wait_for(state="hidden")


def test_it_plays_and_pauses_by_keyboard(open_replay):
    page = open_replay()
    canvas = page.get_by_test_id("cell-canvas")
    canvas.press("Home")
    page.get_by_test_id("cell-speed").select_option("4")
    canvas.press("Space")
    until(page, f"{CELL}.x > -45")
    canvas.press("Space")
    assert page.get_by_test_id("cell-play").get_attribute("aria-label") == "Play"
    stopped = page.evaluate(f"{CELL}.x")
    canvas.press("ArrowRight")
    assert page.evaluate(f"{CELL}.x") == pytest.approx(stopped + 1.0, abs=1e-3)
    text = page.get_by_test_id("cell-scrub").get_attribute("aria-valuetext")
    assert "plunge" in text
    assert "spin" in text
    canvas.press("End")
    assert page.get_by_test_id("cell-time").inner_text() == "12.5 s of 12.5 s"


def test_the_strokes_of_a_hole_are_played_one_after_the_other(browser, tmp_path):
    hole = {"id": "a", "target_mm": [500, 300, 800], "direction": [1, 0, 0], "depth_mm": 6}
    job = {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "proof_boxes": 0, "holes": [hole, hole | {"id": "b"}]}
    made = plan_job(job_from_dict(job | {"cycle": {"kind": "peck", "depth_mm": 3}}))
    path = tmp_path / "replay.html"
    path.write_text(replay_page(made), encoding="utf-8")
    context = browser.new_context(viewport={"width": 1000, "height": 700}, offline=True, reduced_motion="reduce")
    page = context.new_page()
    page.goto(path.as_uri())
    said = page.get_by_test_id("replay-stroke")
    said.wait_for()
    assert said.inner_text().startswith("Stroke 1 of 2.")
    page.get_by_test_id("cell-speed").select_option("4")
    page.get_by_test_id("cell-play").click()
    page.get_by_text("Stroke 2 of 2.").wait_for()
    assert page.get_by_test_id("replay-hole").input_value() == "1"
    assert page.evaluate(f"{CELL}.hole") == "a, stroke 2"
    until(page, f"!{CELL}.playing")  # it ends with the hole
    assert page.get_by_test_id("replay-hole").input_value() == "1"
    assert page.evaluate(f"{CELL}.x") == pytest.approx(6)
    assert page.evaluate(f"{CELL}.holes.ids") == ["a", "b"]
    assert page.evaluate(f"{CELL}.holes.selected") == 0
    context.close()


def test_baseline_beside_and_as_a_ghost(open_replay):
    page = open_replay()
    place(page, 0)
    page.get_by_test_id("cell-baseline-side").click()
    assert "constant spin: 6 reversals" in page.locator(".zrc-caption").last.inner_text()
    assert page.evaluate(f"{CELL}.twin.halos.filter((halo) => halo.visible).length") == 6
    page.get_by_test_id("cell-baseline-ghost").click()
    until(page, f"{CELL}.twin.root.visible")
    page.get_by_test_id("cell-baseline-off").click()
    until(page, f"!{CELL}.twin.root.visible")


def test_another_hole(open_replay, plan):
    page = open_replay()
    page.get_by_test_id("replay-hole").select_option("1")
    assert page.get_by_test_id("replay-verdict").inner_text() == "0 reversals"
    assert page.get_by_test_id("cell-shown-note").count() == 0  # a KUKA shows the joints that turn
    assert page.evaluate(f"{CELL}.holes.selected") == 1
    page.get_by_test_id("replay-hole").select_option("2")  # its id is text, and harmless
    assert page.get_by_test_id("replay-verdict").inner_text() == "no motion"
    assert page.get_by_test_id("cell-time").inner_text() == "no motion"
    assert page.get_by_test_id("cell-play").is_disabled()
    assert page.locator("img").count() == 0


def test_a_click_picks_a_hole(open_replay, plan, on_screen):
    page = open_replay()
    page.get_by_test_id("cell-camera-iso").click()
    x, y = on_screen(page, CELL, "cell.holes.at(1, cell.holes.depth[1], cell.camera.position.clone())")
    page.mouse.move(x + 3, y)
    page.locator(".zrc-label:visible", has_text=plan.holes[1].hole.id).wait_for()
    page.mouse.click(x + 3, y)
    assert page.get_by_test_id("replay-hole").input_value() == "1"


def test_a_click_picks_a_cell_of_a_map(open_replay, on_screen):
    page = open_replay()
    position = np.array([[0.2 + 0.1 * n, -0.6, 0.3] for n in range(4)])
    data = slice_data(position, np.diag([0.1, 0.1, 0.1])[[0, 2]], ["#0072b2"] * 4, [f"{n} mm" for n in range(4)])
    page.get_by_test_id("cell-camera-side").click()
    page.evaluate(f"(data) => {{ {CELL}.showSlice(data); {CELL}.on.pickCell = (n) => (window.picked = n); }}", data)
    x, y = on_screen(page, CELL, "cell.slice.at(2, cell.camera.position.clone())")
    page.mouse.move(x + 3, y)
    page.locator(".zrc-label:visible", has_text="2 mm").wait_for()
    page.mouse.click(x + 3, y)
    assert page.evaluate("window.picked") == 2
    page.evaluate(f"{CELL}.showSlice(null)")
    assert page.evaluate(f"{CELL}.slice") is None


def test_meshes_of_a_description_move_with_the_links(browser, robot, plan, tmp_path):
    corners = np.array([[0.0, 0, 0], [0.1, 0, 0], [0, 0.2, 0], [0, 0, 0.3]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], dtype=np.uint32)
    path = tmp_path / "meshes.html"
    path.write_text(replay_page(plan, meshes=[[Mesh(corners, faces, "#ff8000")]] * 7), encoding="utf-8")
    page = browser.new_page(viewport={"width": 800, "height": 600})
    page.goto(path.as_uri())
    page.get_by_test_id("replay-verdict").wait_for()
    places, joints = page.evaluate(
        f"""() => {{ const cell = {CELL}; cell.scene.updateMatrixWorld(true);
        const place = cell.camera.position.clone(), {{ mesh }} = cell.arm.meshes[3];
        const at = mesh.geometry.attributes.position, out = [];
        for (let i = 0; i < at.count; i++)
            out.push(place.fromBufferAttribute(at, i).applyMatrix4(mesh.matrixWorld).toArray());
        return [out, cell.track.at(cell.x).joints]; }}"""
    )
    page.close()
    T = link_frames(robot, np.deg2rad(joints))[2]
    expected = corners[faces.ravel()] @ T[:3, :3].T + T[:3, 3]
    assert np.array(places) * 1e-3 == pytest.approx(expected, abs=1e-6)


def test_joint_3_is_read_out_as_the_pendant_shows_it(browser, tool, tmp_path):
    robot = read_robot("fanuc_lrmate200id")
    T = forward(robot, np.deg2rad([10.0, 35.0, -20.0, 15.0, -60.0, 40.0])) @ tool.T_flange_tcp
    hole = Hole("a", T[:3, 3], -T[:3, 2], 0.02, psi_zero=T[:3, 1])
    found = evaluate(robot, tool, hole, Profile.straight(0.02, 0.0, 0.1, 0.2), 1)
    answer = HolePlan(hole, "evaluated", wrist_offset(robot, tool), found.motion, found.score, None)
    path = tmp_path / "fanuc.html"
    path.write_text(replay_page(Plan(robot, tool, Settings(), (answer,))), encoding="utf-8")
    page = browser.new_page(viewport={"width": 1000, "height": 700})
    page.goto(path.as_uri())
    page.get_by_test_id("replay-verdict").wait_for()
    place(page, 0)
    turned = page.evaluate(f"{CELL}.track.at(0).joints")
    rows = page.get_by_test_id("cell-readout").locator("tbody tr").all()
    shown = [float(row.locator("td").first.inner_text().replace("−", "-")) for row in rows]
    note = page.get_by_test_id("cell-shown-note").inner_text()
    page.close()
    assert turned == pytest.approx(np.rad2deg(found.motion.joints[1]), abs=1e-3)
    assert shown == pytest.approx(np.rad2deg(robot.shown(found.motion.joints[1])), abs=0.051)
    assert abs(shown[2] - turned[2]) > 10
    assert "against the ground (J3 less J2)" in note


def test_without_webgl_it_says_so_and_the_rest_works(open_replay):
    page = open_replay(NO_WEBGL)
    assert "cannot be shown" in page.get_by_test_id("cell-fail").inner_text()
    place(page, 0)
    assert "stand-off" in page.get_by_test_id("cell-readout").inner_text()
    page.get_by_test_id("cell-baseline-side").click()
    page.get_by_test_id("cell-camera-top").click()
    page.get_by_test_id("replay-hole").select_option("1")
    assert page.get_by_test_id("replay-verdict").inner_text() == "0 reversals"
