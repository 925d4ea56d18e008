"""Places with enough margin against planted rules whose nearest place and greatest room are known, and the command."""

from __future__ import annotations

import json

import numpy as np
import pytest
import yaml

import zerorev as zr
from zerorev import cli
from zerorev.errors import InputError
from zerorev.model._arrays import rotation_rpy, transform
from zerorev.model.hole import Hole
from zerorev.model.job import Job, Settings
from zerorev.placement.distance import Distance
from zerorev.placement.freedom import Freedom, job_at
from zerorev.placement.search import place
from zerorev.report.words.placement import placement_data, placement_lines
from zerorev.search.deepest import Deepest

T = transform(rotation_rpy(0.1, -0.2, 0.5), np.array([0.5, 0.3, 0.8]))
CORNERS = ((0, 0), (0.1, 0), (0, 0.06), (0.1, 0.06))


@pytest.fixture
def job(robot, tool):
    """A plate of holes, 50 mm deep each."""
    holes = [Hole(f"H{k}", T[:3, :3] @ [0, *yz] + T[:3, 3], T[:3, :3] @ [1.0, 0, 0], 0.05) for k, yz in
             enumerate(CORNERS)]  # fmt: skip
    return Job(robot, tool, tuple(holes), Settings(min_rate=0.0), T)


@pytest.fixture
def planted(monkeypatch, job):
    """Set the margin [m] over the shift of the part, of every hole alike."""
    here = {hole.id: hole.target for hole in job.holes}

    def plant(rule):
        def deepest(drilling, settings):
            shift = drilling.hole.target - here[drilling.hole.id]
            return Deepest(max(0.0, 0.05 + float(rule(shift))))

        monkeypatch.setattr("zerorev.placement.margins.deepest_in_cycle", deepest)

    return plant


def within(centre, radius, slope=0.5):
    """A margin of 10 mm at a distance from a centre, more within it."""
    return lambda shift: 0.01 + slope * (radius - np.linalg.norm(shift - centre))


class TestDistance:
    def test_it_is_the_greatest_way_of_a_hole(self, job):
        rng = np.random.default_rng(3)
        places, others = (np.column_stack([rng.normal(0, 0.2, (n, 3)), rng.normal(0, 1, n)]) for n in (5, 3))
        found = Distance(job)(places, others)
        for i, j in np.ndindex(found.shape):
            one, two = job_at(job, places[i]), job_at(job, others[j])
            ways = [np.linalg.norm(a.target - b.target) for a, b in zip(one.holes, two.holes, strict=True)]
            assert found[i, j] >= max(ways) - 1e-12
            arms = [side * 0.1 * np.eye(4)[axis] + np.eye(4)[3] for axis in (0, 1) for side in (1, -1)]
            frames = [each.T_base_part @ np.linalg.inv(T) for each in (one, two)]
            points = [T[:3, 3] + arm[:3] for arm in arms]
            ways += [np.linalg.norm((frames[0] - frames[1]) @ [*point, 1]) for point in points]
            assert found[i, j] == pytest.approx(max(ways), abs=1e-12)

    def test_a_turn_about_a_hole_is_a_distance(self, robot, tool):
        hole = Hole("A", np.array([0.5, 0.3, 0.8]), np.array([1.0, 0, 0]), 0.05)
        alone = Job(robot, tool, (hole,), Settings(), transform(np.eye(3), hole.target))
        turned = np.array([[0, 0, 0, 0.2]])
        assert Distance(alone)(turned, np.zeros((1, 4)))[0, 0] == pytest.approx(0.2 * np.sin(0.1))


class TestPlanted:
    freedom = Freedom((-0.2, 0.2), (-0.2, 0.2), (-0.2, 0.2))

    def test_the_nearest_lies_on_the_way_to_a_ball_and_the_room_in_its_middle(self, job, planted):
        centre = np.array([0.11, -0.05, 0.02])
        planted(within(centre, 0.07))
        found = place(job, self.freedom, grid=7, enough=0.01)
        assert found.nearest.distance == pytest.approx(np.linalg.norm(centre) - 0.07, abs=5e-4)
        np.testing.assert_allclose(
            found.nearest.place[:3], centre * (1 - 0.07 / np.linalg.norm(centre)), rtol=0, atol=3e-3
        )
        assert found.nearest.margins.min() >= 0.01
        assert found.roomiest.room == pytest.approx(0.07, abs=0.006)
        np.testing.assert_allclose(found.roomiest.place[:3], centre, rtol=0, atol=0.01)
        assert found.roomiest.margins.min() >= 0.01

    def test_the_nearest_and_the_room_may_lie_apart(self, job, planted):
        small, large = np.array([0.05, 0.02, 0]), np.array([-0.12, -0.08, 0])
        planted(lambda shift: max(within(small, 0.03, 2.0)(shift), within(large, 0.08)(shift)))
        found = place(job, Freedom((-0.25, 0.25), (-0.25, 0.25)), grid=11, enough=0.01)
        assert found.nearest.distance == pytest.approx(np.linalg.norm(small) - 0.03, abs=5e-4)
        assert found.roomiest.room == pytest.approx(0.08, abs=0.005)
        np.testing.assert_allclose(found.roomiest.place[:2], large[:2], rtol=0, atol=0.01)

    def test_a_corner_of_two_rules(self, job, planted):
        # enough where x >= 40 mm and y >= 30 mm: the nearest place is the corner, 50 mm away
        planted(lambda shift: 0.005 + min(0.3 * (shift[0] - 0.04), 0.5 * (shift[1] - 0.03)))
        found = place(job, Freedom((-0.1, 0.1), (-0.1, 0.1)), grid=6, enough=0.005)
        np.testing.assert_allclose(found.nearest.place[:2], [0.04, 0.03], rtol=0, atol=3e-4)
        # what lies beyond the ranges does not count: the room is that of the far side
        assert found.roomiest.place[0] == pytest.approx(0.1, abs=2e-3)
        assert found.roomiest.place[1] >= 0.088
        assert found.roomiest.room == pytest.approx(0.06, abs=0.004)

    def test_a_turn_counts_by_how_far_it_moves_a_hole(self, job, planted, monkeypatch):
        # enough where the part is turned by 8 to 20 deg: the room is half of that, by the way of the outermost hole
        here = job.holes[1].direction[:2]

        def deepest(drilling, settings):
            now = drilling.hole.direction[:2]
            turned = np.rad2deg(np.arctan2(here[0] * now[1] - here[1] * now[0], here @ now))
            return Deepest(max(0.0, 0.07 - 0.001 * abs(turned - 14)))

        monkeypatch.setattr("zerorev.placement.margins.deepest_in_cycle", deepest)
        found = place(job, Freedom((-0.01, 0.01), turn=(-1.5, 1.5)), grid=41, enough=0.014)
        arm = max(0.1, *(np.linalg.norm((hole.target - T[:3, 3])[:2]) for hole in job.holes))
        assert np.rad2deg(found.nearest.place[3]) == pytest.approx(8, abs=0.05)
        assert found.nearest.distance == pytest.approx(2 * arm * np.sin(np.deg2rad(4)), abs=2e-4)
        assert np.rad2deg(found.roomiest.place[3]) == pytest.approx(14, abs=1.5)
        # a shift takes some of the way back that a turn moves the holes: no more room than by the turn alone
        room = 2 * arm * np.sin(np.deg2rad(3))
        assert 0.6 * room < found.roomiest.room < 1.05 * room

    def test_where_it_stands_is_near_enough(self, job, planted):
        planted(within(np.zeros(3), 0.08))
        found = place(job, self.freedom, grid=3, enough=0.01)
        assert found.nearest.distance == 0
        np.testing.assert_array_equal(found.nearest.place, np.zeros(4))

    def test_everywhere(self, job, planted):
        planted(lambda shift: 0.05 - 0.01 * shift[0])
        found = place(job, Freedom((-0.1, 0.1)), grid=4, enough=0.01)
        assert np.isinf(found.roomiest.room)
        data = placement_data(job, Freedom((-0.1, 0.1)), found)["enough"]
        assert data["most_room"]["room_mm"] is None
        assert "every place that was examined has it" in said(job, found)

    def test_nowhere(self, job, planted):
        planted(within(np.zeros(3), 0.08))
        found = place(job, self.freedom, grid=3, enough=0.2)
        assert found.finished
        assert found.nearest is None
        assert placement_data(job, self.freedom, found)["enough"] == {
            "margin_mm": 200.0, "nearest": None, "most_room": None
        }  # fmt: skip
        assert "no place that was examined has 200 mm margin or more" in said(job, found)

    def test_brute_force_finds_none_nearer(self, job, planted):
        rule = lambda shift: 0.02 * np.sin(40 * shift[0] + 1) + 0.02 * np.cos(33 * shift[1])  # noqa: E731
        planted(rule)
        freedom = Freedom((-0.06, 0.2), (-0.1, 0.1))
        found = place(job, freedom, grid=9, enough=0.03)
        x, y = np.meshgrid(np.linspace(-0.06, 0.2, 521), np.linspace(-0.1, 0.1, 401))
        fine = rule([x, y]) >= 0.03
        assert found.nearest.distance == pytest.approx(np.hypot(x, y)[fine].min(), abs=1e-3)

    @pytest.mark.parametrize("enough", [-0.001, np.nan, np.inf])
    def test_a_margin_that_is_none(self, job, enough):
        with pytest.raises(InputError, match="enough-mm"):
            place(job, self.freedom, enough=enough)


def said(job, found):
    """What the terminal says."""
    return "\n".join(line.plain for line in placement_lines(job, TestPlanted.freedom, found))


HOLES = [{"id": f"H{k}", "target_mm": [0, 30 * k, 0], "direction": [1, 0, 0], "depth_mm": 80} for k in range(2)]
JOB = {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "part_frame": {"xyz_mm": [500, 300, 1000]}, "holes": HOLES}


def test_the_job_is_written_at_the_nearest_place(tmp_path, capsys):
    source, moved = tmp_path / "job.yaml", tmp_path / "moved.yaml"
    source.write_text(yaml.safe_dump(JOB))
    asked = ["place", str(source), "--z-mm=-200:0", "--grid", "5", "--write-job", str(moved), "--json"]
    assert cli.main([*asked, "--enough-mm", "20", "--cells", "0"]) == cli.FINE
    found = json.loads(capsys.readouterr().out)
    nearest = found["enough"]["nearest"]
    assert 0 < nearest["distance_mm"] < np.linalg.norm(found["best"]["shift_mm"])
    assert nearest["least_margin_mm"] >= 20
    plan = zr.plan_job(zr.read_job(moved))
    assert (plan.T_base_part[:3, 3] * 1e3).tolist() == pytest.approx(nearest["part_frame"]["xyz_mm"])
    assert min(hole.deepest - hole.hole.depth for hole in plan.holes) == pytest.approx(
        nearest["least_margin_mm"] / 1e3, abs=1e-6
    )
    moved.unlink()
    assert cli.main([*asked, "--enough-mm", "900", "--cells", "0"]) == cli.FOUND
    assert "no job written: no place that was examined has a margin of 900 mm" in capsys.readouterr().err
    assert not moved.exists()
