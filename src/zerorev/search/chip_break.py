"""Motions that draw the drill back on the way in, to break the chips, without a reversal.

Where the tool draws back each joint has to move the other way, seen outwards, than on the plunge, or it turns round
twice: the slope of the way back has to lie on the other side of all critical rates that are there (theory §2), which is
an interval of slopes at every break. Of it the slope nearest to the retract's is taken, so that from break to break the
spin is shifted by little: by the difference to the plunge's slope times the way back.

The search is the one for straight legs, asked for more and more margin, each of its answers with the breaks put in:
good motions, of which none is proven to be the best.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from zerorev.model.cycle import Cycle
from zerorev.model.profile import Profile
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling, joint_rates
from zerorev.search.optimum import best_motion, on_each_branch
from zerorev.search.rank import Candidate, Order

__all__ = ["chip_breaking", "with_breaks"]

MARGINS = (0.0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8, 1.5, 3.0)  # beyond the motion threshold, as shares of it
ROUNDS = 4
# beyond the motion threshold on a way back [rad/m]: 0.001 deg/mm, so that the digits of a program turn no joint round
ROOM = float(np.deg2rad(1.0))
LEAST = float(np.deg2rad(2.0))  # [rad/m] of which they are shares where there is no threshold: 0.002 deg/mm


def chip_breaking(drilling: Drilling, settings: Settings, cycle: Cycle) -> list[Candidate]:
    """Motions of straight legs that break chips, the best first; empty where none can be run.

    Args:
        drilling: what is drilled.
        settings: by which they are ranked.
        cycle: how often and how far the tool draws back.
    """
    order = Order(drilling, settings)
    found = []
    for one in _straight(drilling, settings):
        profile = with_breaks(drilling, settings, one.profile, one.branch, cycle)
        bound = settings.psi_bound
        if bound is None or np.abs(profile.psi).max() <= bound:
            candidate = order.candidate(profile, one.branch)
            if candidate is not None:
                found.append(candidate)
    return sorted(found, key=order.rank)


def with_breaks(drilling: Drilling, settings: Settings, profile: Profile, branch: int, cycle: Cycle) -> Profile:
    """A motion of two straight legs with the breaks of the chips put in; corner and retract stay as they are.

    Args:
        drilling: robot, tool and hole.
        settings: with the motion threshold, and the greatest twist.
        profile: of three breakpoints.
        branch: 0..7.
        cycle: how often and how far the tool draws back.
    """
    plunge, retract = profile.twist_rate
    standoff, psi = [float(profile.standoff[1])], [float(profile.psi[1])]
    for at in cycle.breaks(float(profile.standoff[0]))[::-1]:  # from the corner outwards
        end = float(at) + cycle.back, psi[-1] + plunge * (float(at) + cycle.back - standoff[-1])
        slope = _way_back(drilling, settings, branch, end, (plunge, retract), cycle.back)
        standoff += [end[0], float(at)]
        psi += [end[1], end[1] - slope * cycle.back]
    psi.append(psi[-1] + plunge * (float(profile.standoff[0]) - standoff[-1]))
    standoff.append(float(profile.standoff[0]))
    return Profile(np.array([*standoff[::-1], profile.standoff[2]]), np.array([*psi[::-1], profile.psi[2]]))


def _way_back(
    drilling: Drilling,
    settings: Settings,
    branch: int,
    end: tuple[float, float],
    slopes: tuple[float, float],
    back: float,
) -> float:
    """The slope nearest to the retract's with which the tool draws back so that no joint turns round [rad/m].

    The retract's own where there is none.

    Args:
        drilling: robot, tool and hole.
        settings: with the motion threshold, and the greatest twist.
        branch: 0..7.
        end: stand-off [m] and spin [rad] at which the way back ends, and the plunge continues.
        slopes: of plunge and retract [rad/m].
        back: length of the way back [m].
    """
    plunge, retract = slopes
    least = settings.min_rate + ROOM
    slope = retract
    for _ in range(ROUNDS):  # where it begins depends on the slope
        s = np.array([end[0], end[0] - back])
        theta_s, theta_psi = (
            each[:, branch] for each in joint_rates(drilling, s, np.array([end[1], end[1] - slope * back]))
        )
        way = -np.sign(theta_s + plunge * theta_psi)
        # way * (theta_s + u theta_psi) >= least
        with np.errstate(divide="ignore", invalid="ignore"):
            at = (least / way - theta_s) / theta_psi
        rising = way * theta_psi > 0
        low = float(np.max(at[rising], initial=-settings.max_twist))
        high = float(np.min(at[~rising], initial=settings.max_twist))
        if not low <= high:
            return retract
        slope = float(np.clip(retract, low, high))
    return slope


def _straight(drilling: Drilling, settings: Settings) -> Iterator[Candidate]:
    """Good motions of straight legs, those of more margin and of every branch among them."""
    plain = replace(settings, legs="straight", proof_boxes=0)
    unit = settings.min_rate or LEAST
    for margin in MARGINS:
        asked = replace(plain, min_rate=settings.min_rate + margin * unit)
        motion = best_motion(drilling, asked)
        if motion is not None:
            yield motion
        yield from on_each_branch(drilling, asked)
