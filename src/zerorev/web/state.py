"""What a page of the app shows, as one small immutable value; every change makes another one (`web.job_edits`)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING

from zerorev.errors import InputError
from zerorev.maps.replan import job_of
from zerorev.model.finding import Finding
from zerorev.model.hole import Hole
from zerorev.model.job import Job
from zerorev.model.plan import HolePlan, Plan, Strokes, Transition, named_holes
from zerorev.model.profile import Profile
from zerorev.model.strokes import each_stroke, shifted
from zerorev.planning.job import unanswered
from zerorev.planning.likely_mistakes import likely_mistakes
from zerorev.web.real_arm import RealArm

if TYPE_CHECKING:
    from zerorev.report.scene.map_slice import MapSlice
    from zerorev.report.scene.urdf_meshes import Mesh

__all__ = [
    "NONE",
    "Moves",
    "Progress",
    "State",
    "Steered",
    "caution_of",
    "opened_job",
    "opened_map",
    "opened_plan",
    "plan_of",
    "selected",
    "shown",
    "shown_stroke",
    "steered",
    "with_stroke",
]

NONE: Mapping[str, HolePlan] = MappingProxyType({})


@dataclass(frozen=True)
class Steered:
    """A motion made by hand: its profile, the spin along the path, and its branch 0..7."""

    profile: Profile
    branch: int


@dataclass(frozen=True)
class Progress:
    """Long work under way: what the page calls it, how many things of how many are finished, in how long [s].

    Work that gives way is stopped where another hole is selected that has to be planned.
    """

    title: str
    done: int
    total: int
    each: str = "hole"
    seconds: float = 0.0
    gives_way: bool = False

    @property
    def rate(self) -> float | None:
        """Things finished a second, or None before the first."""
        return self.done / self.seconds if self.done and self.seconds else None

    @property
    def seconds_left(self) -> float | None:
        """How long the rest takes at this rate [s], or None while nobody knows."""
        return None if self.rate is None else (self.total - self.done) / self.rate


@dataclass(frozen=True)
class Moves:
    """The moves between the holes, and the answers that they lead to and from: of others they say nothing."""

    transitions: tuple[Transition, ...] = ()
    answers: Mapping[str, HolePlan] = field(default_factory=lambda: NONE)


@dataclass(frozen=True)
class State:
    """What a page shows.

    Attributes:
        job: robot, tool, holes and settings, or None before anything is opened.
        answers: of the holes that have one, by their id; each is of the hole as it is in the job.
        selected: id of the selected hole, or None.
        stroke: which of its strokes is shown where it is drilled in several, from 0.
        steered: the motion of the selected hole as the user edits it, or None: the planned one.
        strokes: whether the answers are of the strokes `asked` for or of each hole's `deepest`.
        progress: of the long work under way, or None.
        trouble: why the last work came to nothing, in one sentence, or None.
        outcome: what the last work on many holes came to, in one sentence, or None.
        caution: what is probably wrong with the job, and what was left out where it was read, one per line, or None.
        order: ids of the holes as they are drilled, as far as that was planned; those behind follow as listed.
        moves: between the holes, as they were last computed.
        lacking: what the plan that was opened says of holes that it does not have, or None.
        cells: a slice of a workspace map of the same robot and tool, or None.
        meshes: of the links of the robot (`report.urdf_meshes`), or None: shapes made from its geometry.
        arm: what is known of the real arm, and was simulated with it.
        tools: of a job of several tools what the page shows of each, that of the tool that is shown as it was when it
            was last left (`web.of_tools`); else empty.
        tool: which of them is shown, from 0.
    """

    job: Job | None = None
    answers: Mapping[str, HolePlan] = field(default_factory=lambda: NONE)
    selected: str | None = None
    stroke: int = 0
    steered: Steered | None = None
    strokes: Strokes = "asked"
    progress: Progress | None = None
    trouble: str | None = None
    outcome: str | None = None
    caution: str | None = None
    order: tuple[str, ...] = ()
    moves: Moves = field(default_factory=Moves)
    lacking: Finding | None = None
    cells: MapSlice | None = None
    meshes: tuple[tuple[Mesh, ...], ...] | None = None
    arm: RealArm = field(default_factory=RealArm)
    tools: tuple[State, ...] = ()
    tool: int = 0

    @cached_property
    def hole(self) -> Hole | None:
        """The selected hole."""
        if self.job is None:
            return None
        return next((hole for hole in self.job.holes if hole.id == self.selected), None)

    @property
    def unplanned(self) -> tuple[str, ...]:
        """Ids of the holes that have no answer yet."""
        return () if self.job is None else tuple(hole.id for hole in self.job.holes if hole.id not in self.answers)

    @property
    def transitions(self) -> tuple[Transition, ...]:
        """The moves between the holes, as long as no answer has changed since they were computed."""
        return self.moves.transitions if self.moves.answers is self.answers else ()

    @property
    def answer(self) -> HolePlan | None:
        """The selected hole's answer."""
        return None if self.selected is None else self.answers.get(self.selected)


def opened_job(job: Job) -> State:
    """A job of which nothing is planned yet, its first hole selected, and of several tools the first shown."""
    return _of_all_tools(
        State(replace(each, further=()) if each.further else each, selected=each.holes[0].id, caution=caution_of(each))
        for each in job.of_all_tools
    )


def _of_all_tools(states: Iterable[State]) -> State:
    tools = tuple(states)
    return replace(tools[0], tools=tools) if len(tools) > 1 else tools[0]


def caution_of(job: Job) -> str | None:
    """What is probably wrong with a job, and what was left out of its files, one per line; None where nothing is."""
    return "\n".join((*(finding.message for finding in (*likely_mistakes(job), *job.said)), *job.notes)) or None


def opened_plan(plan: Plan) -> State:
    """A plan with its answers, its first hole selected, and of several tools the first shown."""
    return _of_all_tools(_opened_plan(each) for each in plan.of_all_tools)


def _opened_plan(plan: Plan) -> State:
    holes = tuple(answer.hole for answer in plan.holes)
    job = Job(plan.robot, plan.tool, holes, plan.settings, plan.T_base_part, plan.name)
    answers = MappingProxyType({answer.hole.id: answer for answer in plan.holes})
    said = [replace(each, message=f"{each.message} (of the plan that was opened)") for each in plan.findings]
    lacking = next((each for each in said if each.kind == "unfinished"), None)
    moves = Moves(plan.transitions, answers)
    return State(job, answers, holes[0].id, strokes=plan.strokes, order=plan.order, moves=moves, lacking=lacking)


def opened_map(cells: MapSlice) -> State:
    """A slice of a workspace map, and a job of its best cell alone; or of a cell in its middle, where none is best."""
    job = job_of(cells.found, [cells.index(len(cells.row) // 2)])
    with suppress(InputError):  # the cell in the middle is not reached, so it is shown as it is
        hole = cells.hole(len(cells.row) // 2 if cells.best is None else cells.best, job.holes[0].depth)
        job = replace(job, holes=(hole,))
    return replace(opened_job(job), cells=cells)


def selected(state: State, hole: str) -> State:
    """Another hole is selected; the edited motion is let go.

    Raises:
        InputError: no such hole.
    """
    if state.job is None or all(each.id != hole for each in state.job.holes):
        raise InputError(f"no hole '{hole}'", where="hole", accepted="the id of one of the job's holes")
    return state if hole == state.selected else replace(state, selected=hole, stroke=0, steered=None)


def with_stroke(state: State, number: int) -> State:
    """Another stroke of the selected hole is shown, from 0; the edited motion is let go."""
    return state if number == state.stroke else replace(state, stroke=number, steered=None)


def steered(state: State, motion: Steered | None) -> State:
    """The selected hole's motion is edited, or the edited one is let go."""
    return replace(state, steered=motion)


def shown(state: State) -> Steered | None:
    """The motion that the page shows of the selected hole: the edited one, or as planned, of the chosen stroke.

    Its stand-offs are counted from the target of the hole.
    """
    if state.steered is not None:
        return state.steered
    answer = shown_stroke(state)
    if answer is None or answer.motion is None or state.answer is None:
        return None
    motion = shifted(answer.motion, state.answer.hole.depth - answer.hole.depth)
    return Steered(motion.profile, motion.branch)


def shown_stroke(state: State) -> HolePlan | None:
    """The answer of the stroke that is shown of the selected hole; of a hole with no others that of the hole."""
    if state.answer is None:
        return None
    strokes = each_stroke(state.answer)
    return strokes[min(state.stroke, len(strokes) - 1)]


def plan_of(state: State) -> Plan:
    """The plan of all holes that have an answer, in their order; a finding says which have none.

    The moves between the holes take a while, and are left to who writes the plan (`planning.sequence.with_moves`).

    Raises:
        InputError: none has an answer.
    """
    if state.job is None or not state.answers:
        raise InputError("nothing is planned yet", where="plan", accepted="a planned hole or more")
    job = state.job
    holes = tuple(state.answers[hole.id] for hole in job.holes if hole.id in state.answers)
    plan = unanswered(job, state.strokes, holes)
    findings = plan.findings if state.lacking is None else (*plan.findings, state.lacking)
    if missing := state.unplanned:
        message = f"only {len(holes):,} of {len(job.holes):,} holes planned; missing: {named_holes(missing)}"
        findings = (*findings, Finding("warning", "unfinished", message))
    return replace(plan, findings=findings, order=state.order)
