"""The parameter map against direct evaluation, its mirror, its store, and what cannot be mapped."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from zerorev.errors import InputError, OutputError
from zerorev.motion.drilling import Drilling
from zerorev.thesis import parameter_map as module
from zerorev.thesis.measures import best_cell, mirrored, zero_reversals
from zerorev.thesis.parameter_map import AXES, parameter_map, spin_axis
from zerorev.thesis.sampled import THESIS_MIN_RATE, SampledObjective, Weighing
from zerorev.thesis.store import MARK, read_map, write_map

WAYS = {
    "after the extents": Weighing(),
    "at the first point": Weighing(turns="first_point"),
    "with a motion threshold": Weighing(min_rate=THESIS_MIN_RATE),
    "with a mean threshold": Weighing(min_rate=THESIS_MIN_RATE, min_rate_rule="mean", turns="first_point"),
    "other weights": Weighing(reversals=0.3, travel=2.0),
}


@pytest.fixture(scope="module")
def found(robot, tool, positions):
    """A whole map of position 1, small."""
    return parameter_map(robot, tool, positions[0].hole, size=30)


def drawn(found, count, seed):
    """Random cells: their indices and spins [rad] (start, target, end)."""
    rng = np.random.default_rng(seed)
    t, s, e = (rng.integers(0, found.sizes[name], count) for name in AXES)
    psi = np.deg2rad(found["psi_start_deg"].values)
    return (t, s, e), np.stack([psi[s], np.deg2rad(found["psi_target_deg"].values)[t], psi[e]], axis=1)


class TestCells:
    @pytest.mark.parametrize("weighing", WAYS.values(), ids=WAYS)
    def test_a_thousand_random_cells_are_what_the_objective_says(self, robot, tool, position, weighing):
        found = parameter_map(robot, tool, position.hole, weighing, size=40)
        cells, spins = drawn(found, 1000, seed=1)
        judged = SampledObjective(Drilling(robot, tool, position.hole), weighing).judged(spins)
        np.testing.assert_allclose(found["score"].values[cells], judged.score, rtol=0, atol=1e-9)
        np.testing.assert_array_equal(found["reversals"].values[cells], judged.reversals)
        runs = judged.reversals >= 0
        assert 20 < runs.sum() < 980, "the cells show too little"
        np.testing.assert_array_equal(found["branch"].values[cells][runs], judged.branch[runs])
        cost = weighing.reversals / 6 * judged.reversals + weighing.travel * found["travel_deg"].values[cells] / 2160
        np.testing.assert_allclose(cost[runs], judged.score[runs], rtol=0, atol=1e-9)
        assert np.isnan(found["travel_deg"].values[cells][~runs]).all()
        assert (found["branch"].values[cells][~runs] == -1).all()

    def test_where_limits_bind_they_are_the_objectives(self, robot, tool, positions):
        narrow = replace(robot.limits, upper=robot.limits.upper * [1, 1, 1, 0.3, 0.8, 0.2])
        bound = replace(robot, limits=narrow)
        for weighing in (Weighing(), Weighing(turns="first_point")):
            free = parameter_map(robot, tool, positions[0].hole, weighing, size=24)
            found = parameter_map(bound, tool, positions[0].hole, weighing, size=24)
            assert (found["score"].values > free["score"].values + 1e-6).sum() > 100
            cells, spins = drawn(found, 1000, seed=2)
            judged = SampledObjective(Drilling(bound, tool, positions[0].hole), weighing)(spins)
            np.testing.assert_allclose(found["score"].values[cells], judged, rtol=0, atol=1e-9)

    def test_out_of_reach_every_cell_costs_one(self, robot, tool, positions):
        far = replace(positions[0].hole, target=np.array([2.0, 0.3, 0.8]))
        found = parameter_map(robot, tool, far, size=4)
        assert (found["score"].values == 1.0).all()
        assert (found["reversals"].values == -1).all()
        assert best_cell(found).reversals == -1

    def test_only_the_branch_of_the_hole(self, robot, tool, positions):
        found = parameter_map(robot, tool, replace(positions[0].hole, branch=4), size=30)
        assert set(np.unique(found["branch"].values)) == {-1, 4}

    def test_threads_and_slices_change_no_bit(self, robot, tool, positions, found):
        alone = parameter_map(robot, tool, positions[0].hole, size=30, threads=1)
        assert alone.identical(found)
        some = parameter_map(robot, tool, positions[0].hole, size=30, psi_target=spin_axis(30)[[3, 17]], threads=3)
        assert some.identical(found.isel(psi_target_deg=[3, 17]))

    def test_progress_counts_to_the_end(self, robot, tool, positions):
        reported = []
        parameter_map(robot, tool, positions[0].hole, size=20, progress=lambda done, of: reported.append((done, of)))
        assert reported[0] == (0, 20)
        assert reported[-1] == (20, 20)
        assert reported == sorted(reported)


class TestMirror:
    def test_after_the_extents_the_map_is_its_mirror(self, found):
        mirror = mirrored([found])
        assert (mirror.differing, mirror.greatest, mirror.lost) == (0.0, 0.0, 0.0)

    def test_at_the_first_point_a_block_is_missing(self, robot, tool, positions):
        found = parameter_map(robot, tool, positions[0].hole, Weighing(turns="first_point"), size=30)
        mirror = mirrored([found])
        assert mirror.lost > 0.005
        assert mirror.greatest > 0.5
        parts = (found.isel(psi_target_deg=slice(k, k + 7)) for k in range(0, 30, 7))
        assert mirrored(parts) == mirror

    def test_the_thesis_two_motions(self, robot, tool, positions):
        # sec. 4.7: psi = [-1, 0, 1] runs on one branch alone, with 3 reversals, its mirror on none
        at = {"size": 3, "psi_range": (-1.0, 1.0), "psi_target": [0.0]}
        for turns, there in (("first_point", -1), ("after_extents", 3)):
            found = parameter_map(robot, tool, positions[0].hole, Weighing(turns=turns), **at)
            reversals = found["reversals"].values[0]
            assert reversals[0, 2] == 3
            assert reversals[2, 0] == there

    def test_the_published_optimum_off_the_grid(self, robot, tool, positions):
        start, target, end = np.deg2rad(positions[0].psi_deg)
        objective = SampledObjective(Drilling(robot, tool, positions[0].hole))
        score, back = objective(np.array([[start, target, end], [end, target, start]]))
        assert score == pytest.approx(back, abs=1e-9)
        found = parameter_map(robot, tool, positions[0].hole, size=2, psi_range=(end, start), psi_target=[target])
        assert found["score"].values[0, 1, 0] == pytest.approx(score, abs=1e-9)
        assert found["reversals"].values[0].tolist()[1][0] == found["reversals"].values[0].tolist()[0][1] == 0
        assert found["travel_deg"].values[0, 1, 0] == pytest.approx(positions[0].travel_deg, abs=0.1)


class TestMeasures:
    def test_zero_reversals_counts_and_weighs(self, found):
        zero = zero_reversals(found)
        assert zero.cells == int((found["reversals"].values == 0).sum()) > 10
        assert zero.share == zero.cells / 30**3
        whole = found.assign(reversals=found["reversals"] * 0)
        assert zero_reversals(whole).volume == pytest.approx(1.0)
        corner = found.assign(reversals=found["reversals"] * 0 + 1)
        corner["reversals"].values[0, 0, 0] = 0
        assert zero_reversals(corner).volume == pytest.approx((0.5 / 29) ** 3)

    def test_the_best_cell_is_the_least_score(self, found):
        best = best_cell(found)
        assert best.score == found["score"].values.min()
        start, target, end = best.psi_deg
        cell = found.sel(psi_start_deg=start, psi_target_deg=target, psi_end_deg=end)
        assert (float(cell["score"]), int(cell["reversals"]), int(cell["branch"])) == (best.score, 0, best.branch)


class TestStore:
    def test_comes_back_as_it_was(self, found, tmp_path):
        write_map(found, tmp_path / "map.zarr")
        again = read_map(tmp_path / "map.zarr")
        assert again.identical(found)
        assert again["psi_end_deg"].attrs["units"] == "deg"
        assert [path.name for path in tmp_path.iterdir()] == ["map.zarr"]

    def test_an_older_map_is_replaced_and_nothing_else_is(self, found, tmp_path):
        write_map(found, tmp_path / "map.zarr")
        write_map(found.isel(psi_target_deg=[5]), tmp_path / "map.zarr")
        assert read_map(tmp_path / "map.zarr").sizes["psi_target_deg"] == 1
        assert [path.name for path in tmp_path.iterdir()] == ["map.zarr"]
        mine = tmp_path / "mine"
        mine.mkdir()
        (mine / "diary.txt").write_text("dear diary")
        with pytest.raises(OutputError, match="something else"):
            write_map(found, mine)
        assert (mine / "diary.txt").read_text() == "dear diary"

    def test_a_failure_leaves_the_older_map(self, found, tmp_path, monkeypatch):
        write_map(found, tmp_path / "map.zarr")

        def fail(*_, **__):
            raise OSError("the disk is full")

        monkeypatch.setattr(type(found), "to_zarr", fail)
        with pytest.raises(OutputError, match="the disk is full"):
            write_map(found.isel(psi_target_deg=[5]), tmp_path / "map.zarr")
        assert read_map(tmp_path / "map.zarr").identical(found)
        assert [path.name for path in tmp_path.iterdir()] == ["map.zarr"]

    def test_what_is_not_a_map_is_refused(self, found, tmp_path):
        with pytest.raises(InputError, match="no folder of zarr"):
            read_map(tmp_path)
        found[["score"]].to_zarr(tmp_path / "other.zarr", consolidated=False)
        with pytest.raises(InputError, match="not a parameter map"):
            read_map(tmp_path / "other.zarr")
        (tmp_path / "broken").mkdir()
        (tmp_path / "broken" / MARK).write_text("{")
        with pytest.raises(InputError, match="cannot be read"):
            read_map(tmp_path / "broken")


class TestRefused:
    def test_too_large_for_memory_before_anything_is_evaluated(self, robot, tool, positions, monkeypatch):
        monkeypatch.setattr(module, "cube", lambda *_: pytest.fail("it was begun"))
        with pytest.raises(InputError, match=r"20000 x 20000 x 20000 spins needs .* GiB of memory, .* are there"):
            parameter_map(robot, tool, positions[0].hole, size=20_000)
        monkeypatch.setattr(module, "_memory_available", lambda: 1e6)
        with pytest.raises(InputError, match=r"needs 21 MiB of memory, 1 MiB are there .*about 35 or less"):
            parameter_map(robot, tool, positions[0].hole)

    @pytest.mark.parametrize("size", [1, 0, -3, 2.5, True])
    def test_no_such_size(self, robot, tool, positions, size):
        with pytest.raises(InputError, match="size"):
            parameter_map(robot, tool, positions[0].hole, size=size)

    @pytest.mark.parametrize(
        "wrong", [{"psi_range": (1.0, 1.0)}, {"psi_range": (0.0, np.inf)}, {"psi_target": []}, {"psi_target": [np.nan]},
                  {"samples": 3}, {"threads": 0}],
        ids=str,
    )  # fmt: skip
    def test_no_such_spins_samples_or_threads(self, robot, tool, positions, wrong):
        with pytest.raises(InputError):
            parameter_map(robot, tool, positions[0].hole, size=3, **wrong)
