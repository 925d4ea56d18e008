"""Which robot takes which hole: against every possible share, and on real robots side by side."""

from __future__ import annotations

import json
from itertools import product

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

import zerorev as zr
from zerorev import cli
from zerorev.errors import InputError
from zerorev.files.io import job_from_dict
from zerorev.placement.sharing import assigned, share
from zerorev.search.deepest import deepest_stroke

CANNOT = -0.01
tables = st.integers(2, 3).flatmap(
    lambda robots: st.integers(1, 5).flatmap(
        lambda holes: st.lists(
            st.lists(st.sampled_from([CANNOT, np.nan, 0.0, 0.01, 0.02, 0.03, 0.05]), min_size=holes, max_size=holes),
            min_size=robots, max_size=robots,
        )
    )
)  # fmt: skip


def best_balanced(margins):
    """(greatest load, least margin, sum) of the best of all shares, each tried."""
    robots, holes = margins.shape
    best = None
    for takers in product(range(robots), repeat=holes):
        taken = margins[list(takers), range(holes)]
        if not (taken >= 0).all():
            continue
        load = max(-(-holes // robots), *np.bincount(takers, minlength=robots))
        rank = (-load, taken.min(), round(float(taken.sum()), 9))
        best = rank if best is None else max(best, rank)
    return best


class TestAssigned:
    @given(tables)
    def test_each_to_the_greatest_margin(self, table):
        margins = np.array(table)
        taken = assigned(margins)
        for k, robot in enumerate(taken):
            able = [m for m in margins[:, k] if m >= 0]
            assert (robot == -1) if not able else (margins[robot, k] == max(able))

    @given(tables)
    def test_balanced_is_the_best_of_all_shares(self, table):
        margins = np.array(table)
        taken = assigned(margins, balance=True)
        drillable = (margins >= 0).any(axis=0)
        np.testing.assert_array_equal(taken >= 0, drillable)
        left, takers = margins[:, drillable], taken[drillable]
        if not takers.size:
            return
        held = left[takers, range(takers.size)]
        load = max(-(-takers.size // len(margins)), *np.bincount(takers, minlength=len(margins)))
        assert (-load, held.min(), round(float(held.sum()), 9)) == best_balanced(left)


HOLES = [
    {"id": f"H{k}", "target_mm": [0, y, 0], "direction": [1, 0, 0], "depth_mm": 60}
    for k, y in enumerate((-150, 0, 150))
]


def job_data(y_mm, **other):
    """A row of holes, as seen from a robot that stands to one side of it."""
    frame = {"xyz_mm": [500, y_mm, 900]}
    return {"robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "part_frame": frame, "holes": HOLES} | other


class TestShare:
    def test_margins_are_the_deepest_strokes_less_the_depths(self):
        jobs = [job_from_dict(job_data(y)) for y in (300, -450)]
        shares = share(jobs)
        for job, margins in zip(jobs, shares.margins, strict=True):
            exact = [deepest_stroke(job.robot, job.tool, hole, job.settings).depth - 0.06 for hole in job.holes]
            np.testing.assert_array_equal(margins, exact)
        assert (
            shares.taken_by.tolist()
            == np.where(shares.margins.max(axis=0) >= 0, shares.margins.argmax(axis=0), -1).tolist()
        )
        assert shares.least == shares.margins.max(axis=0).min()

    def test_a_hole_of_one_job_alone(self):
        alone = HOLES[0] | {"id": "alone"}
        shares = share([job_from_dict(job_data(300, holes=[HOLES[1]])), job_from_dict(job_data(300, holes=[alone]))])
        assert shares.ids == ("H1", "alone")
        np.testing.assert_array_equal(np.isnan(shares.margins), [[False, True], [True, False]])
        assert shares.taken_by[1] in (1, -1)

    @pytest.mark.parametrize("wrong", [{"target_mm": [0, 0, 1]}, {"direction": [1, 0, 0.01]}, {"depth_mm": 61}])
    def test_another_hole_of_the_same_id(self, wrong):
        other = job_from_dict(job_data(0, holes=[HOLES[1] | wrong]))
        with pytest.raises(InputError, match="hole H1"):
            share([job_from_dict(job_data(300)), other])

    def test_one_job_and_given_motions(self):
        job = job_from_dict(job_data(300))
        with pytest.raises(InputError, match="two jobs"):
            share([job])
        with pytest.raises(InputError, match="given motion"):
            share([job, job_from_dict(job_data(300, holes=[HOLES[0] | {"psi_deg": [0, 1, 2]}]))])


class TestCommand:
    @pytest.fixture
    def files(self, tmp_path):
        paths = [tmp_path / f"{name}.yaml" for name in "ab"]
        for path, y in zip(paths, (300, -450), strict=True):
            path.write_text(yaml.safe_dump(job_data(y)))
        return [str(path) for path in paths]

    def test_every_hole_is_drilled_by_the_robot_that_takes_it(self, files, tmp_path, capsys):
        answer, folder = tmp_path / "share.json", tmp_path / "shared"
        code = cli.main(["share", *files, "--balance", "-o", str(answer), "--write-jobs", str(folder)])
        data = json.loads(answer.read_text())
        assert code == (cli.FOUND if any(hole["taken_by"] is None for hole in data["holes"]) else cli.FINE)
        out = capsys.readouterr().out
        assert "margin of a" in out
        seen = []
        for r, name in enumerate("ab"):
            mine = {hole["id"]: hole["margin_mm"][r] for hole in data["holes"] if hole["taken_by"] == r}
            assert len(mine) == data["robots"][r]["holes"] > 0
            for hole in zr.plan_job(zr.read_job(folder / f"{name}.yaml")).holes:
                assert hole.score.reversals == 0
                assert (hole.deepest - 0.06) * 1e3 == pytest.approx(mine[hole.hole.id], abs=1e-3)
                seen.append(hole.hole.id)
        assert sorted(seen) == [hole["id"] for hole in data["holes"] if hole["taken_by"] is not None]

    def test_the_jobs_are_not_written_over(self, files, tmp_path, capsys):
        assert cli.main(["share", *files, "--write-jobs", str(tmp_path)]) == cli.BAD_INPUT
        assert "which is read" in capsys.readouterr().err
        assert cli.main(["share", *files, "-o", files[1]]) == cli.BAD_INPUT

    def test_two_jobs_of_one_name(self, files, tmp_path, capsys):
        assert cli.main(["share", files[0], files[0], "--write-jobs", str(tmp_path / "new")]) == cli.BAD_INPUT
        assert "--write-jobs" in capsys.readouterr().err

    def test_one_job(self, files, capsys):
        assert cli.main(["share", files[0]]) == cli.BAD_INPUT
        assert "two jobs" in capsys.readouterr().err
