"""What a page of the app shows, as one small immutable value; every change makes another one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING

from zerorev.errors import InputError
from zerorev.maps.replan import job_of
from zerorev.model.finding import Finding
from zerorev.model.hole import Hole
from zerorev.model.job import Job, Settings
from zerorev.model.plan import HolePlan, Plan, Strokes, Transition, named_holes
from zerorev.model.profile import Profile
from zerorev.planning.job import unanswered
from zerorev.planning.likely_mistakes import likely_mistakes
from zerorev.web.real_arm import RealArm

if TYPE_CHECKING:
    from zerorev.report.scene.map_slice import MapSlice
    from zerorev.report.scene.urdf_meshes import Mesh

__all__ = [
    "Moves",
    "Progress",
    "State",
    "Steered",
    "answered",
    "opened_job",
    "opened_map",
    "opened_plan",
    "plan_of",
    "selected",
    "shown",
    "steered",
    "with_cell",
    "with_hole",
    "with_holes",
    "with_settings",
    "without_hole",
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
    """

    job: Job | None = None
    answers: Mapping[str, HolePlan] = field(default_factory=lambda: NONE)
    selected: str | None = None
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
    """A job of which nothing is planned yet, its first hole selected."""
    return State(job, selected=job.holes[0].id, caution=_caution(job))


def _caution(job: Job) -> str | None:
    """What is probably wrong with a job, and what was left out of its files, one per line; None where nothing is."""
    return "\n".join((*(finding.message for finding in likely_mistakes(job)), *job.notes)) or None


def opened_plan(plan: Plan) -> State:
    """A plan with its answers, its first hole selected."""
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
    return state if hole == state.selected else replace(state, selected=hole, steered=None)


def steered(state: State, motion: Steered | None) -> State:
    """The selected hole's motion is edited, or the edited one is let go."""
    return replace(state, steered=motion)


def shown(state: State) -> Steered | None:
    """The motion that the page shows of the selected hole: the edited one, or as planned."""
    if state.steered is not None:
        return state.steered
    motion = state.answer.motion if state.answer else None
    return None if motion is None else Steered(motion.profile, motion.branch)


def answered(state: State, *answers: HolePlan, strokes: Strokes = "asked") -> State:
    """Holes have been answered; an edited motion of them is let go.

    Answers of another kind of strokes are dropped; where the deepest strokes were asked for, the holes become as deep.
    Answers of holes that are gone, or have changed since, are not taken.
    """
    if state.job is None:
        return state
    asked = {hole.id: hole for hole in state.job.holes}
    fresh = {
        each.hole.id: each for each in answers if each.hole.id in asked and _same(each, asked[each.hole.id], strokes)
    }
    kept = state.answers if strokes == state.strokes else NONE
    job = state.job
    if strokes == "deepest" and fresh:
        deep = {key: each.hole for key, each in fresh.items() if each.hole.profile is None}  # not those kept by hand
        job = replace(job, holes=tuple(deep.get(hole.id, hole) for hole in job.holes))
    edited = None if state.selected in fresh else state.steered
    return replace(state, job=job, answers=MappingProxyType({**kept, **fresh}), strokes=strokes, steered=edited)


def with_hole(state: State, hole: Hole, instead_of: str | None = None) -> State:
    """A hole is added, or takes the place of one, whose answer goes with it; it is selected.

    Raises:
        InputError: nothing is opened yet, or another hole has this id.
    """
    if state.job is None:
        raise InputError("nothing is opened", where="hole", accepted="a job, opened before")
    old = state.job.holes
    holes = (*old, hole) if instead_of is None else tuple(hole if each.id == instead_of else each for each in old)
    answers = {key: value for key, value in state.answers.items() if key not in (instead_of, hole.id)}
    return replace(
        state, job=replace(state.job, holes=holes), answers=MappingProxyType(answers), selected=hole.id, steered=None
    )


def with_cell(state: State, cell: int) -> State:
    """The hole of a cell of the map is added to the job, or is there already; it is selected.

    Args:
        state: with a map.
        cell: its number in the slice that is shown.

    Raises:
        InputError: no such cell, or one that cannot be drilled, and why.
    """
    if state.cells is None or state.job is None:
        raise InputError("no map is shown", where="cell", accepted="a cell of a map")
    hole = state.cells.hole(cell, state.job.holes[0].depth if state.hole is None else state.hole.depth)
    there = next((each for each in state.job.holes if each.id == hole.id), None)
    if there is not None and there.depth == hole.depth:
        return selected(state, hole.id)
    return with_hole(state, hole, None if there is None else hole.id)


def with_holes(state: State, holes: Sequence[Hole]) -> State:
    """Holes are added, as out of a table; the first of them is selected.

    Raises:
        InputError: nothing is opened yet, no hole is given, or two holes have the same id.
    """
    if state.job is None or not holes:
        raise InputError("there is nothing to add", where="holes", accepted="one hole or more, to a job opened before")
    job = replace(state.job, holes=(*state.job.holes, *holes))
    return replace(state, job=job, selected=holes[0].id, steered=None, caution=_caution(job))


def without_hole(state: State, hole: str) -> State:
    """A hole is taken out, its neighbour selected.

    Raises:
        InputError: it is the last one.
    """
    if state.job is None:
        return state
    at = next((n for n, each in enumerate(state.job.holes) if each.id == hole), None)
    if at is None:
        return state
    holes = state.job.holes[:at] + state.job.holes[at + 1 :]
    if not holes:
        raise InputError("the last hole cannot be taken out", where="hole", accepted="a job of one hole or more")
    answers = {key: value for key, value in state.answers.items() if key != hole}
    beside = holes[min(at, len(holes) - 1)].id if state.selected == hole else state.selected
    return replace(
        state, job=replace(state.job, holes=holes), answers=MappingProxyType(answers), selected=beside, steered=None
    )


def with_settings(state: State, settings: Settings) -> State:
    """The job is planned by other settings, so that no answer holds any more."""
    if state.job is None or settings == state.job.settings:
        return state
    return replace(state, job=replace(state.job, settings=settings), answers=NONE, steered=None)


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


def _same(answer: HolePlan, asked: Hole, strokes: Strokes) -> bool:
    """Whether an answer is of this very hole, but for the depth where the deepest was asked for."""
    hole = answer.hole
    by_hand = hole.profile is not None and asked.profile is None
    return (
        bool((hole.target == asked.target).all())
        and bool((hole.direction == asked.direction).all())
        and bool((hole.psi_zero == asked.psi_zero).all())
        and (strokes == "deepest" or hole.depth == asked.depth)
        and (by_hand or hole.branch == asked.branch)
    )
