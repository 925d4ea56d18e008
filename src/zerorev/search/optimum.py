"""The one result behind plan, maps, placement and the app: the best motion of a hole, and its deepest stroke.

Every source of motions puts its candidates into one pool, and the one order of motions (`search.rank`) takes the best.
The deepest motion cut short is a candidate at every lesser depth, and a motion without a reversal that is deeper than
the deepest stroke found raises it. So the two agree by construction: a motion of zero reversals that keeps the motion
threshold at every point is found at a depth if and only if the depth is at most the deepest stroke.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from zerorev.model.job import Settings
from zerorev.model.plan import Optimality
from zerorev.model.profile import Profile
from zerorev.model.proof_tree import ProofTree
from zerorev.motion.drilling import Drilling
from zerorev.program.lead_in import find_lead_in
from zerorev.search.bounds.free_depth import bound_free_depth
from zerorev.search.bounds.proof import prove
from zerorev.search.bounds.straight_depth import bound_depth
from zerorev.search.cut_short import cut_short, descended, eased, steadied
from zerorev.search.deepest import WORTH_RAISING, Deepest, deepened, deepest_of
from zerorev.search.exact import search, without_reversal
from zerorev.search.free import search_free
from zerorev.search.problem import Problem
from zerorev.search.rank import Candidate, Order
from zerorev.search.straight import LEAST_RATE
from zerorev.search.weighted import search_weighted

__all__ = [
    "LEAST_STROKE",
    "Optimum",
    "alternatives",
    "best_motion",
    "deepest_as_drilled",
    "on_each_branch",
    "optimum",
    "too_short",
]

MORE_MARGIN = ((1.0, 10.0), (1.05, 1e3), (1.5, 1e4), (3.0, 1e5))  # of the threshold, and of the least rate besides
LEAST_STROKE = 1e-7  # of the reach: in a shorter one the joints move by little more than the rounding of an angle
LEAD_IN_STEPS = 14  # halvings of a lead-in, to 1 um of 10 mm
MOST_RAISES = 8
SAME_PLACE = 1e-9  # [m]
SAME_RATE = 1e-6  # relative: by so much the slowest joint may be below the motion threshold and still keep it


@dataclass(frozen=True)
class Optimum:
    """What is best for a hole.

    Attributes:
        motion: the best one at the hole's depth, or None where no branch can run any.
        deepest: the deepest stroke without a reversal.
        optimality: how much better a motion could be, or None where that was not asked.
    """

    motion: Candidate | None
    deepest: Deepest
    optimality: Optimality | None = None


def optimum(drilling: Drilling, settings: Settings, log: list[ProofTree] | None = None) -> Optimum:
    """The best motion of a hole, and its deepest stroke; stand-offs are counted from the hole's own target.

    Args:
        drilling: what to drill; its `branch`, if any, is the only one searched; a given motion is left aside.
        settings: how; with `weights` their sum decides, else the objective.
        log: out, the trees of the proofs, for the hole down to the programmed corner; or None.
    """
    pool = _Pool(drilling, settings, log)
    best = pool.best()
    pool.settle(best)
    if best is not None and best.reversals and pool.deepest.depth >= pool.drilling.hole.depth:
        best = pool.best()  # what the proof of the depth has found can be cut short
    best, optimality = pool.proven(best)
    return Optimum(pool.from_the_target(best), pool.as_drilled(pool.raised(best)), optimality)


def best_motion(drilling: Drilling, settings: Settings) -> Candidate | None:
    """The best motion of `optimum` alone."""
    pool = _Pool(drilling, settings)
    return pool.from_the_target(pool.best())


def deepest_as_drilled(drilling: Drilling, settings: Settings, log: list[ProofTree] | None = None) -> Deepest:
    """The deepest stroke of `optimum` alone.

    Args:
        drilling: where to drill; where its depth, searched for or with the motion that it gives, is deeper than the
            deepest stroke found otherwise and has no reversal, the stroke is found from there.
        settings: as for `optimum`.
        log: likewise.
    """
    pool = _Pool(drilling, settings, log)
    best = None
    if pool.deepest.depth < pool.drilling.hole.depth:
        found = [
            without_reversal(Problem(pool.drilling, pool.settings)),
            pool.free,
            *pool.given(),
        ]
        best = pool.order.best(one for one in found if one is not None and pool.allows(one))
    pool.settle(best)
    return pool.as_drilled(pool.deepest)


def alternatives(drilling: Drilling, settings: Settings) -> list[Candidate]:
    """Other good motions of a hole, best first: with more margin, and on every branch alone.

    They are for a hole of which the best motion does not pass the check: next to a singularity, or where a joint that
    hardly moves reverses in the blend of the corner.

    Args:
        drilling: what to drill.
        settings: by which they are ranked.
    """
    order = Order(drilling, settings)
    bolder = [settings.min_rate * share + LEAST_RATE * times for share, times in MORE_MARGIN]
    variants = [replace(settings, min_rate=rate) for rate in bolder]
    variants.append(replace(settings, objective="margin", weights=()))
    found = [best_motion(drilling, other) for other in variants]
    branches = range(8) if drilling.hole.branch is None else ()
    found += [best_motion(drilling.on_branch(branch), settings) for branch in branches]
    judged = (order.candidate(one.profile, one.branch) for one in found if one is not None)
    return sorted((one for one in judged if one is not None), key=order.rank)


def on_each_branch(drilling: Drilling, settings: Settings) -> list[Candidate]:
    """The best motion without a reversal of straight legs on each branch that has one, or on its other wrist flip.

    Args:
        drilling: what to drill; its `branch`, if any, is the only one searched.
        settings: as for `optimum`.
    """
    pool = _Pool(drilling, settings)
    found: list[Candidate] = []
    for branch in Problem(pool.drilling, pool.settings).branches:
        if branch % 2 and found and found[-1].branch == branch - 1:
            # the rates of both flips are the same: only the limits can forbid the motion
            flipped = pool.order.candidate(found[-1].profile, branch)
            if flipped is not None:
                found.append(flipped)
                continue
        one = without_reversal(Problem(pool.drilling.on_branch(branch), pool.settings))
        if one is not None:
            found.append(one)
    drilled = (pool.from_the_target(one) for one in found if pool.allows(one))
    return [one for one in drilled if one is not None]


def too_short(drilling: Drilling) -> bool:
    """Whether a stroke is too short for a motion whose figures mean anything."""
    return drilling.hole.depth < LEAST_STROKE * drilling.robot.reach


class _Pool:
    """The candidates of one hole, all of them for the hole down to the programmed corner, drilled by an arm of size 1.

    The tolerances of the searches are made for that size. Weighted criteria are not: they count in units of their own.
    """

    def __init__(self, drilling: Drilling, settings: Settings, log: list[ProofTree] | None = None) -> None:
        self.log = log
        self.size = 1.0 if settings.weights else drilling.robot.size
        self.real = Order(drilling.without_motion(), settings)
        if self.size != 1:
            drilling, settings = drilling.resized(settings, 1 / self.size)
        self.settings, self.profile = settings, drilling.hole.profile
        if settings.corner_standoff:
            self.drilling = drilling.nearer(settings.corner_standoff)
        else:
            self.drilling = self.real.drilling if self.size == 1 else drilling.without_motion()
        self.order = Order(self.drilling, settings)

    @cached_property
    def deepest(self) -> Deepest:
        """The deepest stroke, regardless of the depth of the hole."""
        found = deepest_of(self.drilling, self.settings)
        return self.led_in(found) if self.settings.keep_lead_in else found

    @cached_property
    def free(self) -> Candidate | None:
        """The best motion of free legs, where the settings ask for such."""
        if self.settings.legs == "straight":
            return None
        return search_free(self.drilling, self.settings)

    def cut(self) -> Candidate | None:
        """The deepest motion cut short."""
        found, depth = self.deepest, self.drilling.hole.depth
        if found.profile is None or found.branch is None or depth > found.depth:
            return None
        return self.order.candidate(cut_short(found.profile, depth), found.branch)

    def stretched(self) -> Candidate | None:
        """The greatest margin near the deepest motion, made as deep as the hole."""
        found, depth = self.deepest, self.drilling.hole.depth
        if found.profile is None or found.branch is None or depth <= found.depth or found.profile.psi.size > 3:
            return None
        psi_t = float(found.profile.psi[found.profile.corner])
        return steadied(self.order, found.branch, psi_t, found.profile.twist_rate, LEAST_RATE)

    def given(self) -> list[Candidate]:
        """A given motion on any branch on which it could have been searched for."""
        settings, profile = self.settings, self.profile
        if profile is None or abs(profile.standoff.min() - settings.corner_standoff) > SAME_PLACE:
            return []
        kinked = settings.legs == "straight" and profile.psi.size > 3
        steep = settings.legs == "free" and np.abs(profile.twist_rate).max() > settings.max_twist
        if kinked or steep or np.abs(profile.psi).max() > (settings.psi_bound or np.inf):
            return []
        down = Profile(profile.standoff - settings.corner_standoff, profile.psi)
        branches = range(8) if self.drilling.hole.branch is None else (self.drilling.hole.branch,)
        found = [self.order.candidate(down, branch) for branch in branches]
        return [one for one in found if one is not None]

    def best(self) -> Candidate | None:
        """The best of the pool."""
        if too_short(self.drilling):
            return None
        cut, order = self.cut(), self.order
        known = [one for one in (cut, self.free) if one is not None]
        straight = search_weighted if self.settings.weights else search
        best = order.best([straight(self.drilling, self.settings, known), *known])
        if best is not None and best is cut:  # the search has overlooked its valley
            best = descended(order, best)
        if best is None or best.reversals or not best.keeps_threshold:
            best = order.best([best, self.stretched()])
        if best is not None and not best.keeps_threshold:
            best = eased(order, best)
        if best is not None and not self.allows(best):
            best = order.best(one for one in self.with_lead_in(best) if self.allows(one))
        return best

    def allows(self, motion: Candidate) -> bool:
        """Whether the whole lead-in of a motion runs without a reversal, where the settings ask for that."""
        if not self.settings.keep_lead_in:
            return True
        assert motion.evaluation.motion is not None
        wanted = self.settings.lead_in
        return find_lead_in(self.drilling, motion.evaluation.motion, wanted).length == wanted

    def with_lead_in(self, best: Candidate) -> Iterator[Candidate]:
        """Motions of which the lead-in may run: the best one with its legs swapped, and those of a deeper hole."""
        longer = self.drilling.deep(self.drilling.hole.depth + self.settings.lead_in)
        deeper = _Pool(longer, replace(self.settings, keep_lead_in=False, deepen_corner=False))
        whole = [deeper.best(), self.cut()]
        inner = [cut_short(one.profile, self.drilling.hole.depth) for one in whole if one is not None]
        branches = [one.branch for one in whole if one is not None]
        for profile, branch in zip([best.profile, *inner], [best.branch, *branches], strict=True):
            for way in (profile, profile.reversed()):
                found = self.order.candidate(way, branch)
                if found is not None:
                    yield found

    def led_in(self, found: Deepest) -> Deepest:
        """The deepest stroke whose whole lead-in runs, cut from the deepest motion, its legs swapped or not."""
        if found.profile is None or found.branch is None:
            return found
        ways = [self.longest_led_in(way, found.branch) for way in (found.profile, found.profile.reversed())]
        best = max((cut for cut in ways if cut is not None), key=lambda cut: cut.depth, default=None)
        if best is None:
            return Deepest(0.0, beyond_cap=found.beyond_cap)
        return replace(found, depth=best.depth, profile=best.profile, branch=best.branch)

    def longest_led_in(self, whole: Profile, branch: int) -> Candidate | None:
        """The longest inner part of a motion whose lead-in runs: the outer part of the motion itself, at least."""
        best, high = None, float(whole.standoff[0])
        low = max(high - self.settings.lead_in, 0.0)
        for step in range(LEAD_IN_STEPS):
            depth = high if step == 0 else low if step == 1 and low > 0 else 0.5 * (low + high)
            cut = Order(self.drilling.deep(depth), self.settings).candidate(cut_short(whole, depth), branch)
            if cut is not None and self.allows(cut):
                best, low = cut, depth
            else:
                high = depth
            if high <= low:
                break
        return best

    def proven(self, best: Candidate | None) -> tuple[Candidate | None, Optimality | None]:
        """The best of straight legs, improved where a proof finds that possible, and what is proven of it."""
        if self.settings.proof_boxes == 0 or self.settings.legs == "free":
            return best, None
        problem = Problem(self.drilling, self.settings)
        trees = None if self.log is None else list[ProofTree]()
        proof = prove(problem, best, self.settings.proof_boxes, self.allows, trees)
        self.keep(trees)
        return proof.best, proof.optimality

    def bounded(self, deepest: Deepest) -> Deepest:
        """The deepest stroke with a bound on it; a deeper one of straight legs where the proof finds it."""
        boxes = self.settings.proof_boxes
        if boxes == 0 or self.settings.keep_lead_in:
            return deepest
        problem = Problem(self.drilling, self.settings)
        if self.settings.legs == "free":
            return replace(deepest, at_most=bound_free_depth(problem, deepest.depth, boxes).at_most)
        while boxes > 0:
            trees = None if self.log is None else list[ProofTree]()
            bound = bound_depth(problem, deepest.depth, boxes, trees)
            self.keep(trees)
            boxes -= bound.boxes
            if bound.deeper is None:
                return replace(deepest, at_most=bound.at_most)
            deepest = deepened(self.drilling, self.settings, bound.deeper)
        return deepest

    def keep(self, trees: list[ProofTree] | None) -> None:
        """Keep the trees of a proof, at the arm's own size."""
        if self.log is not None and trees is not None:
            self.log += [tree.resized(self.size) for tree in trees]

    def settle(self, best: Candidate | None) -> None:
        """Bound the deepest stroke, and where the best motion is deeper all the same, bound that.

        The first bound does not depend on the depth of the hole, so that all depths of a hole get the same answer.
        """
        self.deepest = self.bounded(self.deepest)
        raised = self.raised(best)
        if raised is not self.deepest:
            self.deepest = self.bounded(raised)

    def raised(self, best: Candidate | None) -> Deepest:
        """The deepest stroke, the best motion taken into account."""
        if best is None or best.depth <= self.deepest.depth or not self.keeps(best):
            return self.deepest
        if self.settings.keep_lead_in:
            return replace(self.deepest, depth=best.depth, profile=best.profile, branch=best.branch)
        deeper = deepened(self.drilling, self.settings, best)
        for _ in range(MOST_RAISES):
            # another valley may continue where this one ends
            there = self.drilling.deep(deeper.depth)
            beyond = without_reversal(Problem(there, self.settings))
            if beyond is None or not self.keeps(beyond):
                break
            found = deepened(there, self.settings, beyond)
            if found.depth <= deeper.depth * (1 + WORTH_RAISING):
                break
            deeper = found
        return replace(deeper, beyond_cap=self.deepest.beyond_cap)

    def keeps(self, motion: Candidate) -> bool:
        """Whether a motion has no reversal and keeps the motion threshold at every point."""
        least = max(self.settings.min_rate, LEAST_RATE / 2) * (1 - SAME_RATE)
        return motion.reversals == 0 and bool(motion.score.min_rate.min() >= least)

    def from_the_target(self, found: Candidate | None) -> Candidate | None:
        """A motion with its stand-off counted from the hole's own target."""
        if found is None or (self.size == 1 and not self.settings.corner_standoff):
            return found
        if self.settings.corner_standoff:
            return self.real.candidate(self._up(found.profile), found.branch)
        return self.real.judged(self._up(found.profile), found.branch, found.evaluation.resized(self.size))

    def as_drilled(self, found: Deepest) -> Deepest:
        """A stroke counted from the hole's own target."""
        depth = (found.depth + self.settings.corner_standoff) * self.size
        beyond = max(found.beyond_cap + self.settings.corner_standoff, 0.0) * self.size
        at_most = None if found.at_most is None else max(found.at_most + self.settings.corner_standoff, 0.0) * self.size
        if found.profile is None or depth <= 0:
            return Deepest(0.0, beyond_cap=beyond, at_most=at_most)
        return replace(found, depth=depth, profile=self._up(found.profile), beyond_cap=beyond, at_most=at_most)

    def _up(self, profile: Profile) -> Profile:
        return Profile((profile.standoff + self.settings.corner_standoff) * self.size, profile.psi)
