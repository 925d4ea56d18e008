"""What the twist map tells its component, and what it makes of what the user does; without a browser."""

from __future__ import annotations

import asyncio
import base64
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("nicegui")

from oracles.published import POSITIONS
from zerorev.model.job import Job, Settings
from zerorev.model.plan import HolePlan
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluate
from zerorev.motion.kinematics import wrist_offset
from zerorev.motion.loads import lost_motion_of
from zerorev.report.scene.twist_map import LIMITED, UNREACHED, twist_map
from zerorev.web.job_edits import answered
from zerorev.web.session import Session
from zerorev.web.state import Steered, opened_job, selected, steered
from zerorev.web.views import twist_map as view

PLANNED = Profile.straight(0.05, *np.deg2rad([20.6, 1.12, -25.37]))


@pytest.fixture
def session(robot, tool):
    """The three positions of the thesis, of which the first is planned."""
    job = Job(robot, tool, tuple(position.hole for position in POSITIONS), Settings(min_rate=0.0))
    hole, branch = POSITIONS[0].hole, POSITIONS[0].branch
    found = evaluate(robot, tool, hole, PLANNED, branch)
    plan = HolePlan(hole, "planned", wrist_offset(robot, tool), found.motion, found.score)
    return Session(answered(opened_job(job), plan))


class Component:
    """Stands in for the component in the browser: keeps what it is reported."""

    def __init__(self):
        self.reported = []
        self.handlers = {}

    def classes(self, _):
        return self

    def on(self, name, handler):
        self.handlers[name] = handler

    def run_method(self, name, *args):
        self.reported.append((name, *args))

    def last(self, name):
        return next(args for each, *args in reversed(self.reported) if each == name)[0]


@pytest.fixture
def on_page(session, monkeypatch):
    """Run an exchange with the map on a page: exchange(component, do), where do(event, **arguments) is the user."""

    def run(exchange):
        component = Component()
        monkeypatch.setattr(view, "_Element", lambda: component)
        monkeypatch.setattr(view.ui, "add_css", lambda _: None)

        async def soon(call):
            return call()

        monkeypatch.setattr(view, "aside", soon)
        tasks = []
        monkeypatch.setattr(view.background_tasks, "create", lambda job: tasks.append(asyncio.ensure_future(job)))

        def do(event, **arguments):
            handler = component.handlers[event]
            handler(SimpleNamespace(args=arguments)) if arguments else handler()

        async def main():
            view.twist_map(session)
            do("ready")
            await exchange(component, do)
            await asyncio.gather(*tasks)

        asyncio.run(main())
        return component

    return run


def points(psi_deg, standoff_mm=(50, 0, 50)):
    return [[n, psi, standoff] for n, (psi, standoff) in enumerate(zip(psi_deg, standoff_mm, strict=True))]


def psi_of(state):
    return np.rad2deg(state.steered.profile.psi)


def test_the_plan_is_shown_first(on_page, session):
    async def nothing(component, do):
        pass

    reported = on_page(nothing)
    motion = reported.last("show_motion")
    assert motion["reversals"] == 0
    assert motion["runs"]
    assert not motion["edited"]
    assert np.array(motion["points"]) == pytest.approx(np.array([[50, 20.6], [0, 1.12], [50, -25.37]]))
    score = session.state.answer.score
    assert float(motion["travel"]) == pytest.approx(np.rad2deg(score.travel), abs=0.06)
    assert float(motion["margin"]) == pytest.approx(np.rad2deg(score.min_rate.min()) * 1e-3, abs=6e-4)
    assert motion["baseline"] == 6
    assert reported.last("show_map")["branch"] == POSITIONS[0].branch
    labels = {each["value"]: each["label"] for each in reported.last("show_branches")}
    assert list(labels) == [*"01234567", "all"]
    assert labels[str(POSITIONS[0].branch)].endswith("0 reversals")


def test_the_map_that_is_sent_is_the_map(on_page, session, robot, tool):
    async def nothing(component, do):
        pass

    sent = on_page(nothing).last("show_map")
    found = twist_map(Drilling(robot, tool, POSITIONS[0].hole), POSITIONS[0].branch)

    def grid(name):
        return np.frombuffer(base64.b64decode(sent[name]), dtype=np.uint8).reshape(sent["shape"])

    assert (grid("zone") == found.zone).all()
    assert (grid("limited") == found.limited).all()
    assert sent["reach"] == pytest.approx(50)
    floor, cap = sent["spread_range"]
    shades = grid("spread")
    assert ((shades == 255) == np.isnan(found.spread)).all()
    between = (shades > 0) & (shades < 254)
    back = floor * (cap / floor) ** (shades[between] / 254)
    assert back == pytest.approx(found.spread[between], rel=0.01)
    for line, ours in zip(sent["lines"], found.lines, strict=True):
        flat = np.array(line["points"]).reshape(-1, 2)
        assert flat == pytest.approx(
            np.column_stack([ours.points[:, 0] * 1e3, np.rad2deg(ours.points[:, 1])]), abs=1e-3
        )
    legend = {each["zone"]: each["text"] for each in sent["legend"]}
    assert legend[UNREACHED] == "out of reach"
    assert legend[LIMITED] == "over a joint limit (A5)"


def test_a_drag_is_answered_at_once_and_passed_on_later(on_page, session, robot, tool):
    changes = []
    session.watch(lambda before, after: changes.append(after))

    async def exchange(component, do):
        do("grab")
        for seq, psi in enumerate((0.0, -3.0, -5.94), start=1):
            do("drag", points=points((14.16, psi, -14.0)), seq=seq, ms=10.0)
            answer = component.last("show_motion")
            assert answer["seq"] == seq
            score = evaluate(
                robot, tool, POSITIONS[0].hole, Profile.straight(0.05, *np.deg2rad([14.16, psi, -14.0])), 4
            ).score
            assert answer["reversals"] == score.reversals
            assert [each["count"] for each in answer["joints"]] == list(score.reversals_per_joint)
            assert [mark["joint"] for mark in answer["marks"]] == [event.joint for event in score.events]
            assert answer["edited"]
        assert changes == []
        await asyncio.sleep(view.SOONEST + 0.2)
        assert len(changes) == 1  # three drags, one change
        assert psi_of(session.state) == pytest.approx([14.16, -5.94, -14.0])
        do("drop", points=points((14.16, -6.5, -14.0)))
        assert psi_of(session.state) == pytest.approx([14.16, -6.5, -14.0])
        assert component.last("show_motion")["seq"] is None

    on_page(exchange)


def test_the_lost_motion_of_a_drag_and_of_its_twin_are_shown_at_once(on_page, session, robot, tool):
    drilling = Drilling(robot, tool, POSITIONS[0].hole)

    async def exchange(component, do):
        do("grab")
        for seq, spins in enumerate(((14.16, -5.94, -30.0), (10.0, 0.0, -20.0)), start=1):
            do("drag", points=points(spins), seq=seq, ms=10.0)
            profile = Profile.straight(0.05, *np.deg2rad(spins))
            found = lost_motion_of(drilling, profile, POSITIONS[0].branch)
            answer = component.last("show_motion")
            assert answer["lost"] == (f"{found.at_tip * 1e3:.3f}", f"{found.twin_at_tip * 1e3:.3f}")
            turns = np.diff(drilling.angles(*profile.at(np.linspace(0, 0.05, 50)))[:, POSITIONS[0].branch], axis=0)
            assert answer["senses"]["plunge"] == tuple(
                tuple(sorted(set(np.sign(turns[:, i]).astype(int)))) for i in range(6)
            )

    sent = on_page(exchange).last("show_map")["loads"]
    found = twist_map(drilling, POSITIONS[0].branch).load_lines
    assert [(each["joint"], each["sense"], each["level"]) for each in sent] == [
        (line.joint, line.sense, f"{line.level:.0%}") for line in found
    ]
    for each, line in zip(sent, found, strict=True):
        flat = np.array(each["points"]).reshape(-1, 2)
        assert flat == pytest.approx(
            np.column_stack([line.points[:, 0] * 1e3, np.rad2deg(line.points[:, 1])]), abs=1e-3
        )


def test_without_masses_nothing_is_said_of_loads(on_page, session):
    job = session.state.job
    session.change(replace(session.state, job=replace(job, robot=replace(job.robot, dynamics=None))))

    async def nothing(component, do):
        pass

    reported = on_page(nothing)
    assert reported.last("show_motion")["lost"] is None
    assert reported.last("show_map")["loads"] == []


def test_the_thrust_is_part_of_the_map(on_page, session):
    async def exchange(component, do):
        await asyncio.sleep(0.01)
        session.change(replace(session.state, job=replace(session.state.job, settings=Settings(thrust=100.0))))

    reported = on_page(exchange)
    assert {each["legs"] for each in reported.last("show_map")["loads"]} == {("plunge",), ("retract",)}


def test_a_drag_draws_neither_the_field_nor_the_branches(on_page):
    async def exchange(component, do):
        await asyncio.sleep(0)
        component.reported.clear()
        do("grab")
        for seq in range(1, 6):
            do("drag", points=points((14.16, -seq, -14.0)), seq=seq, ms=10.0)
        await asyncio.sleep(view.SOONEST + 0.2)
        assert {name for name, *_ in component.reported} == {"show_motion"}
        assert len(component.reported) == 5  # its own change of the state is not answered once more

    on_page(exchange)


def test_a_slow_page_is_passed_on_to_when_the_pointer_rests(on_page, session):
    changes = []
    session.watch(lambda before, after: changes.append(after))

    async def exchange(component, do):
        do("grab")
        for seq in range(1, 7):  # until the page is known to be slow
            do("drag", points=points((14.16, -seq / 10, -14.0)), seq=seq, ms=200.0)
        await asyncio.sleep(0.1)
        changes.clear()
        for seq in range(7, 40):  # longer than the pointer would have to rest
            do("drag", points=points((14.16, -seq / 10, -14.0)), seq=seq, ms=20.0)
            await asyncio.sleep(0.01)
            assert component.last("show_motion")["seq"] == seq
        assert changes == []
        await asyncio.sleep(0.6)
        (change,) = changes
        assert psi_of(change)[1] == pytest.approx(-3.9)

    on_page(exchange)


def test_escape_restores_what_was_before_the_drag(on_page, session):
    by_hand = Steered(Profile.straight(0.05, 0.1, 0.2, 0.3), 4)

    async def exchange(component, do):
        do("grab")
        do("drag", points=points((1, 2, 3)), seq=1, ms=10.0)
        do("restore")
        assert session.state.steered is None
        assert np.array(component.last("show_motion")["points"])[:, 1] == pytest.approx([20.6, 1.12, -25.37])
        await asyncio.sleep(view.SOONEST + 0.2)
        assert session.state.steered is None  # nothing is passed on later
        session.change(steered(session.state, by_hand))
        do("grab")
        do("drag", points=points((1, 2, 3)), seq=2, ms=10.0)
        await asyncio.sleep(view.SOONEST + 0.2)
        assert session.state.steered is not by_hand
        do("restore")
        assert session.state.steered is by_hand

    on_page(exchange)


def test_a_drag_is_one_step_and_one_that_is_escaped_is_none(on_page, session):
    async def exchange(component, do):
        do("grab")
        for seq in (1, 2):
            do("drag", points=points((1, seq, 3)), seq=seq, ms=10.0)
            await asyncio.sleep(view.SOONEST + 0.1)
        do("drop", points=points((1, 2.5, 3)))
        do("grab")
        do("drag", points=points((9, 9, 9)), seq=3, ms=10.0)
        await asyncio.sleep(view.SOONEST + 0.1)
        do("restore")
        assert psi_of(session.state) == pytest.approx([1, 2.5, 3])
        session.undo()
        assert not session.can_undo
        shown = component.last("show_motion")
        assert (shown["edited"], shown["reversals"]) == (False, 0)
        session.redo()
        assert np.array(component.last("show_motion")["points"])[:, 1] == pytest.approx([1, 2.5, 3])

    on_page(exchange)


def test_back_to_the_plan(on_page, session):
    async def exchange(component, do):
        do("grab")
        do("drop", points=points((1, 2, 3)))
        assert component.last("show_motion")["edited"]
        do("let_go")
        assert session.state.steered is None
        shown = component.last("show_motion")
        assert (shown["reversals"], shown["edited"]) == (0, False)

    on_page(exchange)


def test_a_branch_is_chosen_for_map_and_motion_but_all_for_the_map_alone(on_page, session):
    async def exchange(component, do):
        do("choose", branch="0")
        assert session.state.steered.branch == 0
        assert (session.state.steered.profile.psi == PLANNED.psi).all()
        shown = component.last("show_motion")
        assert not shown["runs"]
        assert "A4" in shown["why"]
        assert shown["faults"][0]["kind"] == "limit"
        await asyncio.sleep(0.01)
        assert component.last("show_map")["branch"] == 0
        do("choose", branch="all")
        await asyncio.sleep(0.01)
        assert component.last("show_map")["branch"] is None
        assert session.state.steered.branch == 0
        do("let_go")
        await asyncio.sleep(0.01)
        assert component.last("show_map")["branch"] == POSITIONS[0].branch

    on_page(exchange)


def test_points_of_any_number_but_no_nonsense(on_page, session):
    async def exchange(component, do):
        do("grab")
        do("drop", points=points((20, 10, 1, -10, -25), (50, 20, 0, 30, 50)))
        assert psi_of(session.state) == pytest.approx([20, 10, 1, -10, -25])
        kept = session.state.steered
        for nonsense in (
            points((20, 10), (50, 0)),
            points((20, 10, 1), (50, 60, 50)),
            points((20, float("nan"), 1)),
            [[0, "x", 50], [1, 2, 0], [2, 3, 50]],
            [[0, 1]],
            [],
            "points",
            None,
        ):
            do("drag", points=nonsense, seq=9, ms=1.0)
            do("drop", points=nonsense)
        assert session.state.steered is kept
        do("choose", branch="9")
        do("choose", branch="; drop")
        assert session.state.steered is kept

    on_page(exchange)


def test_a_hole_without_a_plan_shows_all_branches_and_says_so(on_page, session):
    async def exchange(component, do):
        session.change(selected(session.state, POSITIONS[1].hole.id))
        shown = component.last("show_motion")
        assert shown["points"] == []
        assert shown["why"] == "this hole is not planned yet"
        assert shown["fit"]
        await asyncio.sleep(0.01)
        assert component.last("show_map")["branch"] is None
        do("drag", points=points((1, 2, 3)), seq=1, ms=1.0)
        assert session.state.steered is None

    on_page(exchange)


def test_an_answer_takes_the_place_of_what_was_edited(on_page, session):
    async def exchange(component, do):
        do("grab")
        do("drag", points=points((1, 2, 3)), seq=1, ms=1.0)
        session.change(answered(session.state, replace(session.state.answer)))
        await asyncio.sleep(view.SOONEST + 0.2)
        assert session.state.steered is None
        assert component.last("show_motion")["reversals"] == 0

    on_page(exchange)


def test_who_steps_through_the_holes_waits_for_the_last_map_alone(on_page, session, monkeypatch):
    """A map that is not wanted any more when its turn comes is not drawn."""
    asked, holes = [], [hole.id for hole in session.state.job.holes]

    async def exchange(component, do):
        gate = asyncio.Event()

        async def slowly(call):
            asked.append(call.args[0].hole.id)
            await gate.wait()
            return call()

        monkeypatch.setattr(view, "aside", slowly)
        for hole in (*holes[1:], holes[0], holes[1]):
            session.change(selected(session.state, hole))
            await asyncio.sleep(0)
        gate.set()

    on_page(exchange)
    assert asked == [holes[1], holes[1]]
