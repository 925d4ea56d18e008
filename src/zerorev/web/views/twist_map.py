"""The twist map in the page: zones of the twist plane, and the legs over them that the user steers by hand."""

from __future__ import annotations

import asyncio
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from nicegui import background_tasks, ui
from nicegui.element import Element
from nicegui.events import GenericEventArguments

from zerorev.errors import InputError
from zerorev.files.units import m, rad
from zerorev.model._arrays import finite
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.report.scene import motion_look
from zerorev.report.scene import twist_map as maps
from zerorev.report.scene.clearance_data import least_data
from zerorev.report.scene.twist_map_data import loads_data, map_data, motion_data, zone_data
from zerorev.report.words.lost_motion import lost_motion_words
from zerorev.web.aside import aside
from zerorev.web.session import Session
from zerorev.web.state import State, Steered, shown, steered
from zerorev.web.wanted_map import WantedMap

__all__ = ["twist_map"]

STATIC = Path(__file__).parents[1] / "static"
SOONEST, LATEST = 0.4, 1.6  # [s] how often the other views follow a drag
TOO_LATE, REST = 0.8, 0.25  # [s] if less often than that, they follow when the pointer has rested for so long instead
OWN = -1  # branch: that of the motion
NOTHING = object()
CHOICES = {"all": None, **{str(branch): branch for branch in range(8)}}
MOST_POINTS = 200
FORGET = 0.997  # how fast a slow update is forgotten: in some seconds
SLOW = 45.0  # [ms] from pointer to count, from which on they follow less often


class _Element(Element, component=STATIC / "twist_map.js", esm={"zerorev-twist-map": str(STATIC / "twist_map")}):
    """The map's component in the browser."""


def twist_map(session: Session) -> None:
    """Draw the twist map of the selected hole, and keep it up to date.

    Args:
        session: whose selected hole is shown, and whose motion is steered.
    """
    ui.add_css(STATIC / "twist_map.css")
    _TwistMap(session)


class _TwistMap:
    """What one map on one page has to remember.

    Attributes:
        choice: the branch that the user wants to see the map of; None: all of them; `OWN`: the motion's own.
    """

    def __init__(self, session: Session) -> None:
        self.session = session
        self.choice: int | None = OWN
        self.drawn: WantedMap | None = None  # what the map was drawn of
        self.drag: object = None  # stands for the drag under way: all that it changes is one step for `Session.undo`
        self.pending: Steered | None = None  # the edited motion, which the other views may not know yet
        self.passed: object = NOTHING  # what this map passed to them last
        self.timer: asyncio.TimerHandle | None = None
        self.interval = SOONEST
        self.drawing = asyncio.Lock()  # one map at a time: who steps through the holes waits for the last one alone
        self.element = _Element().classes("w-full h-full")
        self.prepared: object = None  # the robot of whose bodies distances are computed at once
        for name in ("ready", "grab", "drag", "drop", "restore", "let_go", "choose", "seek"):
            self.element.on(name, getattr(self, f"on_{name}"))
        session.watch(self.changed)
        session.hear("seek", self.show_cursor)

    # ---- from the session

    def changed(self, before: State, after: State) -> None:
        """The state is another: show what of it is."""
        other_hole, other_answer = before.hole is not after.hole, before.answer is not after.answer
        steered_elsewhere = before.steered is not after.steered and after.steered is not self.passed
        other_answer |= before.stroke != after.stroke
        if not (other_hole or other_answer or steered_elsewhere or before.job is not after.job):
            return
        self.let_pending_go()
        if other_hole:
            self.choice = OWN
        self.show_all(fit=other_hole or other_answer)

    def show_all(self, *, fit: bool) -> None:
        """Show motion, map and branches."""
        self.show_motion(None, fit=fit)
        self.show_map()
        self.show_branches()

    @property
    def motion(self) -> Steered | None:
        """What is on the map: the edited motion, or the planned one."""
        return self.pending or shown(self.session.state)

    @property
    def branch(self) -> int | None:
        """Of the map; None: the envelope of all."""
        if self.choice != OWN:
            return self.choice
        return self.motion.branch if self.motion else None

    # ---- from the page

    def on_ready(self) -> None:
        """The component is there, for the first time or again."""
        self.drawn = None
        self.show_all(fit=True)

    def on_grab(self) -> None:
        """A drag begins."""
        self.drag = object()

    def on_drag(self, event: GenericEventArguments) -> None:
        """A point was moved: the count first, the other views when there is time."""
        if not self.take(event.args["points"]):
            return
        self.show_motion(int(event.args["seq"]))
        slow = float(event.args.get("ms", 0.0)) > SLOW
        self.interval = min(2 * self.interval, LATEST) if slow else max(FORGET * self.interval, SOONEST)
        rests = self.interval > TOO_LATE
        if rests:
            self.stop_timer()
        if self.timer is None:
            wait = REST if rests else self.interval
            self.timer = asyncio.get_running_loop().call_later(wait, self.pass_on)

    def on_drop(self, event: GenericEventArguments) -> None:
        """The point is let go."""
        if self.take(event.args["points"]):
            self.pass_on()
            self.show_motion(None)
            self.show_branches()

    def on_restore(self) -> None:
        """The drag is taken back."""
        self.let_pending_go()
        self.session.drop(self.drag)
        self.show_all(fit=False)  # also where the other views do not know of the drag

    def on_let_go(self) -> None:
        """Back to the plan."""
        self.let_pending_go()
        self.choice = OWN
        self.session.change(steered(self.session.state, None))

    def on_choose(self, event: GenericEventArguments) -> None:
        """Another branch, for the map and the edited motion; or all of them, for the map alone."""
        chosen = event.args["branch"]
        if chosen not in CHOICES:
            return
        self.choice = CHOICES[chosen]
        motion = self.motion
        if self.choice is not None and motion is not None and motion.branch != self.choice:
            self.pending, self.drag = Steered(motion.profile, self.choice), object()
            self.pass_on()
            self.show_motion(None)
        self.show_map()

    def on_seek(self, event: GenericEventArguments) -> None:
        """The user wants to see the arm at a place of the motion."""
        self.session.tell("seek", float(event.args["x"]))

    def take(self, points: Any) -> bool:
        """Take the points of a drag as the edited motion; points that form no motion of this hole change nothing."""
        motion, hole = self.motion, self.session.state.hole
        if motion is None or hole is None:
            return False
        try:
            psi, standoff = finite(points, (min(len(points), MOST_POINTS), 3), "points").T[1:]
            profile = Profile(m(standoff), rad(psi))
        except (InputError, TypeError):
            return False
        if not np.allclose(profile.standoff[[0, -1]], hole.depth, rtol=0, atol=1e-9):
            return False
        self.pending = Steered(profile, motion.branch)
        return True

    def pass_on(self) -> None:
        """Pass the edited motion to the other views."""
        self.stop_timer()
        if self.pending is not None:
            self.passed = self.pending
            self.session.change(steered(self.session.state, self.pending), of=self.drag)

    def let_pending_go(self) -> None:
        """The edited motion was given up, or another has taken its place."""
        self.stop_timer()
        self.pending, self.passed = None, NOTHING

    def stop_timer(self) -> None:
        """The other views need no later call."""
        if self.timer is not None:
            self.timer.cancel()
            self.timer = None

    # ---- to the page

    def show_motion(self, seq: int | None, *, fit: bool = False) -> None:
        state, motion = self.session.state, self.motion
        self.session.tell("steer", motion)
        if state.job is None or state.hole is None or motion is None:
            self.element.run_method("show_motion", {**_empty(state), "seq": seq, "fit": fit})
            return
        job, hole = state.job, state.hole
        drilling = Drilling.of(job, hole)
        seen = motion_look.look(drilling, motion.profile, motion.branch, job.settings)
        data = motion_data(job.robot, motion.profile, seen)
        data |= loads_data(drilling, motion.profile, motion.branch, job.settings.thrust)
        data |= self.near(drilling, seen, fast=seq is not None)
        data |= {"seq": seq, "fit": fit, "edited": self.pending is not None or state.steered is not None}
        if seq is None:
            held = motion_look.held(motion.profile)
            data["baseline"] = motion_look.look(drilling, held, motion.branch, job.settings).reversals
        self.element.run_method("show_motion", data)

    def near(self, drilling: Drilling, seen: motion_look.Look, *, fast: bool) -> dict[str, Any]:
        """How near a motion comes to what stands around, as soon as that can be said at once."""
        job = self.session.state.job
        if job is None or self.prepared is not job.robot:
            return {"around": self.around, "nearest": None}
        found = least_data(drilling, job.settings, seen.motion, fast=fast)
        return {"around": self.around, "nearest": found}

    @property
    def around(self) -> bool:
        """Whether there is something that the arm is held apart from."""
        job = self.session.state.job
        return job is not None and bool(job.settings.surroundings.obstacles)

    def show_map(self) -> None:
        state = self.session.state
        if state.job is None or state.hole is None:
            self.drawn = None
            self.element.run_method("show_map", None)
            return
        corner = float(self.motion.profile.standoff.min()) if self.motion else state.job.settings.corner_standoff
        job = state.job
        thrust, margin = job.settings.thrust, job.settings.limit_margin
        wanted = WantedMap(
            job.robot, job.tool, state.hole, self.branch, corner, thrust, margin,
            job.settings.clearance, job.settings.surroundings,
        )  # fmt: skip
        if self.drawn is not None and wanted.same(self.drawn):
            return
        self.drawn = wanted
        self.element.run_method("show_loading")
        background_tasks.create(self.draw_map(wanted))

    async def draw_map(self, wanted: WantedMap) -> None:
        """Draw a map in a thread, and show it if it is still the one that is wanted."""
        async with self.drawing:
            if wanted is not self.drawn:
                return
            found = await aside(
                partial(maps.twist_map, wanted.drilling, wanted.branch, wanted.corner, thrust=wanted.thrust)
            )
            if wanted is not self.drawn:
                return
            self.element.run_method("show_map", map_data(wanted.robot, found))
            if not wanted.surroundings.obstacles:
                return
            zone = await aside(wanted.zone)
        if wanted is self.drawn:
            self.element.run_method("show_zone", None if zone is None else zone_data(zone))
            if self.prepared is not wanted.robot:
                self.prepared = wanted.robot
                self.show_motion(None)

    def show_cursor(self, distance_mm: float | None) -> None:
        """Where the motion is played."""
        self.element.run_method("show_cursor", distance_mm)

    def show_branches(self) -> None:
        state, motion = self.session.state, self.motion
        if state.job is None or state.hole is None:
            return
        job = state.job
        options = []
        for branch in range(8):
            label = f"{branch}"
            if motion is not None:
                found = motion_look.look(Drilling.of(job, state.hole), motion.profile, branch, job.settings)
                count = "cannot be run" if found.reversals is None else f"{found.reversals} reversals"
                label += f" · {count}" if found.reversals != 1 else " · 1 reversal"
            options.append({"value": str(branch), "label": label})
        self.element.run_method("show_branches", [*options, {"value": "all", "label": "all branches"}])


def _empty(state: State) -> dict[str, Any]:
    answer = state.answer
    if answer is not None and answer.status == "infeasible":
        why = "; ".join(finding.message for finding in answer.findings if finding.level == "error")
        why = why or "no motion drills this hole"
    else:
        why = "this hole is not planned yet" if state.hole else ""
    weighed = state.job is not None and state.job.robot.dynamics is not None
    return {
        "points": [], "runs": answer is None, "why": why, "faults": [], "marks": [], "reversals": None, "joints": [],
        "travel": "", "margin": "", "limit": "", "edited": False, "lost": lost_motion_words(None) if weighed else None,
        "senses": None, "nearest": None,
        "around": state.job is not None and bool(state.job.settings.surroundings.obstacles),
    }  # fmt: skip
