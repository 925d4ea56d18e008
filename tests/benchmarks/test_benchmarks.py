"""The benchmark's own parts, untimed: the scorer, the objective's two twins, the swarm, the peers' kinematics."""

from __future__ import annotations

import importlib
import json
import sys
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
from benchmarks.box import content, thinned, write_map_file
from benchmarks.cases import Answer, Case, drilled, mirrored, random_place
from benchmarks.panel import BULGE, write_panel
from benchmarks.parts import Options
from benchmarks.peers.objective import NumbaObjective, NumpyObjective, graded
from benchmarks.peers.swarm import BOUND, swarm
from benchmarks.states import NEW, OLD, planners
from benchmarks.table import Goal, Section, load, page, save
from benchmarks.timing import duration, in_turns

from benchmarks import arm_numpy, scorer
from zerorev.files.io import read_job
from zerorev.files.map_file import read_map_file
from zerorev.model.hole import Hole
from zerorev.model.profile import Profile
from zerorev.motion import kinematics
from zerorev.motion.evaluation import evaluate
from zerorev.planning.hole import plan


@pytest.fixture
def case(robot, tool, position):
    return Case(robot, tool, position.hole)


def random_motions(count, seed=0):
    return np.random.default_rng(seed).uniform(-np.pi, np.pi, (count, 3))


class TestNumpyKinematics:
    def test_finds_what_the_kernels_find(self, any_robot):
        rng = np.random.default_rng(3)
        joints = rng.uniform(any_robot.limits.lower, any_robot.limits.upper, (500, 6))
        T = kinematics.forward(any_robot, joints[np.abs(np.sin(joints[:, 4])) > 1e-3])
        ours, there = kinematics.inverse(any_robot, T), arm_numpy.inverse(any_robot.arm, T)
        assert (np.isnan(ours) == np.isnan(there)).all()
        assert np.nanmax(np.abs(arm_numpy.wrapped(ours - there))) < 1e-9

    def test_of_one_branch_alone(self, robot, position):
        T = kinematics.forward(robot, np.deg2rad(position.axis_deg))
        all_of_them = arm_numpy.inverse(robot.arm, T)
        np.testing.assert_array_equal(arm_numpy.inverse(robot.arm, T, (5, 2)), all_of_them[:, [5, 2]])


class TestScorer:
    @pytest.mark.parametrize(
        ("steps", "turns"),
        [
            ([1, 2, 1], 0),
            ([1, -1], 1),
            ([1, 0, 0, 1], 0),
            ([1, 0, -1, 0, 1], 2),
            ([0, 0], 0),
            ([1, -1e-12, 1], 0),
            ([1e-12, -1e-12, 1e-12], 0),
            ([1, *[-1e-12] * 20, 1], 2),  # backs up by more than the arithmetic errs, in steps of less
        ],
    )
    def test_counts_turning_points(self, steps, turns):
        assert scorer.turning_points(np.concatenate([[0.0], np.cumsum(np.array(steps, dtype=float))])) == turns

    def test_agrees_with_the_published_figures(self, case, position):
        score = scorer.rescore(case, Answer(position.profile, position.branch))
        assert (score.wrong, score.reversals) == ("", 0)
        assert np.rad2deg(score.travel) == pytest.approx(position.travel_deg, abs=0.05)
        held = scorer.rescore(case, Answer(position.held_spin, position.branch))
        assert np.rad2deg(held.travel) == pytest.approx(position.baseline_travel_deg, abs=0.05)
        located = evaluate(case.robot, case.tool, case.hole, position.held_spin, position.branch).score
        assert held.reversals == located.reversals > 0

    def test_says_what_keeps_a_motion_from_running(self, case, position):
        limits = case.robot.limits
        over = replace(case.robot, limits=replace(limits, lower=np.full(6, -1e-3), upper=np.full(6, 1e-3)))
        answer = Answer(position.profile, position.branch)
        assert scorer.rescore(replace(case, robot=over), answer, 2001).wrong == "limit"
        far = replace(case, hole=replace(case.hole, target=2 * case.hole.target))
        assert scorer.rescore(far, answer, 2001).wrong == "fault"

    def test_tells_better_from_worse(self, case, position):
        answer = Answer(position.profile, position.branch)
        score = scorer.rescore(case, answer)
        assert scorer.compare(case, answer, score, score) == "equal"
        assert scorer.compare(case, answer, score, replace(score, travel=score.travel * 1.001)) == "better"
        assert scorer.compare(case, answer, score, replace(score, travel=score.travel * 0.999)) == "worse"
        assert scorer.compare(case, answer, score, replace(score, reversals=1, travel=0.1)) == "better"
        assert scorer.compare(case, answer, score, None) == "better"
        assert scorer.compare(case, answer, replace(score, wrong="limit"), None) == "worse"

    def test_a_reversal_between_its_samples_makes_nobody_better(self, case, position):
        """The published motion, one leg made gentler until a joint just turns within the first step at the target."""
        gentle, steep = 0.5, 1.0
        for _ in range(60):  # where the first reversal appears; the leg is known by its share of the published slope
            middle = (gentle + steep) / 2
            found = evaluate(case.robot, case.tool, case.hole, self._gentler(position, middle), position.branch)
            gentle, steep = (middle, steep) if found.score.reversals else (gentle, middle)
        hidden = Answer(self._gentler(position, gentle - 1e-9), position.branch)
        score = scorer.rescore(case, hidden)
        assert score.reversals == 0
        assert evaluate(case.robot, case.tool, case.hole, *hidden).score.reversals > 0
        assert scorer.compare(case, hidden, score, replace(score, travel=score.travel * 1.01)) == "between samples"

    def _gentler(self, position, share):
        start, target, end = position.profile.psi
        return Profile.straight(position.hole.depth, start, target, target + share * (end - target))


class TestObjective:
    @pytest.mark.parametrize("fractions", [None, graded()], ids=["even", "crowded"])
    def test_the_two_twins_agree(self, case, fractions):
        spins = random_motions(40)
        compiled, plain = NumbaObjective(case, fractions), NumpyObjective(case, fractions)
        np.testing.assert_allclose(compiled.costs(spins), plain.costs(spins), rtol=0, atol=1e-12)

    def test_is_equation_4_7(self, case):
        """Against the evaluation, which counts by located events; but for the few of which 200 steps overlook some."""
        objective, rng, compared, overlooked = NumbaObjective(case), np.random.default_rng(1), 0, 0
        for _ in range(12):
            spins = rng.uniform(-np.pi, np.pi) + rng.uniform(-0.3, 0.3, 3)
            costs = objective.costs(spins[None])[0]
            profile = Profile.straight(case.hole.depth, *spins)
            for branch in range(8):
                score = evaluate(case.robot, case.tool, case.hole, profile, branch).score
                if score is None:
                    assert costs[branch] >= 1
                    continue
                compared += 1
                if int(7 * costs[branch]) < score.reversals:
                    overlooked += 1
                    continue
                expected = score.reversals / 7 + score.travel / (84 * np.pi)
                assert costs[branch] == pytest.approx(expected, abs=1e-4)
        assert compared >= 10
        assert overlooked <= 0.2 * compared

    def test_the_best_branch_of_a_published_motion_has_no_reversal(self, case, position):
        objective = NumbaObjective(case)
        answer = objective.answer(position.profile.psi)
        assert objective.reversals(answer) == 0
        assert answer.branch // 2 == position.branch // 2
        assert objective(position.profile.psi[None])[0] == pytest.approx(
            np.deg2rad(position.travel_deg) / (84 * np.pi), rel=1e-3
        )


class Bowl(NumbaObjective):
    """A plain bowl in place of eq. 4.7, which remembers where it was examined."""

    def __init__(self, case, bottom):
        super().__init__(case)
        self.bottom, self.looked = np.array(bottom), []

    def costs(self, spins):
        self.looked.append(spins)
        return np.tile(((spins - self.bottom) ** 2).sum(axis=1)[:, None], 8)


class TestSwarm:
    @pytest.fixture
    def case(self, robot, tool, positions):
        return Case(robot, tool, positions[0].hole)

    def test_comes_close_to_a_planted_optimum(self, case):
        bottom = [1.0, -2.0, 0.5]
        apart = [np.abs(swarm(Bowl(case, bottom), seed).profile.psi - bottom).max() for seed in range(5)]
        assert np.median(apart) < 0.05  # now and then a run settles short of it

    def test_begins_as_equation_4_8_says_and_stays_within_its_bounds(self, case):
        bowl = Bowl(case, [3.0, 3.1, -3.1])
        swarm(bowl, 1, particles=40, iterations=8)
        start, target, end = bowl.looked[0].T
        assert bowl.evaluations == 9 * 40
        assert ((target - start) * (end - target) >= 0).all()
        assert np.abs(np.concatenate(bowl.looked)).max() <= BOUND

    def test_is_known_by_its_seed(self, case):
        first, again, other = (swarm(Bowl(case, [0, 1, 2]), seed, 10, 3).profile.psi for seed in (4, 4, 5))
        np.testing.assert_array_equal(first, again)
        assert (first != other).any()


class TestPeers:
    """The outside libraries, each where it is installed."""

    @pytest.mark.parametrize(("module", "name"), [("opw", "Opw"), ("eaik_arm", "Eaik")])
    def test_finds_the_solutions_that_the_kernels_find(self, robot, module, name):
        pytest.importorskip({"opw": "py_opw_kinematics", "eaik_arm": "eaik"}[module])
        field = pytest.importorskip("benchmarks.parts.field", reason="needs all the peers of the field")
        peer = getattr(importlib.import_module(f"benchmarks.peers.{module}"), name)
        joints = np.random.default_rng(5).uniform(robot.limits.lower, robot.limits.upper, (200, 6))
        T = kinematics.forward(robot, joints[np.abs(np.sin(joints[:, 4])) > 1e-3])
        ours, theirs = kinematics.inverse(robot, T), peer(robot.arm, T).solutions()
        assert field.apart(ours, theirs) < field.SAME
        theirs[0, 0, 0] += 1e-4
        assert field.apart(ours, theirs) > field.SAME

    @pytest.mark.parametrize("module", ["evolution", "pymoo_swarm"])
    def test_comes_close_to_a_planted_optimum(self, robot, tool, positions, module):
        if module == "pymoo_swarm":
            pytest.importorskip("pymoo")
        search = getattr(importlib.import_module(f"benchmarks.peers.{module}"), module)
        bowl = Bowl(Case(robot, tool, positions[0].hole), [1.0, -2.0, 0.5])
        assert np.abs(search(bowl, 0).profile.psi - bowl.bottom).max() < 0.05


class TestCases:
    def test_a_mirrored_motion_does_the_same_to_the_joints(self, case, position):
        there, back = mirrored(case), mirrored(mirrored(case))
        np.testing.assert_allclose(back.hole.psi_zero, case.hole.psi_zero, atol=1e-15)
        profile = Profile(position.profile.standoff, -position.profile.psi)
        score = scorer.rescore(case, Answer(position.profile, position.branch), 2001)
        assert scorer.rescore(there, Answer(profile, position.branch), 2001).travel == pytest.approx(score.travel)

    def test_random_places_can_be_reached(self):
        for seed in range(5):
            place = drilled(random_place(seed), 0.02)
            again = random_place(seed)
            np.testing.assert_array_equal(place.hole.target, again.hole.target)
            assert place.hole.depth == 0.02
            T = kinematics.tcp_pose(place.hole, 0.0, np.linspace(-np.pi, np.pi, 72))
            T = T @ np.linalg.inv(place.tool.T_flange_tcp)
            assert not np.isnan(kinematics.inverse(place.robot, T)).all()


class TestBox:
    @pytest.mark.parametrize("cells", [1, 400, 3000, 100_000])
    def test_a_thinned_grid_is_part_of_the_box_and_spread_over_it(self, cells):
        whole, thin = thinned(10**6), thinned(cells)
        assert whole.shape == (100, 100, 20, 5)
        assert cells <= thin.cells <= max(2 * cells, 5)
        for axis, kept in zip(whole.axes, thin.axes, strict=True):
            assert set(kept) <= set(axis)
            step = len(axis) / len(kept)
            gaps = np.diff(np.concatenate([[-1], np.searchsorted(axis, kept), [len(axis)]]))
            assert (gaps[1:-1] <= np.ceil(step)).all()
            assert max(gaps[0], gaps[-1]) <= step / 2 + 1.5

    def test_its_map_file_asks_for_it(self, tmp_path):
        thin = thinned(400)
        write_map_file(thin, tmp_path / "thin.yaml")
        again = read_map_file(tmp_path / "thin.yaml")
        for name in ("axes", "directions"):
            for here, there in zip(getattr(thin, name), getattr(again, name), strict=True):
                np.testing.assert_array_equal(here, there)
        assert again.question.psi_reference == thin.question.psi_reference

    def test_content(self, tmp_path):
        (tmp_path / "in").mkdir()
        (tmp_path / "in" / "one").write_bytes(b"1")
        assert content(tmp_path) == {str(Path("in") / "one"): b"1"}


@pytest.mark.skipif(sys.platform != "linux", reason="other systems state the memory of a process in other words")
class TestWatched:
    BUSY = "import time; held = b'1' * {size}; t = time.process_time()\nwhile time.process_time() - t < 1.5: pass"

    @pytest.fixture(autouse=True)
    def watched(self):
        pytest.importorskip("psutil")
        from benchmarks.watched import watched

        return watched

    def test_of_a_process_and_its_child(self, watched, tmp_path):
        child = self.BUSY.format(size=300 * 2**20)
        code = f"import subprocess, sys; held = b'1' * {100 * 2**20}; subprocess.run([sys.executable, '-c', {child!r}])"
        cost = watched([sys.executable, "-c", code], tmp_path / "log.json")
        assert 300 <= cost.most_of_one / 2**20 < 380
        assert 400 <= cost.most_of_all / 2**20 < 500
        assert (cost.processes, cost.runs) == (2, 1)
        assert 0.5 < cost.processor < cost.seconds

    def test_a_run_that_was_broken_off_counts(self, watched, tmp_path):
        log = tmp_path / "log.json"
        fails = f"import sys; {self.BUSY.format(size=200 * 2**20)}\nsys.stderr.write('no room'); sys.exit(3)"
        with pytest.raises(RuntimeError, match=r"ends with 3: no room"):
            watched([sys.executable, "-c", fails], log)
        first = json.loads(log.read_text())
        total = watched([sys.executable, "-c", self.BUSY.format(size=1)], log)
        assert total.runs == 2
        assert total.most_of_one == first["most_of_one"] > 200 * 2**20
        assert total.seconds > first["seconds"] + 1
        assert asdict(total) == json.loads(log.read_text())
        assert total.finished > first["finished"]
        assert watched(["no such command"], log) == total


class TestPanel:
    def test_is_a_job_of_holes_along_the_normals_of_a_sheet(self, tmp_path):
        job = read_job(write_panel(tmp_path, 300, seed=4, spindle_rpm=900))
        assert (len(job.holes), job.settings.spindle_rpm) == (300, 900)
        R, place = job.T_base_part[:3, :3], job.T_base_part[:3, 3]
        centre = place - BULGE * 1e-3 * R[:, 2]
        for hole in job.holes:
            inwards = centre - hole.target
            assert np.linalg.norm(inwards) == pytest.approx(BULGE * 1e-3, abs=1e-6)
            assert hole.direction @ inwards == pytest.approx(BULGE * 1e-3, abs=1e-6)
        text = (tmp_path / "panel.csv").read_text()
        write_panel(tmp_path, 300, seed=4)
        assert (tmp_path / "panel.csv").read_text() == text
        write_panel(tmp_path, 300, seed=5)
        assert (tmp_path / "panel.csv").read_text() != text


class TestStates:
    def test_a_planner_is_of_its_checkout_and_answers_what_plan_does(self, robot, tool, tmp_path):
        hole = {"id": "hole", "target_mm": [500, 300, 800], "direction": [1, 0, 0], "depth_mm": 50}
        job = {"robot": robot.name, "tool": "thesis_drill", "holes": [hole], "no_such_key": 1}
        with planners(None) as states:
            answer = states[NEW](job)
            assert list(states) == [NEW]
        planned = plan(robot, tool, Hole("hole", np.array([0.5, 0.3, 0.8]), np.array([1.0, 0.0, 0.0]), 0.05))
        assert answer["depth_mm"] == planned.deepest * 1e3
        assert (answer["reversals"], answer["passed"]) == (0, True)
        assert 0 < answer["seconds"] < 600

    def test_an_older_state_is_imported_from_its_own_folder(self, tmp_path):
        package = tmp_path / "src" / "zerorev"
        package.mkdir(parents=True)
        (package / "__init__.py").write_text("raise SystemExit(3)")
        with planners(tmp_path) as states:
            assert list(states) == [NEW, OLD]
            with pytest.raises(RuntimeError, match="ended before its time"):
                states[OLD]({})


@pytest.mark.long
@pytest.mark.parametrize("name", ["map_scaling", "map_great"])
@pytest.mark.filterwarnings("ignore")  # those of dask are not ours
def test_the_parts_of_the_maps_run(name, tmp_path):
    pytest.importorskip("distributed")
    part = importlib.import_module(f"benchmarks.parts.{name}")
    section = part.run(replace(Options.quick(), cells=100, folder=tmp_path))
    assert section.failures == []
    assert len(section.rows) == 3
    assert not list(tmp_path.iterdir())


class TestPage:
    SECTION = Section(
        "part", "A part", ("a", "b"), [("1", "2")], ["A note."], [Goal("work", "others", "5 s", "3 s")], ["it fails"]
    )

    def test_survives_its_file(self, tmp_path):
        save(self.SECTION, tmp_path)
        text = page([load("part", tmp_path)], "A machine.")
        assert text == page([self.SECTION], "A machine.")
        for line in ("| work | others | 5 s | 3 s |", "| 1 | 2 |", "A note.", "**Does not hold:** it fails."):
            assert line in text
        assert load("another", tmp_path) is None

    def test_times_are_taken_in_turns(self):
        order = []
        timed = in_turns({name: lambda n, name=name: order.append((name, n)) or n for name in "ab"}, 2)
        assert order == [("a", 0), ("b", 0), ("a", 0), ("b", 0), ("a", 1), ("b", 1)]
        assert timed["a"].values == (0, 1)
        assert 0 <= timed["a"].least <= timed["a"].median

    @pytest.mark.parametrize(
        ("seconds", "words"), [(2.5, "2.5 s"), (0.0123, "12.3 ms"), (4.2e-5, "42 µs"), (3e-8, "30 ns")]
    )
    def test_times_in_words(self, seconds, words):
        assert duration(seconds) == words
