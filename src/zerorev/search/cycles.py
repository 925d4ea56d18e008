"""The best motion of a hole and its deepest stroke as the hole is drilled: in one go, or breaking chips on the way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from zerorev.model.cycle import Cycle
from zerorev.model.profile import Profile
from zerorev.model.proof_tree import ProofTree
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling
from zerorev.search.chip_break import chip_breaking, quickly
from zerorev.search.chip_break_depth import deepest_breaking, made_shallower, runs
from zerorev.search.deepest import Deepest
from zerorev.search.optimum import best_motion, deepest_as_drilled
from zerorev.search.rank import Candidate, Order

__all__ = ["best_in_cycle", "chip_breaks", "deepest_in_cycle", "motions_that_break", "raised", "shallower"]

SAME_PLACE = 1e-9  # [m]


def chip_breaks(drilling: Drilling, settings: Settings) -> Cycle | None:
    """How chips are broken in a hole; None: not at all."""
    cycle = drilling.hole.drilled_by(settings.cycle)
    return cycle if cycle.kind == "chip_break" else None


def deepest_in_cycle(drilling: Drilling, settings: Settings, log: list[ProofTree] | None = None) -> Deepest:
    """The deepest stroke of a hole as it is drilled; of one that breaks chips the deepest that is found.

    Args:
        drilling: where to drill; a given motion that is deeper and has no reversal counts.
        settings: as for `optimum.deepest_as_drilled`.
        log: likewise.
    """
    cycle = chip_breaks(drilling, settings)
    if cycle is None:
        return deepest_as_drilled(drilling, settings, log)
    given = drilling.hole.profile
    drilling = drilling.without_motion()
    plain = deepest_as_drilled(drilling, replace(settings.without_proof, legs="straight"))
    return raised(drilling, settings, cycle, deepest_breaking(drilling, settings, cycle, plain), given)


def raised(drilling: Drilling, settings: Settings, cycle: Cycle, deepest: Deepest, profile: Profile | None) -> Deepest:
    """The deepest stroke, a motion taken into account that breaks chips where the cycle does.

    Args:
        drilling: robot, tool and hole.
        settings: as for `deepest_in_cycle`.
        cycle: how often and how far the tool draws back.
        deepest: what is known.
        profile: of the motion; or None.
    """
    if profile is None or profile.standoff[0] <= deepest.depth:
        return deepest
    breaks = cycle.breaks(float(profile.standoff[0]))
    wanted = [place for at in breaks for place in (at, at + cycle.back)]
    if profile.corner - 1 != len(wanted) or np.abs(profile.standoff[1 : profile.corner] - wanted).max() > SAME_PLACE:
        return deepest
    branches = range(8) if drilling.hole.branch is None else (drilling.hole.branch,)
    for branch in branches:
        if runs(drilling, settings, profile, branch):
            return replace(deepest, depth=float(profile.standoff[0]), profile=profile, branch=branch)
    return deepest


def motions_that_break(drilling: Drilling, settings: Settings, cycle: Cycle, deepest: Deepest) -> list[Candidate]:
    """Motions of a hole that break chips, the best first.

    Args:
        drilling: what is drilled.
        settings: by which they are ranked.
        cycle: how often and how far the tool draws back.
        deepest: the deepest stroke, which is made as short as the hole.
    """
    return chip_breaking(drilling, settings, cycle, _known(drilling, settings, cycle, deepest))


def best_in_cycle(drilling: Drilling, settings: Settings) -> Candidate | None:
    """The best motion of a hole as it is drilled, for maps; one that breaks chips is found quickly."""
    cycle = chip_breaks(drilling, settings)
    if cycle is None:
        return best_motion(drilling, settings)
    return quickly(drilling, settings, cycle)


def shallower(drilling: Drilling, settings: Settings, motion: Deepest) -> Candidate | None:
    """The deepest motion of a hole that breaks chips, made as short as the hole; None where that cannot be run."""
    cycle = chip_breaks(drilling, settings)
    assert cycle is not None
    return next(iter(_known(drilling, settings, cycle, motion)), None)


def _known(drilling: Drilling, settings: Settings, cycle: Cycle, motion: Deepest) -> list[Candidate]:
    depth = drilling.hole.depth
    made = None if depth > motion.depth else made_shallower(drilling, settings, cycle, motion, depth)
    found = None if made is None else Order(drilling, settings).candidate(*made)
    return [] if found is None else [found]
