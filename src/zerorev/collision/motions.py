"""Whether the own moves of a hole keep clear of what stands around: its legs, and the blend of its corner."""

from __future__ import annotations

from collections.abc import Iterator

from zerorev.collision.arms import Setting
from zerorev.collision.near import Nearest, Path, blend_lines, first_hit, lines
from zerorev.model.profile import Profile
from zerorev.model.settings import Settings
from zerorev.motion.drilling import Drilling

__all__ = ["hit_of", "paths_of"]


def paths_of(drilling: Drilling, settings: Settings, profile: Profile, branch: int) -> Iterator[Path]:
    """The paths of a motion, its corner as it is and blended.

    Args:
        drilling: robot, tool and hole.
        settings: with the blend.
        profile: of the motion.
        branch: 0..7.
    """
    yield from lines(drilling, branch, zip(profile.standoff.tolist(), profile.psi.tolist(), strict=True))
    yield from blend_lines(drilling, branch, profile, settings.corner_blend)


def hit_of(setting: Setting, drilling: Drilling, settings: Settings, profile: Profile, branch: int) -> Nearest | None:
    """Where a motion does not keep the clearance; None where it is proven to keep it.

    Args:
        setting: the bodies and what stands around.
        drilling: robot, tool and hole.
        settings: with the blend.
        profile: of the motion.
        branch: 0..7.
    """
    return first_hit(setting, drilling.robot, paths_of(drilling, settings, profile, branch), setting.drilled)
