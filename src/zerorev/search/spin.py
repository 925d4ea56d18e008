"""Motions on which the tool spins on at the target, so that it dwells there and no joint rests.

On the plunge and on the retract of a motion without reversals each joint moves one way, so it does in every mix of the
two velocities. One of these mixes lets the tip stand: the tool then spins alone, by the difference of the two slopes
(theory §2). The tool spins on with the mix that lets the tip creep in by a little, so that controllers, which measure a
blend along the way of the tip, have a way to blend: each joint then moves at a speed between those of the two legs.

The search is the one for straight legs, asked for more and more margin, each of its answers with the spin put in: good
motions, of which none is proven to be the best.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.corner import MOST_TILT
from zerorev.model.profile import Profile
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling
from zerorev.motion.joint_path import joints_along
from zerorev.motion.kinematics import forward, tcp_pose
from zerorev.search.rank import Candidate, Order

__all__ = ["MOST_MOVES", "TIMES", "spinning", "with_spin"]

TIMES = (1.0, 0.8, 0.6, 0.4, 0.2, 0.1)  # shares of the time that is asked for, until a motion is found
SHIFTS = (0.5, 0.0, 1.0)  # shares of the spin by which the plunge begins earlier; the retract begins later by the rest
MOST_MOVES = 16
ROOM = 0.4  # share of a tolerance that the joint moves of the spin alone may take
SAMPLES = 9  # of the spin, along which the joints are followed; odd, so that its middle is one


def spinning(drilling: Drilling, settings: Settings, straight: Iterable[Candidate], time: float) -> list[Candidate]:
    """Motions that spin on at the target without a reversal more, the best first; empty where none can be run.

    Args:
        drilling: what is drilled.
        settings: by which they are ranked.
        straight: motions that do not dwell, which may break chips.
        time: for which the tool spins on [s].
    """
    order, bound = Order(drilling, settings), settings.psi_bound
    found = []
    for one in straight:
        # where chips are broken, each way back is right for its own spin
        for shift in SHIFTS if len(one.profile.psi) == 3 else (0.0,):
            profile = with_spin(drilling, settings, one, time, shift)
            if profile is None or (bound is not None and np.abs(profile.psi).max() > bound):
                continue
            candidate = order.candidate(profile, one.branch)
            if candidate is not None and candidate.score.reversals <= one.score.reversals:
                found.append(candidate)
    return sorted(found, key=order.rank)


def with_spin(
    drilling: Drilling, settings: Settings, motion: Candidate, time: float, shift: float = 0.0
) -> Profile | None:
    """A motion with the spin at its corner put in; slopes stay as they are.

    Args:
        drilling: robot, tool and hole.
        settings: with feeds and tolerance.
        motion: that does not dwell.
        time: for which the tool spins on [s].
        shift: share of the spin by which the plunge begins earlier.

    Returns:
        the motion, or None where so many joint moves would be needed that their ends lie too close.
    """
    profile, creep = motion.profile, settings.creep_in(time)
    k = profile.corner
    slopes = profile.twist_rate[[k - 1, k]]
    speed = np.array([settings.feed_inwards(0.0), settings.feed_retract])
    # the two velocities mixed so that the tip goes in by the creep in all
    inwards = (creep + speed[1] * time) / speed.sum()
    angle = float((time - inwards) * speed[1] * slopes[1] - inwards * speed[0] * slopes[0])
    begin = float(profile.psi[k] + slopes[0] * creep - shift * angle)
    corner = float(profile.standoff[k])
    count = _moves(drilling, settings, motion.branch, np.array([[corner + creep, begin], [corner, begin + angle]]))
    if count is None:
        return None
    share = np.arange(count + 1) / count
    standoff = [*profile.standoff[:k], *(corner + creep * (1 - share)), *profile.standoff[k + 1 :]]
    later = begin + angle - float(profile.psi[k])
    psi = [*(profile.psi[:k] - shift * angle), *(begin + angle * share), *(profile.psi[k + 1 :] + later)]
    return Profile(np.array(standoff), np.array(psi))


def _moves(drilling: Drilling, settings: Settings, branch: int, ends: Array) -> int | None:
    """In how many joint moves the tool spins on so that it stays near the axis, and the tip near its place.

    What a joint move is off by goes as the square of its length; it is least known where two of them are blended into
    one.

    Args:
        drilling: robot, tool and hole.
        settings: with the tolerance.
        branch: 0..7.
        ends: stand-off [m] and spin [rad] at both, shape (2, 2).
    """
    share = np.linspace(0.0, 1.0, SAMPLES)[:, None]
    standoff, psi = (ends[0] + share * (ends[1] - ends[0])).T
    joints = joints_along(drilling, branch, standoff, psi)
    middle = (joints[0] + joints[-1]) / 2
    found = forward(drilling.robot, middle[None])[0] @ drilling.tool.T_flange_tcp
    wanted = tcp_pose(drilling.hole, standoff[SAMPLES // 2], psi[SAMPLES // 2])
    off = float(np.linalg.norm(found[:3, 3] - wanted[:3, 3])) / settings.corner_tolerance
    tilt = float(np.linalg.norm(found[:3, 2] - wanted[:3, 2])) / MOST_TILT
    excess = max(off, tilt) / ROOM
    if not excess > 1:
        return 1 if np.isfinite(excess) else None
    count = int(np.ceil(2 * np.sqrt(excess)))
    return count if count <= MOST_MOVES else None
