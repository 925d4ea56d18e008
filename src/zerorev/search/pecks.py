"""Several strokes into one hole, the drill pulled out between them, that follow one another without a reversal.

A stroke without a reversal spins the tool on in one sense, and so does the next one if it begins where the one before
has ended: then no joint turns round between them, either. The joints run on with each stroke until a limit, or a place
where the critical rates lie too far apart, ends it; there the tool turns back, outside the material, and begins again.

From many spins to start with, on each posture and in either sense, each stroke in turn takes the least slopes on both
sides of all critical rates along its legs. Of such runs the one with the most strokes is taken, and of those the one
that travels least: good motions, of which none is proven to be the best.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from zerorev.kernels.field import rates
from zerorev.model._arrays import Array
from zerorev.model.profile import Profile
from zerorev.model.robot import JointLimits
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluated
from zerorev.motion.joint_path import choose_turns
from zerorev.search.broken_legs import ROOM
from zerorev.search.optimum import best_motion, on_each_branch
from zerorev.search.rank import Candidate, Order

__all__ = ["Pecks", "pecking"]

STARTS = 36  # spins to begin with
SIDES = np.deg2rad(np.geomspace(3.0, 3000.0, 16))  # [rad/m] beyond the critical rates, from 0.003 to 3 deg/mm
SAMPLES = 7  # of a leg
TRIED = 3  # slopes of a plunge, the least that suffice
WIDE = 8 * np.pi  # [rad] limits that no run comes near
NO_STROKE = "no stroke is without a reversal"


@dataclass(frozen=True)
class Pecks:
    """The strokes of a hole.

    Attributes:
        strokes: one motion each, in order, stand-offs counted from where it ends.
        in_a_row: how many of them, from the first on, follow one another without a reversal.
        ended: by what that ends; empty: they are all.
    """

    strokes: tuple[Candidate, ...]
    in_a_row: int
    ended: str


@dataclass(frozen=True)
class _Run:
    """Strokes that follow one another.

    Attributes:
        motions: one each, the joints continuous from one to the next, regardless of the limits.
        turns: of the joints, that bring all of them within the limits [rad], shape (6,).
        ended: by what it ends; empty: no stroke is left.
    """

    motions: tuple[Candidate, ...]
    turns: Array
    ended: str

    @property
    def travel(self) -> float:
        """Of all its strokes [rad]."""
        return sum(one.score.travel for one in self.motions)


def pecking(drilling: Drilling, settings: Settings, depths: Sequence[float]) -> Pecks | None:
    """Motions of straight legs for strokes of rising depth into one hole; None where one of them cannot be run.

    Args:
        drilling: the hole, all of it.
        settings: by which motions are ranked.
        depths: of the strokes, rising, the last one that of the hole [m].
    """
    search = _Search(drilling, settings, depths)
    found: list[Candidate] = []
    in_a_row, ended = 0, ""
    while len(found) < len(depths):
        before = found[-1] if found else None
        run = search.longest(len(found), before)
        strokes = search.within_limits(run, len(found)) if run is not None else ()
        if not found:
            in_a_row, ended = len(strokes), run.ended if run is not None else NO_STROKE
        if not strokes:
            other = search.on_its_own(len(found), None if before is None else before.branch)
            if other is None:
                return None
            strokes = (other,)
        found += strokes
    return Pecks(tuple(found), in_a_row, ended)


@dataclass(frozen=True)
class _Search:
    """For the strokes of one hole."""

    drilling: Drilling
    settings: Settings
    depths: Sequence[float]

    def stroke(self, number: int) -> Drilling:
        """The hole that ends where a stroke does."""
        whole = self.drilling.hole
        return self.drilling.nearer(whole.depth - self.depths[number])

    def longest(self, first: int, before: Candidate | None) -> _Run | None:
        """The run with the most strokes from one of them on, of those the one that travels least.

        Args:
            first: number of the stroke that it begins with, from 0.
            before: the stroke before it, whose posture and turns it takes up; None: there is none.
        """
        asked = self.drilling.hole.branch if before is None else before.branch
        near, middle = self.settings.near_joints, 0.0
        if before is not None and before.evaluation.motion is not None:
            near, middle = tuple(before.evaluation.motion.joints[-1].tolist()), float(before.profile.psi[-1])
        best: _Run | None = None
        for one in range(8) if asked is None else (asked,):
            for sense in (1.0, -1.0):
                for psi in (middle + np.linspace(-np.pi, np.pi, STARTS, endpoint=False)).tolist():
                    run = self.run(first, one, sense, psi, near)
                    if run is not None and (best is None or _key(run) < _key(best)):
                        best = run
        return best

    def run(self, first: int, branch: int, sense: float, psi: float, wanted: tuple[float, ...] | None) -> _Run | None:
        """The run that begins with some spin where the lead-in does; None where it has no stroke.

        Args:
            first: number of its first stroke, from 0.
            branch: 0..7.
            sense: +1 or -1: which way the tool spins on.
            psi: spin at the beginning of the lead-in [rad].
            wanted: joints near which its turns are chosen [rad]; None: far from the limits.
        """
        wide = JointLimits(np.full(6, -WIDE), np.full(6, WIDE), self.drilling.robot.limits.speed)
        robot = replace(self.drilling.robot, limits=wide)
        motions: list[Candidate] = []
        low, high, turns, ended = np.full(6, np.inf), np.full(6, -np.inf), np.zeros(6), ""
        signs: Array | None = None
        near = np.zeros(6) if wanted is None else np.array(wanted)
        for number in range(first, len(self.depths)):
            stroke = replace(self.stroke(number), robot=robot, limit_margin=0.0)
            found = self.step(stroke, branch, sense, psi, near, signs)
            if found is None:
                ended = _obstacle(stroke, self.settings, branch // 2, sense, psi, signs)
                break
            motion, signs = found
            assert motion.evaluation.motion is not None
            joints = motion.evaluation.motion.joints  # without a reversal they are farthest out at breakpoints
            low, high = np.minimum(low, joints.min(axis=0)), np.maximum(high, joints.max(axis=0))
            chosen, over = choose_turns(low, high, self.drilling.limits, wanted)
            if over:
                ended = f"{self.drilling.robot.joint_names[over[0] - 1]} comes to its limit"
                break
            turns, near = chosen, joints[-1]
            motions.append(motion)
            psi = float(motion.profile.psi[-1]) + float(motion.profile.twist_rate[-1]) * self.settings.lead_in
        return _Run(tuple(motions), turns, ended) if motions else None

    def step(
        self, stroke: Drilling, branch: int, sense: float, psi: float, near: Array, before: Array | None
    ) -> tuple[Candidate, Array] | None:
        """One stroke whose lead-in begins with some spin [rad], and the signs of its joints' rates, (6,).

        Args:
            stroke: the hole that ends where it does.
            branch: 0..7.
            sense: +1 or -1: which way the tool spins on.
            psi: spin where the lead-in begins [rad].
            near: joints near which the turns are [rad], shape (6,).
            before: the signs of the stroke before, which it keeps, shape (6,); None: any.
        """
        order = Order(stroke, replace(self.settings, near_joints=tuple(near.tolist())))
        for plunge, retract, signs in _slopes(stroke, self.settings, branch // 2, sense, psi, before):
            depth = stroke.hole.depth
            corner = psi - plunge * (depth + self.settings.lead_in)
            profile = Profile.straight(depth, corner + plunge * depth, corner, corner + retract * depth)
            one = order.candidate(profile, branch)
            if one is not None and one.reversals == 0 and one.keeps_threshold:
                return one, signs
        return None

    def within_limits(self, run: _Run, first: int) -> tuple[Candidate, ...]:
        """The strokes of a run with the turns of the joints that keep the limits, as far as all goes well."""
        kept = []
        for number, motion in enumerate(run.motions, first):
            assert motion.evaluation.motion is not None
            joints = motion.evaluation.motion.joints + run.turns
            settings = replace(self.settings, near_joints=tuple(joints.mean(axis=0).tolist()))
            stroke = self.stroke(number)
            profile = _deepened(motion.profile, self.settings.corner_standoff)
            found = Order(stroke, self.settings).judged(
                profile, motion.branch, evaluated(stroke, profile, motion.branch, settings)
            )
            if found is None or found.reversals or not found.keeps_threshold:
                break
            kept.append(found)
        return tuple(kept)

    def on_its_own(self, number: int, branch: int | None) -> Candidate | None:
        """The best motion of a stroke regardless of the others, reversals and all."""
        stroke = self.stroke(number)
        settings = replace(self.settings, legs="straight", proof_boxes=0)
        own = () if branch is None else [one for one in on_each_branch(stroke, settings) if one.branch == branch]
        return Order(stroke, settings).best(own) or best_motion(stroke, settings)


def _key(run: _Run) -> tuple[int, float]:
    return -len(run.motions), run.travel


def _deepened(profile: Profile, corner: float) -> Profile:
    """A motion of three breakpoints with its corner placed deeper, on the same plunge."""
    if corner == 0:
        return profile
    psi = profile.psi.copy()
    psi[1] += profile.twist_rate[0] * corner
    return Profile(np.array([profile.standoff[0], corner, profile.standoff[2]]), psi)


def _slopes(
    stroke: Drilling, settings: Settings, posture: int, sense: float, psi: float, before: Array | None
) -> Iterator[tuple[float, float, Array]]:
    """Slopes of plunge and retract [rad/m] with which no joint turns round, those that spin the tool least first.

    With them the signs of the joints' rates on the plunge, read outwards, shape (6,).

    Args:
        stroke: the hole that ends where the stroke does.
        settings: with the motion threshold, the greatest twist, and the lead-in.
        posture: 0..3; the two flips of the wrist have the same slopes.
        sense: +1 or -1: which way the tool spins on.
        psi: spin where the lead-in begins [rad].
        before: the signs of the stroke before, which are kept, shape (6,); None: any.
    """
    begin = stroke.hole.depth + settings.lead_in
    inwards = np.linspace(begin, 0.0, SAMPLES)
    found = []
    for plunge, signs in _on_one_side(stroke, settings, posture, (begin, psi), inwards, -sense):
        if before is not None and (signs != before).any():
            continue
        corner = psi - plunge * begin
        outwards = np.linspace(0.0, begin, SAMPLES)  # on to where the next lead-in begins
        for retract, other in _on_one_side(stroke, settings, posture, (0.0, corner), outwards, sense):
            if (other == -signs).all():
                found.append((plunge, retract, signs))
                break
        if len(found) == TRIED:
            break
    yield from sorted(found, key=lambda each: abs(each[1] - each[0]))


def _on_one_side(
    stroke: Drilling, settings: Settings, posture: int, at: tuple[float, float], standoff: Array, side: float
) -> Iterator[tuple[float, Array]]:
    """Slopes [rad/m] beyond all critical rates along a leg, nearest first, with the signs of the joints' rates.

    Args:
        stroke: the hole.
        settings: with the motion threshold and the greatest twist.
        posture: 0..3.
        at: stand-off [m] and spin [rad] where the leg begins.
        standoff: along it [m], shape (n,).
        side: +1: slopes above the critical rates there; -1: below them.
    """
    slopes, keeps, signs = _kept(stroke, settings, posture, at, standoff, side)
    for k in np.flatnonzero(keeps.all(axis=0)).tolist():
        yield float(slopes[k]), signs[:, k]


def _kept(
    stroke: Drilling, settings: Settings, posture: int, at: tuple[float, float], standoff: Array, side: float
) -> tuple[Array, npt.NDArray[np.bool_], Array]:
    """Slopes, nearest first [rad/m], (m,); which joints keep their direction on the leg, (6, m); and that, (6, m)."""
    theta_s, theta_psi = _rates(stroke, posture, np.array([at[0]]), np.array([at[1]]))
    with np.errstate(divide="ignore", invalid="ignore"):
        critical = -theta_s[:, 0] / theta_psi[:, 0]
    critical = critical[np.abs(critical) < settings.max_twist]
    slopes = side * (np.max(side * critical, initial=-settings.max_twist) + SIDES)
    slopes = slopes[np.abs(slopes) <= settings.max_twist]
    s, along = np.tile(standoff, slopes.size), np.repeat(slopes, standoff.size)
    theta_s, theta_psi = _rates(stroke, posture, s, at[1] + along * (s - at[0]))
    rate = (theta_s + along * theta_psi).reshape(6, slopes.size, standoff.size)
    signs = np.asarray(np.sign(rate[:, :, 0]))
    keeps = np.asarray((signs[..., None] * rate >= settings.min_rate + ROOM).all(axis=2))
    return slopes, keeps, signs


def _obstacle(
    stroke: Drilling, settings: Settings, posture: int, sense: float, psi: float, before: Array | None
) -> str:
    """Which joint would turn round on a stroke, regardless of its slopes, in words; the arguments of `_slopes`."""
    begin = stroke.hole.depth + settings.lead_in
    slopes, keeps, signs = _kept(stroke, settings, posture, (begin, psi), np.linspace(begin, 0.0, SAMPLES), -sense)
    if before is not None:
        keeps = keeps & (signs == before[:, None])
    counts = keeps.sum(axis=1)
    if slopes.size and counts.min() > 0:  # it is the way out
        corner = psi - float(slopes[int(np.argmax(keeps.sum(axis=0)))]) * begin
        counts = _kept(stroke, settings, posture, (0.0, corner), np.linspace(0.0, begin, SAMPLES), sense)[1].sum(axis=1)
    return f"{stroke.robot.joint_names[int(np.argmin(counts))]} would turn round, or be slower than min_rate"


def _rates(stroke: Drilling, posture: int, standoff: Array, psi: Array) -> tuple[Array, Array]:
    """Both rate fields of a posture, (6, n) each."""
    theta_s, theta_psi = np.empty((6, standoff.size)), np.empty((6, standoff.size))
    rates(stroke.robot.arm, stroke.plane, posture, np.ascontiguousarray(standoff), np.ascontiguousarray(psi),
          theta_s, theta_psi)  # fmt: skip
    return theta_s, theta_psi
