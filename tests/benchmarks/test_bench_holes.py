"""The benchmark's random holes: resumed after a kill, and the same for any number of workers."""

from __future__ import annotations

import json
from dataclasses import asdict, replace

import pytest
from benchmarks.finished import Finished
from benchmarks.parts import Options, holes
from benchmarks.peers.objective import NumbaObjective
from benchmarks.peers.swarm import swarm

QUICK = Options(holes=2, peer_seeds=1, workers=1)


class TestFinished:
    KEY = staticmethod(lambda entry: entry["n"])

    def test_is_read_again(self, tmp_path):
        path = tmp_path / "new" / "lines.jsonl"
        first = Finished(path, {"seeds": 2}, self.KEY)
        assert first.known == {}
        first.add({"n": 1, "x": 0.1})
        first.add({"n": 5, "x": 0.2})
        assert Finished(path, {"seeds": 2}, self.KEY).known == {1: {"n": 1, "x": 0.1}, 5: {"n": 5, "x": 0.2}}

    def test_what_was_made_otherwise_is_not(self, tmp_path):
        path = tmp_path / "lines.jsonl"
        Finished(path, {"seeds": 2}, self.KEY).add({"n": 1})
        assert Finished(path, {"seeds": 3}, self.KEY).known == {}
        assert path.read_text() == ""

    @pytest.mark.parametrize("end", ['{"made_with": {"seeds": 2}, "n": 2', "\x00\x00", "3\n", "\n"])
    def test_a_line_that_was_cut_short_is_none(self, tmp_path, end):
        path = tmp_path / "lines.jsonl"
        Finished(path, {"seeds": 2}, self.KEY).add({"n": 1})
        path.write_text(path.read_text() + end)
        again = Finished(path, {"seeds": 2}, self.KEY)
        assert again.known == {1: {"n": 1}}
        again.add({"n": 2})  # on a line of its own
        assert list(Finished(path, {"seeds": 2}, self.KEY).known) == [1, 2]

    def test_is_gone_in_the_end(self, tmp_path):
        finished = Finished(tmp_path / "lines.jsonl", {}, self.KEY)
        finished.add({"n": 1})
        finished.remove()
        assert list(tmp_path.iterdir()) == []


def without_times(figures):
    return [{key: value for key, value in one.items() if "seconds" not in key} for one in figures["holes"]]


class KilledError(Exception):
    """In place of a signal."""


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A run that nothing disturbed."""
    return holes.run(replace(QUICK, folder=tmp_path_factory.mktemp("bench")))


class TestHoles:
    def test_near_their_deepest_and_anywhere_by_turns(self):
        some = list(holes._holes(4))
        assert [hole.near for hole in some] == [True, False, True, False]
        assert [hole.seed for hole in some] == sorted({hole.seed for hole in some})
        assert all(0.9 <= hole.depth / hole.deepest[0] <= 0.995 for hole in some if hole.near)

    def test_every_answer_of_every_seed_is_judged(self, whole):
        for one in whole.figures["holes"]:
            branches = sum(one["verdicts"].values()) - 3 * QUICK.peer_seeds
            assert 1 <= branches <= 8
            assert one["peer_seeds"] == QUICK.peer_seeds
        assert whole.failures == []
        assert [row[1:3] for row in whole.rows] == [("1", "1"), ("1", "1")]

    def test_a_run_that_was_killed_is_resumed(self, tmp_path, monkeypatch):
        options, asked, undisturbed = replace(QUICK, folder=tmp_path), [], tmp_path / "undisturbed"
        monkeypatch.setattr(holes, "_branch_by_branch", lambda case: {})

        def peers(case, ours, seed):
            return {"small swarm": swarm(NumbaObjective(case), seed, particles=20, iterations=5)}

        def killed_at_the_second(case, ours, seed):
            asked.append(case.hole.id)
            if len(asked) == 2:
                raise KilledError
            return peers(case, ours, seed)

        monkeypatch.setattr(holes, "_peers", peers)
        whole = holes.run(replace(options, folder=undisturbed))
        monkeypatch.setattr(holes, "_peers", killed_at_the_second)
        with pytest.raises(KilledError):
            holes.run(options)
        assert len((tmp_path / "holes.jsonl").read_text().splitlines()) == 1
        resumed = holes.run(options)
        assert len(asked) == 3
        assert asked[1] == asked[2] != asked[0]  # the first is not asked for again
        assert without_times(resumed.figures) == without_times(whole.figures)
        assert list(tmp_path.rglob("*.jsonl")) == []

    @pytest.mark.parametrize(("field", "value"), [("ours", [0.0, 0.1, 0.2, 0.3]), ("ours", None), ("depth", 0.05)])
    def test_a_hole_whose_answer_has_changed_is_examined_again(self, field, value, monkeypatch):
        monkeypatch.setattr(holes, "_peers", lambda case, ours, seed: {})
        monkeypatch.setattr(holes, "_branch_by_branch", lambda case: {})
        hole = next(holes._holes(1))
        before = asdict(holes._look_at(1, (hole, None)))
        kept = before | {"beaten": ["as it was"]}
        assert holes._look_at(1, (hole, kept)).beaten == ["as it was"]
        assert holes._look_at(1, (hole, kept | {field: value})).beaten == []

    def test_with_other_seeds_all_are_examined_again(self):
        made = [json.dumps(holes._made_with(count)) for count in (1, 2, 1)]
        assert made[0] == made[2] != made[1]

    @pytest.mark.long
    def test_any_number_of_workers_sees_the_same(self, whole, tmp_path):
        shared = holes.run(replace(QUICK, workers=2, folder=tmp_path))
        assert without_times(shared.figures) == without_times(whole.figures)
        assert shared.failures == whole.failures
