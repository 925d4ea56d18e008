"""The motion of a page in the virtual cell: in the background, as `zerorev simulate` does it, and free at any time."""

from __future__ import annotations

import asyncio
import json
import time
from dataclasses import replace

import numpy as np
import pytest

from zerorev.cell.ensemble import SIDES, band
from zerorev.cli import main
from zerorev.files.io import write_plan
from zerorev.model.job import Job, Settings
from zerorev.model.profile import Profile
from zerorev.model.ranges import RANGES, Cell, Conditioning
from zerorev.planning.hole import plan
from zerorev.planning.job import unanswered
from zerorev.web import computing
from zerorev.web.computing import Work
from zerorev.web.real_arm import Asked, outdated
from zerorev.web.session import Session
from zerorev.web.simulating import BLOCK, simulate
from zerorev.web.state import Steered, opened_job, opened_plan, selected, shown, steered

PATIENCE = 60.0  # [s]
FAST = Asked(arms=BLOCK + 2, seed=3, feed=0.1, thrust=20.0)


@pytest.fixture(scope="module")
def planned(robot, tool, positions):
    """The published motions of positions 1 and 2, evaluated and checked."""
    settings = Settings(min_rate=0.0, lead_in=0.0, proof_boxes=0)
    job = Job(robot, tool, tuple(each.hole for each in positions[:2]), settings)
    holes = (plan(robot, tool, replace(each.hole, profile=each.profile), settings) for each in positions[:2])
    return unanswered(job, "asked", tuple(holes))


async def done(work: Work) -> None:
    deadline = time.monotonic() + PATIENCE
    while work.busy:
        assert time.monotonic() < deadline, "it takes too long"
        await asyncio.sleep(0.02)


def simulated(state, asked):
    """All that a page shows of the selected hole on the way, and the state at the end."""
    seen = []

    async def run():
        work = Work(Session(state))
        work.session.watch(lambda _, after: seen.append(after.arm.simulated.get(after.selected)))
        assert simulate(work, asked)
        assert work.session.state.progress.title == f"simulating hole {state.selected} on {asked.arms} arms"
        await done(work)
        return work.session.state

    end = asyncio.run(run())
    return [each for each in {id(each): each for each in seen}.values() if each is not None], end


def test_the_figures_are_those_of_the_command_line(planned, tmp_path, capsys):
    write_plan(planned, tmp_path / "plan.json")
    arguments = ["--sets", str(FAST.arms), "--seed", "3", "--feed-mm-s", "100", "--thrust-n", "20", "--json"]
    assert main(["simulate", str(tmp_path / "plan.json"), *arguments]) == 0
    said = json.loads(capsys.readouterr().out)["holes"][0]
    _, state = simulated(opened_plan(planned), FAST)
    found = state.arm.simulated[state.selected]
    study = found.study
    assert (said["id"], study.sets, len(found.arms.sets)) == (study.id, FAST.arms, FAST.arms)
    assert outdated(found, state, shown(state)) is None
    for k, side in enumerate(SIDES):
        for motion in ("baseline", "plan"):
            values = band(study.deviation[study.of(motion), k])
            assert [round(value * 1e3, 4) for value in values] == list(said["deviation_mm"][motion][side].values())
            assert round(study.speed[study.of(motion)] * 1e3, 3) == said["feed_mm_s"][motion]
        gain = band(study.gain()[k])
        assert [round(value * 100, 1) for value in gain] == list(said["gain_percent"][side].values())


def test_it_grows_while_it_is_computed_and_stays_when_it_is_stopped(planned):
    seen, state = simulated(opened_plan(planned), replace(FAST, arms=2 * BLOCK))
    assert state.progress is None
    assert seen[-1].study.sets == 2 * BLOCK
    assert {each.study.sets for each in seen} <= {BLOCK, 2 * BLOCK}

    async def run():
        work = Work(Session(opened_plan(planned)))
        assert simulate(work, replace(FAST, arms=1000))
        assert not simulate(work, FAST)  # one at a time
        while not work.session.state.arm.simulated:
            await asyncio.sleep(0.02)
        work.cancel()
        return work.session.state

    state = asyncio.run(run())
    assert state.progress is None
    assert 0 < state.arm.simulated[state.selected].study.sets < 1000


def test_a_motion_by_hand_is_simulated_as_it_is_shown(planned):
    state = opened_plan(planned)
    profile = planned.holes[0].motion.profile
    by_hand = Steered(Profile(profile.standoff, profile.psi + np.array([0.05, 0.0, -0.05])), 4)
    _, end = simulated(steered(state, by_hand), FAST)
    found = end.arm.simulated[end.selected]
    assert found.motion is by_hand
    assert outdated(found, end, shown(end)) is None
    assert outdated(found, end, shown(state)) == "the motion has changed since"
    _, as_planned = simulated(state, FAST)
    assert not np.array_equal(found.study.profile, as_planned.arm.simulated[state.selected].study.profile)


def test_a_motion_that_cannot_be_run_is_one_message(planned):
    far = Steered(Profile.straight(planned.holes[0].hole.depth, 0.0, 0.0, 3.1), 4)
    seen, state = simulated(steered(opened_plan(planned), far), FAST)
    assert not seen
    assert state.trouble == f"hole {state.selected}: it cannot be simulated: it has no motion"


def test_only_arms_near_what_was_measured(planned):
    ids = [hole.hole.id for hole in planned.holes]
    known = Cell({"gap": RANGES["gap"]}, Conditioning({ids[0]: 0.2e-3, ids[1]: 0.14e-3, "elsewhere": 1e-3}, 0.2, 10e-3))
    state = opened_plan(planned)
    state = replace(state, arm=replace(state.arm, cell=known, file="cell.yaml"))
    _, state = simulated(state, replace(FAST, arms=20))
    found = state.arm.simulated[state.selected]
    assert (found.arms.drawn, found.arms.measured) == (20, 2)
    assert found.study.sets == len(found.arms.sets) < 20
    nowhere = replace(known, conditioning=Conditioning({ids[0]: 50e-3}, 0.2, 10e-3))
    state = replace(state, arm=replace(state.arm, cell=nowhere))
    _, state = simulated(state, replace(FAST, arms=BLOCK))
    assert "none of 5 sets has a baseline" in state.trouble


def test_it_gives_way_to_a_hole_that_has_to_be_planned(planned, positions):
    state = opened_plan(planned)
    job = replace(state.job, holes=(*state.job.holes, positions[2].hole))

    async def run():
        work = Work(Session(replace(state, job=job)))
        assert simulate(work, replace(FAST, arms=1000))
        work.session.change(selected(work.session.state, positions[2].hole.id))
        computing.plan_selected(work)
        assert work.session.state.progress.title == f"planning hole {positions[2].hole.id}"
        await done(work)
        return work.session.state

    assert asyncio.run(run()).answer.motion is not None


def test_without_a_motion_nothing_is_begun(planned):
    work = Work(Session(opened_job(Job(planned.robot, planned.tool, (planned.holes[0].hole,)))))
    assert not simulate(work, FAST)
    assert work.session.state.progress is None
