"""The cells of a map: each is what planning says of its hole alone, and can be planned and proved from the map."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from zerorev.errors import InputError
from zerorev.maps.cells import STATUS, answer, columns_of
from zerorev.maps.replan import hole_of, job_of, question_of
from zerorev.maps.run import run_map
from zerorev.maps.workspace import read_workspace_map
from zerorev.model.cycle import Cycle
from zerorev.model.job import Settings
from zerorev.model.map_task import MapTask, Question, cone
from zerorev.motion.critical import critical_at
from zerorev.motion.drilling import Drilling
from zerorev.motion.kinematics import inverse, tcp_pose
from zerorev.planning.hole import plan
from zerorev.planning.job import plan_job
from zerorev.search.deepest import deepest_stroke
from zerorev.verify.certificate.certify import certify_hole
from zerorev.workers import HERE

FREE = Settings(min_rate=0.0)
AXES = (np.array([450.0, 500.0]), np.array([0.0, 300.0]), np.array([700.0, 800.0]))
ALONG_X = np.array([[1.0, 0.0, 0.0]])


def mapped(question, folder, axes=AXES, directions=ALONG_X, **kinds):
    run_map(MapTask(question, axes, directions, **kinds), folder / "map.zarr", HERE)
    return read_workspace_map(folder / "map.zarr")


def cells(found):
    names = ("x", "y", "z", "direction")
    return [dict(zip(names, map(int, at), strict=True)) for at in np.ndindex(found["branch"].shape)]


def test_deepest(robot, tool, tmp_path):
    found = mapped(Question(robot, tool, settings=FREE), tmp_path)
    for at in cells(found):
        hole = hole_of(found, **at)
        alone = deepest_stroke(robot, tool, replace(hole, profile=None, branch=None), FREE)
        assert float(found["deepest_mm"].isel(at)) == alone.depth * 1e3
        assert int(found["branch"].isel(at)) == alone.branch
        assert hole.profile.psi == pytest.approx(alone.profile.psi, abs=1e-12)
        assert int(found["status"].isel(at)) == STATUS.index("answered")


def test_room_at_the_joint_limits(robot, tool, tmp_path):
    """The strokes are those of a robot with narrower limits, and the map says with which margin it was made."""
    settings = replace(FREE, limit_margin=np.deg2rad(25.0))
    found = mapped(Question(robot, tool, settings=settings), tmp_path)
    assert question_of(found).settings == settings
    limits = robot.limits
    lower, upper = limits.lower + settings.limit_margin, limits.upper - settings.limit_margin
    narrow = replace(robot, limits=replace(limits, lower=lower, upper=upper))
    wide = []
    for at in cells(found):
        hole = replace(hole_of(found, **at), profile=None, branch=None)
        assert float(found["deepest_mm"].isel(at)) == deepest_stroke(narrow, tool, hole, FREE).depth * 1e3
        wide.append(deepest_stroke(robot, tool, hole, FREE).depth * 1e3 - float(found["deepest_mm"].isel(at)))
    assert max(wide) > 0.1


@pytest.mark.parametrize(
    ("quantity", "objective"),
    [("fewest_reversals", "travel"), ("least_travel", "travel"), ("greatest_margin", "margin")],
)
@pytest.mark.parametrize("legs", ["straight", "free"])
def test_at_a_given_depth_a_cell_is_what_plan_says(quantity, objective, legs, robot, tool, tmp_path):
    settings = Settings(legs=legs, objective=objective, min_rate=0.0 if objective == "margin" else Settings.min_rate)
    axes = tuple(axis[-1:] if n < 2 else axis for n, axis in enumerate(AXES))
    found = mapped(Question(robot, tool, quantity, settings, depth=0.06), tmp_path, axes)
    for at in cells(found):
        alone = plan(
            robot, tool, replace(hole_of(found, **at), profile=None, branch=None), settings.without_proof
        ).score
        wanted = {
            "fewest_reversals": ("reversals", alone.reversals),
            "least_travel": ("travel_deg", np.rad2deg(alone.travel)),
            "greatest_margin": ("margin_deg_per_mm", np.rad2deg(alone.min_rate.min()) / 1e3),
        }
        name, value = wanted[quantity]
        assert float(found[name].isel(at)) == pytest.approx(value, rel=1e-9)
        again = plan(robot, tool, hole_of(found, **at), settings.without_proof).score
        assert again.reversals == alone.reversals
        assert again.travel == pytest.approx(alone.travel)


@pytest.mark.parametrize("quantity", ["deepest", "fewest_reversals", "least_travel"])
def test_cells_of_holes_that_break_chips_are_replanned_and_verified(quantity, robot, tool, tmp_path):
    """The motion of a cell comes back from the map with its breaks, and is what the map says of it."""
    settings = replace(FREE, legs="straight", cycle=Cycle("chip_break", 5e-3, 0.3e-3))
    question = Question(robot, tool, quantity, settings, depth=None if quantity == "deepest" else 0.03)
    found = mapped(question, tmp_path)
    assert question_of(found).settings == settings
    answered = 0
    for at in cells(found):
        hole = hole_of(found, **at)
        if hole.profile is None:
            continue
        assert len(hole.profile.turns) == 1 + 2 * len(settings.cycle.breaks(hole.depth))
        answer = plan(robot, tool, hole, settings)
        assert answer.verified.passed
        answered += 1
        if quantity == "fewest_reversals":
            assert int(found["reversals"].isel(at)) == answer.score.reversals
            continue
        assert answer.score.reversals == 0
        if quantity == "deepest":
            assert float(found["deepest_mm"].isel(at)) == hole.depth * 1e3 <= answer.deepest * 1e3 * (1 + 1e-12)
        else:
            assert float(found["travel_deg"].isel(at)) == pytest.approx(np.rad2deg(answer.score.travel), abs=1e-6)
    assert answered >= 4


def test_a_question_that_knows_no_cycle_is_refused(robot, tool):
    chips, pecks = Cycle("chip_break", 5e-3), Cycle("peck", 5e-3)
    with pytest.raises(InputError, match="cycle, kind: chip_break"):
        Question(robot, tool, "twist_spread", replace(FREE, legs="straight", cycle=chips))
    with pytest.raises(InputError, match="cycle, kind: peck"):
        Question(robot, tool, "least_travel", replace(FREE, cycle=pecks), depth=0.03)


def test_a_depth_too_deep_for_zero_reversals_has_no_travel_but_reversals(robot, tool, tmp_path):
    axes = (np.array([500.0]), np.array([300.0]), np.array([800.0]))
    (tmp_path / "a").mkdir()
    travel = mapped(Question(robot, tool, "least_travel", FREE, depth=0.12), tmp_path, axes)
    fewest = mapped(Question(robot, tool, "fewest_reversals", FREE, depth=0.12), tmp_path / "a", axes)
    assert np.isnan(travel["travel_deg"].values).all()
    assert travel["status"].values.ravel().tolist() == [STATUS.index("none")]
    assert fewest["reversals"].values.ravel().tolist() > [0]


def within_limits(robot, tool, hole, psi):
    """Branches that some full turns bring within the limits at the target, shape (8,)."""
    joints = inverse(robot, tcp_pose(hole, 0.0, psi) @ np.linalg.inv(tool.T_flange_tcp))
    turned = joints[..., None] + 2 * np.pi * np.arange(-2, 3)
    lower, upper = robot.limits.lower[:, None], robot.limits.upper[:, None]
    return ((turned >= lower) & (turned <= upper)).any(axis=-1).all(axis=-1)


def test_twist_spread_is_the_least_over_all_spins(robot, tool, tmp_path):
    found = mapped(Question(robot, tool, "twist_spread", FREE), tmp_path)
    for at in cells(found)[::3]:
        hole = hole_of(found, **at)
        assert hole.profile is None
        spreads = [
            each.spread
            for psi in np.linspace(-np.pi, np.pi, 181)
            for each in critical_at(Drilling(robot, tool, hole), psi)
            if within_limits(robot, tool, hole, psi)[each.branch]
        ]
        value = float(found["twist_spread_deg_per_mm"].isel(at))
        assert value <= np.rad2deg(min(spreads)) / 1e3 + 1e-9
        psi = np.deg2rad(float(found["psi_target_deg"].isel(at)))
        there = [
            each
            for each in critical_at(Drilling(robot, tool, hole), psi)
            if each.branch == int(found["branch"].isel(at))
        ]
        assert value == pytest.approx(np.rad2deg(there[0].spread) / 1e3)


@pytest.mark.long
@pytest.mark.parametrize("quantity", ["thesis_bisection", "thesis_stepping"])
def test_the_thesis_ways_find_no_more_than_there_is(quantity, robot, tool, tmp_path):
    axes = (np.array([500.0]), np.array([300.0]), np.array([800.0]))
    swarm = mapped(Question(robot, tool, quantity, replace(FREE, psi_bound=np.pi), seed=3), tmp_path, axes)
    depths = swarm["deepest_mm"].values.ravel()
    for at, depth in zip(cells(swarm), depths, strict=True):
        exact = deepest_stroke(robot, tool, replace(hole_of(swarm, **at), profile=None, branch=None), FREE).depth * 1e3
        # 200 samples overlook what happens between two of them: half a millimetre of stroke
        assert 0.5 * exact < depth < exact + 0.5
    assert quantity == "thesis_bisection" or (depths % 5 == 0).all()
    assert swarm.attrs["seed"] == 3


def test_why_a_cell_has_no_answer(robot, tool, tmp_path):
    axes = (np.array([0.0, 500.0, 5000.0]), np.array([0.0]), np.array([300.0, 800.0]))
    found = mapped(Question(robot, tool, settings=FREE), tmp_path, axes)
    status = [[STATUS[n] for n in row] for row in found["status"].values[:, 0, :, 0]]
    assert status[0][0] == "robot_base"
    assert status[1][1] == "answered"
    assert status[2] == ["out_of_reach", "out_of_reach"]
    without = found["status"].values != STATUS.index("answered")
    assert (found["branch"].values[without] == -1).all()
    assert np.isnan(found["deepest_mm"].values[without]).all()


def test_joint_limits_and_no_stroke_are_distinguished(robot, tool):
    target, direction = np.array([[0.5, 0.3, 0.8]]), ALONG_X
    limits = replace(robot.limits, lower=robot.limits.upper - 1e-3)
    tight = answer(Question(replace(robot, limits=limits), tool, settings=FREE), _block(target, direction))
    assert STATUS[tight["status"][0]] == "joint_limits"
    steep = answer(Question(robot, tool, settings=Settings(min_rate=1e3)), _block(target, direction))
    assert STATUS[steep["status"][0]] == "none"


def _block(target, direction):
    from zerorev.maps.cells import Block

    return Block(0, np.array([0]), target, direction, np.array([False]))


@pytest.mark.parametrize("legs", ["straight", "free"])
def test_ten_random_cells_are_replanned_verified_and_certified_at_their_depth(legs, robot, tool, tmp_path):
    pytest.importorskip("flint")
    axes = (np.array([420.0, 510.0]), np.array([-130.0, 20.0, 250.0]), np.array([650.0, 900.0]))
    axes = axes if legs == "straight" else tuple(axis[:2] for axis in axes)
    directions = cone(np.array([1.0, 0.0, 0.0]), np.deg2rad(20), 2)
    found = mapped(Question(robot, tool, settings=replace(FREE, legs=legs)), tmp_path, axes, directions)
    drilled = [at for at in cells(found) if int(found["branch"].isel(at)) >= 0]
    chosen = [drilled[n] for n in np.random.default_rng(5).permutation(len(drilled))[: 10 if legs == "straight" else 4]]
    job = job_of(found, chosen)
    job = replace(job, settings=job.settings.without_proof)
    for at, answered in zip(chosen, plan_job(job).holes, strict=True):
        stated = float(found["deepest_mm"].isel(at))
        assert answered.hole.depth * 1e3 == pytest.approx(stated, abs=1e-9)
        assert answered.score.reversals == 0
        assert answered.verified.passed
        assert certify_hole(job.robot, job.tool, job.settings, answered).verdict == "certified"


def test_the_question_comes_back_from_the_attributes(robot, tool, tmp_path):
    asked = Question(robot, tool, "least_travel", Settings(psi_bound=3.0, max_twist=70.0), (0.0, 0.0, 1.0), 0.02)
    found = mapped(asked, tmp_path, tuple(axis[:1] for axis in AXES))
    again = question_of(found)
    assert again.robot.arm == asked.robot.arm
    assert np.array_equal(again.robot.limits.lower, robot.limits.lower)
    assert again.tool.T_flange_tcp == pytest.approx(tool.T_flange_tcp, abs=1e-15)
    assert (again.quantity, again.psi_reference, again.depth) == ("least_travel", (0.0, 0.0, 1.0), 0.02)
    for name in ("min_rate", "psi_bound", "legs", "max_twist"):
        assert getattr(again.settings, name) == pytest.approx(getattr(asked.settings, name)), name


def test_points_have_one_dimension(robot, tool, tmp_path):
    axes = (np.array([500.0, 200.0]), np.array([300.0, 400.0]), np.array([800.0, 600.0]))
    found = mapped(Question(robot, tool, settings=FREE), tmp_path, axes, ids=("A", "B"))
    assert dict(found.sizes) == {"point": 2, "direction": 1}
    assert found.attrs["ids"] == ["A", "B"]
    assert hole_of(found, point=1).target * 1e3 == pytest.approx([200, 400, 600])
    assert found["deepest_mm"].values.ravel() == pytest.approx([104.6, 26.2], abs=0.2), "theory §7"


def test_no_such_cell(robot, tool, tmp_path):
    found = mapped(Question(robot, tool, "twist_spread", FREE), tmp_path)
    for wrong in ({"x": 0, "y": 0}, {"x": 0, "y": 0, "z": 2}, {"x": 0, "y": 0, "z": 0, "point": 1}):
        with pytest.raises(InputError, match="no cell"):
            hole_of(found, **wrong)
    hole_of(found, x=0, y=0, z=0)  # the direction is the only one


def test_every_variable_has_its_unit_in_its_name_and_attributes(robot, tool, tmp_path):
    found = mapped(Question(robot, tool, settings=replace(FREE, legs="free")), tmp_path, tuple(a[:1] for a in AXES))
    assert set(found.data_vars) == set(columns_of(question_of(found)))
    ends = {"mm": "_mm", "deg": "_deg", "1": ""}
    for name, variable in found.variables.items():
        assert str(name).endswith(ends[variable.attrs["units"]])
        assert variable.attrs["long_name"]
    assert set(found.coords) == {f"{a}_mm" for a in "xyz"} | {f"direction_{a}" for a in "xyz"}
