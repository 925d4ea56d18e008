"""check_plan(plan): is everything that a plan file states of its holes what comes out when it is computed again?

The motion is followed by `verify.check`, its figures are computed by `verify.figures`; neither shares code with the
search. What only a search can find, the deepest stroke and whether there is a better motion, is searched for once more.
Which field is treated how, and how exactly it has to agree, is said in `model.plan_fields`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import Literal, NamedTuple

import numpy as np

from zerorev.files.plan_data import answer_data, sequence_data
from zerorev.files.plan_differences import differ, fields_differ, findings_differ, leaves
from zerorev.files.plan_fields import HEAD_FIELDS
from zerorev.files.units import deg_per_mm, mm
from zerorev.model.finding import Finding, FindingKind
from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.plan import Clearance, HolePlan, Motion, Optimality, Plan, Score, Stroke, Strokes, Verification
from zerorev.model.robot import Robot
from zerorev.model.strokes import stroke_by_stroke
from zerorev.model.tool import Tool
from zerorev.motion.criteria import thesis_objective
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import Evaluation
from zerorev.planning.answered import cycle_time, motion_findings
from zerorev.planning.clearance import clearance_of
from zerorev.planning.corner import corner_of
from zerorev.planning.hole import evaluated_stroke, lever_findings, plan, plan_deepest
from zerorev.planning.likely_mistakes import GUESSES
from zerorev.planning.sequence import moves_of, time_of
from zerorev.planning.strokes_again import strokes_again, strokes_differ, with_checks, with_findings_of
from zerorev.planning.tool_turn import with_tool_turn
from zerorev.search.rank import Candidate, Order
from zerorev.verify.between import moves_claimed
from zerorev.verify.check import subject, verify_hole
from zerorev.verify.digits import moved_figures
from zerorev.verify.figures import Figures, figures, nearer_turn
from zerorev.workers import Machines, Workers

__all__ = ["Checked", "check_hole", "check_plan"]

BETTER = 1e-5  # relative: by so much a motion that is found again has to be better than the stated one
OF_A_PROOF = "tolerance"  # one that a certificate adds
LATER: tuple[FindingKind, ...] = (
    "near_limit",
    "tool_turn",
    "joint_speed",
    "turn_speed",
    "corner",
)  # which files of an older version do not have


@dataclass(frozen=True)
class Checked:
    """A plan that was checked.

    Attributes:
        plan: with `verified` filled in for each hole that has a motion; certificates are not proven again here, and
            are as they were.
        wrong: what the file states otherwise than it is found, one error each.
        further: the same of the further tools.
    """

    plan: Plan
    wrong: tuple[Finding, ...]
    further: tuple[Checked, ...] = ()

    @property
    def as_stated(self) -> bool:
        """Whether nothing is stated otherwise than it is found, of any tool."""
        return not self.wrong and all(each.as_stated for each in self.further)

    def marked(self, *, rewritten: bool = False) -> Plan:
        """The plan with what is wrong among the failures of each hole's check, or among the findings without one.

        Args:
            rewritten: for a file that the plan replaces: what the old one states of its check is not a fault of it.
        """
        wrong = [each for each in self.wrong if not (rewritten and each.message.startswith("verified."))]
        holes = []
        for hole in self.plan.holes:
            found = tuple(finding for finding in wrong if finding.hole == hole.hole.id)
            if found and hole.verified is not None:
                failures = hole.verified.failures + tuple(finding.message for finding in found)
                hole = replace(hole, verified=replace(hole.verified, passed=False, failures=failures))
            elif found:
                hole = replace(hole, findings=hole.findings + found)
            holes.append(hole)
        of_all = tuple(finding for finding in wrong if finding.hole is None)
        further = tuple(
            replace(each, plan=plan).marked(rewritten=rewritten)
            for each, plan in zip(self.further, self.plan.further, strict=True)
        )
        return replace(self.plan, holes=tuple(holes), findings=self.plan.findings + of_all, further=further)


def check_plan(stated: Plan, *, workers: int | None = 1, progress: Callable[[int, int], None] | None = None) -> Checked:
    """Check the motion of every hole, and compute again what the file states of it.

    Args:
        stated: any plan, also a wrong one.
        workers: processes to run it on; None: one per core where it is worth it. The outcome is the same.
        progress: called with (holes checked, holes in all) before the first and after each.
    """
    wrong: list[Finding] = []
    holes: list[HolePlan] = []
    if progress:
        progress(0, len(stated.holes))
    chosen = stated.strokes == "asked" and len(stated.holes) > 1 and stated.settings.posture_freedom > 0
    least = 0.0
    with Workers(
        partial(check_hole, stated.robot, stated.tool, stated.settings, stated.strokes, chosen=chosen),
        Machines(workers),
    ) as checkers:
        for hole, checked in zip(stated.holes, checkers.map(stated.holes, len(stated.holes)), strict=True):
            holes.append(replace(hole, verified=checked.verified, strokes=checked.strokes))
            wrong += [_error(message, hole.hole.id) for message in checked.wrong]
            least += checked.least_travel
            if progress:
                progress(len(holes), len(stated.holes))
    wrong += [_error(message, None) for message in _sequence_differs(stated, least if chosen else np.inf)]
    further = tuple(check_plan(each, workers=workers, progress=progress) for each in stated.further)
    plan = replace(stated, holes=tuple(holes), further=tuple(each.plan for each in further))
    return Checked(plan, tuple(wrong), further)


class CheckedHole(NamedTuple):
    """What the check of one hole gives.

    Attributes:
        verified: the outcome, None without a motion.
        wrong: one sentence for each field that differs: its name, what is stated and what is found.
        least_travel: of the motion that is found when it is searched for again [rad], or of the stated one.
        strokes: of a hole that is drilled in several, each with the outcome.
    """

    verified: Verification | None
    wrong: tuple[str, ...]
    least_travel: float = 0.0
    strokes: tuple[Stroke, ...] = ()


def _sequence_differs(stated: Plan, least: float) -> Iterator[str]:
    """The order has to name each hole that has a motion, the moves have to be those between them in that order.

    What is said of the whole plan has to be what comes out of that. Together the motions must not travel more than the
    least by more than the share that was allowed.
    """
    travel = sum(hole.score.travel for hole in stated.holes if hole.score is not None)
    allowed = (1 + stated.settings.posture_freedom) * least
    if travel > allowed * (1 + BETTER):
        yield differ("travel_deg of all holes", float(np.rad2deg(travel)), float(np.rad2deg(allowed)))
    said, found = _but(stated.findings, "unfinished", "cad", *GUESSES), lever_findings(stated.robot, stated.tool)
    if not stated.order:  # it has no moves to say anything of
        yield from findings_differ(_but(said, "tool_turn"), found)
        return
    moving = [hole.hole.id for hole in stated.holes if hole.motion is not None]
    if sorted(stated.order) != sorted(moving):
        yield differ("order", list(stated.order), moving)
        return
    moves = moves_of(stated)
    time = time_of((hole.cycle_time for hole in stated.holes), moves)
    again = with_tool_turn(replace(stated, transitions=moves, cycle_time=time, findings=found))
    yield from findings_differ(said, _but(again.findings, *_later(said)))
    data = sequence_data(stated), sequence_data(again)
    wrong = list(fields_differ(*data, {}, fields=HEAD_FIELDS))
    of_moves = ([finding for move in each.transitions for finding in move.findings] for each in (stated, again))
    wrong += (f"transitions, {message}" for message in findings_differ(*of_moves))
    # moves that are those which the planner makes may still not be what it says of them
    yield from wrong or (f"transitions, {message}" for message in moves_claimed(stated))


def without_proofs(plan: Plan) -> Plan:
    """The plan without certificates and what they say of placements: who has not proven them again does not show them.

    Args:
        plan: any plan.
    """

    def bare(strokes: Plan) -> Plan:
        return replace(strokes, holes=tuple(
            replace(hole, certificate=None, certified_within=None, findings=_but(hole.findings, OF_A_PROOF))
            for hole in strokes.holes
        ))  # fmt: skip

    return stroke_by_stroke(plan, bare)


def check_hole(
    robot: Robot,
    tool: Tool,
    settings: Settings,
    strokes: Strokes | Literal["given"],
    stated: HolePlan,
    *,
    chosen: bool = False,
) -> CheckedHole:
    """Check the motion of one hole, and compute again what is stated of it.

    Args:
        robot: the arm.
        tool: the drill.
        settings: as planned.
        strokes: of the plan; `given` for one of several strokes of a hole.
        stated: what is claimed.
        chosen: whether the motion may have been chosen for the sequence of the holes, at the cost of some travel.
    """
    if stated.strokes:
        return _check_strokes(robot, tool, settings, stated)
    settings = settings.of(stated.hole)
    deepest = strokes == "deepest" and stated.hole.profile is None
    if strokes == "given":
        again = evaluated_stroke(robot, tool, stated.hole, settings)
    elif deepest:
        again = plan_deepest(robot, tool, _with_its_motion(stated), settings)
    else:
        again = plan(robot, tool, stated.hole, settings)
    if stated.motion is None:
        differences = _fields_differ(robot, stated, again, dict)
        unsaid_or_foreign = findings_differ(_but(stated.findings, OF_A_PROOF), _but(again.findings, *_unknown(stated)))
        return CheckedHole(None, tuple(dict.fromkeys((*stated.unlike, *differences, *unsaid_or_foreign))))
    own = figures(robot, tool, settings, stated)
    answer = stated if own is None else own.answer
    # what is stated of the figures is compared below, so the check of the motion is given those that were found
    verified = verify_hole(robot, tool, settings, answer)
    drilling = Drilling(robot, tool, stated.hole, settings.limit_margin)
    corner = corner_of(drilling, settings, stated.motion)
    found = replace(
        again,
        hole=stated.hole,
        status=stated.status if again.motion is None else again.status,
        motion=stated.motion,
        score=answer.score,
        wrist_offset=answer.wrist_offset,
        baseline=answer.baseline,
        critical_rates=answer.critical_rates,
        measures=answer.measures,
        lost_motion=answer.lost_motion,
        corner=corner,
        verified=stated.verified,
        cycle_time=cycle_time(drilling, settings, stated.motion, corner),
        optimality=_with_gap(stated.optimality, again.optimality, answer.score),
        clearance=_clearance(Drilling(robot, tool, stated.hole, settings.limit_margin), settings, stated),
    )
    searched = Counter(again.findings) - Counter(motion_findings(drilling, settings, again) if again.motion else ())
    said = [*motion_findings(drilling, settings, replace(found, verified=verified)), *searched.elements()]
    digits = cache(partial(_slack, robot, tool, settings, stated, own))
    differences = _fields_differ(robot, stated, found, digits)
    # what fails is said already
    unsaid = (OF_A_PROOF, *_unknown(stated), *_later(stated.findings), *(() if verified.passed else ("verification",)))
    differences += findings_differ(_but(stated.findings, *unsaid), _but(said, *unsaid))
    differences += _asked_differs(robot, settings, stated, deepest)
    if own is not None:
        differences += () if chosen else _turn_differs(robot, settings, stated.motion, own)
        differences += () if deepest else _improved(robot, tool, settings, found, again, chosen=chosen)
    if stated.verified is not None:
        fails = not verified.passed or bool(differences)
        outcome = replace(stated, verified=_comparable(stated.verified, verified, fails))
        differences += _fields_differ(robot, stated, outcome, digits)
    # of what is stated, too, where that is the same
    differences = list(dict.fromkeys([*differences, *stated.unlike]))
    known = subject(robot, tool, settings, stated) if verified.subject and not differences else None
    least = again.score if again.score is not None else stated.score
    return CheckedHole(replace(verified, subject=known), tuple(differences), least.travel if least else 0.0)


def _check_strokes(robot: Robot, tool: Tool, settings: Settings, stated: HolePlan) -> CheckedHole:
    """Check each stroke of a hole, and what they are said to come to together."""
    own = [check_hole(robot, tool, settings, "given", stroke.answer, chosen=True) for stroke in stated.strokes]
    again, found = plan(robot, tool, stated.hole, settings), strokes_again(robot, tool, settings, stated)
    wrong = [f"strokes[{n}].answer.{message}" for n, each in enumerate(own) for message in each.wrong]
    found = with_findings_of(found, again)
    wrong += [
        *stated.unlike,
        *strokes_differ(settings, stated, found, again),
        *_fields_differ(robot, stated, found, dict),
    ]
    wrong += findings_differ(_but(stated.findings, OF_A_PROOF), _but(found.findings, OF_A_PROOF))
    checked = with_checks(stated, [each.verified for each in own])
    travel = 0.0 if stated.score is None else stated.score.travel
    return CheckedHole(checked.verified, tuple(dict.fromkeys(wrong)), travel, checked.strokes)


def _unknown(stated: HolePlan) -> tuple[FindingKind, ...]:
    """Findings of a figure that a file does not state."""
    return ("deepest",) if stated.deepest is None else ()


def _clearance(drilling: Drilling, settings: Settings, stated: HolePlan) -> Clearance | None:
    """How near the stated motion comes to what stands around; whether that is proven the check of the motion says."""
    assert stated.motion is not None
    found = clearance_of(drilling, settings, stated.motion)
    said = stated.clearance
    if found is None or said is None:
        return found
    found = replace(found, certified=said.certified)
    # of an older plan it is not known how much of the way is covered
    return replace(found, lead_in=None, approach=None, retract=None) if said.lead_in is None else found


def _with_gap(stated: Optimality | None, found: Optimality | None, score: Score | None) -> Optimality | None:
    """What is proven, with the gap that the stated bound leaves: where a proof stops depends on the last digits."""
    if stated is None or stated.travel_at_least is None or found is None or found.gap is None or not score:
        return found
    return replace(found, gap=1 - stated.travel_at_least / score.travel) if score.travel > 0 else found


def _with_its_motion(stated: HolePlan) -> Hole:
    """The hole of a deepest stroke, its motion given, so that the search is sure to know of it."""
    motion, hole = stated.motion, stated.hole
    if motion is None or not np.allclose(motion.profile.standoff[[0, -1]], hole.depth, rtol=0, atol=1e-9):
        return hole
    return replace(hole, profile=motion.profile)


def _error(message: str, hole: str | None) -> Finding:
    return Finding("error", "verification", message, hole)


def _fields_differ(
    robot: Robot, stated: HolePlan, found: HolePlan, digits: Callable[[], dict[str, float]]
) -> list[str]:
    """One sentence for each field that differs by more than its tolerance and what the file's digits leave open."""
    data = answer_data(stated, "asked"), answer_data(found, "asked")
    differences = list(fields_differ(*data, {}, size=robot.size))
    return list(fields_differ(*data, digits(), size=robot.size)) if differences else []


def _slack(robot: Robot, tool: Tool, settings: Settings, stated: HolePlan, own: Figures | None) -> dict[str, float]:
    """What the digits of the file leave open of the figures, by their paths, in the units of the file."""
    slack: dict[str, float] = {}
    if own is None:
        return slack
    here = dict(leaves(answer_data(own.answer, "asked")))
    for moved in moved_figures(robot, tool, settings, stated):
        there = dict(leaves(answer_data(moved, "asked")))
        for path, value in here.items():
            other = there.get(path, value)
            if isinstance(value, float) and isinstance(other, float):
                slack[path] = slack.get(path, 0.0) + 2 * abs(value - other)
            elif isinstance(value, float) != isinstance(other, float):
                slack[path] = np.inf  # a rate that is all but undefined
    nearest = max(value for path, value in slack.items() if path.startswith("limit_distance_deg"))
    return slack | {"verified.min_limit_distance_deg": nearest}


def _comparable(stated: Verification, found: Verification, fails: bool) -> Verification:
    """The outcome of the check; where something fails, that is said already, regardless of what was stated of it."""
    return replace(found, passed=stated.passed, failures=stated.failures) if fails else found


def _later(stated: Iterable[Finding]) -> set[str]:
    """Of the kinds that an older version did not know those of which nothing is stated: they are not missed."""
    return set[str](LATER) - {finding.kind for finding in stated}


def _but(findings: Iterable[Finding], *kinds: str) -> tuple[Finding, ...]:
    """Findings but for those of some kinds."""
    return tuple(finding for finding in findings if finding.kind not in kinds)


def _asked_differs(robot: Robot, settings: Settings, stated: HolePlan, deepest: bool) -> Iterator[str]:
    """What planning keeps of every motion that it finds: the programmed corner, and the cap on the twist of free legs.

    A given motion is the one that is run, a deepest one is as deep as the stroke that is stated.
    """
    motion = stated.motion
    assert motion is not None
    if stated.hole.profile is not None:
        data = answer_data(stated, "asked")
        for name in ("standoff_mm", "psi_deg"):
            given, run = data["given"][name], data[name]
            if len(given) != len(run):
                yield differ(f"given.{name}", given, run)
            else:
                pairs = enumerate(zip(given, run, strict=True))
                yield from (differ(f"given.{name}[{i}]", a, b) for i, (a, b) in pairs if a != b)
    if stated.status != "planned":
        return
    profile = motion.profile
    if abs(profile.standoff.min() - settings.corner_standoff) > 1e-9 * robot.size:
        yield differ(
            f"standoff_mm[{profile.corner}]", float(mm(profile.standoff.min())), float(mm(settings.corner_standoff))
        )
    twist = float(np.abs(profile.twist_rate).max())
    if settings.legs == "free" and profile.psi.size > 3 and twist > settings.max_twist * (1 + 1e-6):
        yield differ("settings.max_twist_deg_per_mm", float(deg_per_mm(settings.max_twist)), float(deg_per_mm(twist)))
    if deepest and stated.deepest is not None and abs(stated.hole.depth - stated.deepest) > 1e-12:
        yield differ("depth_mm", float(mm(stated.hole.depth)), float(mm(stated.deepest)))


def _turn_differs(robot: Robot, settings: Settings, motion: Motion, own: Figures) -> Iterator[str]:
    """The turns of the joints have to be those that the settings ask for."""
    other = nearer_turn(robot, settings, motion, own.joints)
    if other is not None:
        joint, angle = other
        path = f"joints_deg.start[{joint}]"
        yield differ(path, float(np.rad2deg(motion.joints[0, joint])), float(np.rad2deg(angle)))


def _improved(
    robot: Robot, tool: Tool, settings: Settings, found: HolePlan, again: HolePlan, *, chosen: bool
) -> Iterator[str]:
    """A motion that is stated as the best must not be beaten by the one that is found when it is searched for again.

    One that may have been chosen for the sequence has to be as good but for what it costs; of that the sequence may
    take a share, of the travel that of all holes together.
    """
    order = Order(Drilling(robot, tool, found.hole, settings.limit_margin), settings)
    ours, theirs = _candidate(order, found), _candidate(order, again)
    if ours is None or theirs is None:
        return
    if found.hole.profile is not None:
        # given, and on the better of all branches where none is named
        costs = [thesis_objective(each.evaluation) for each in (ours, theirs)]
        if costs[1] < costs[0] * (1 - BETTER):
            yield differ("branch", ours.branch, theirs.branch)
        return
    mine, other = order.rank(ours), order.rank(theirs)
    least = other.cost
    if chosen:
        of_all_holes = settings.objective == "travel" and not settings.weights
        least += np.inf if of_all_holes else settings.posture_freedom * abs(least)
    for path, stated, better in (
        ("reversals, weighted", mine.reversals, other.reversals),
        ("min_rate_deg_per_mm, below the threshold by", deg_per_mm(mine.lack).item(), deg_per_mm(other.lack).item()),
        ("settings.objective, its cost", mine.cost, least),
    ):
        if better < stated - BETTER * abs(stated):
            yield f"{differ(path, stated, better)} by searching again"
        if abs(better - stated) > BETTER * abs(stated):
            return


def _candidate(order: Order, answer: HolePlan) -> Candidate | None:
    motion = answer.motion
    evaluation = Evaluation(motion, answer.score, ())
    return None if motion is None else order.judged(motion.profile, motion.branch, evaluation)
