"""The legs of a plan as straight moves along the drill axis and about it."""

from __future__ import annotations

from flint import arb

from zerorev.model.hole import Hole
from zerorev.model.profile import Profile
from zerorev.model.robot import ArmGeometry
from zerorev.model.tool import Tool
from zerorev.verify.certificate.path import Motion, Rig, Segment, motion_of
from zerorev.verify.certificate.vector import across, columns, combined, cross, onto, scaled, vector

__all__ = ["planned_motion", "rig_of"]


def planned_motion(
    arm: ArmGeometry, tool: Tool, hole: Hole, profile: Profile, blend: float = 0.0, passing_blend: float = 0.0
) -> Motion:
    """The motion of a plan.

    A plan's unit vectors and rotations are so but for the rounding of its file (4e-12). Here they are made exactly so,
    by Gram-Schmidt: that is the motion of which the certificate speaks.

    Args:
        arm: geometry.
        tool: the drill.
        hole: the drill axis; its depth is not examined.
        profile: spin along the path.
        blend: radius of the blend at the corner [m], clipped to half the shorter of the two segments; 0 for none.
        passing_blend: the same at the other inner breakpoints.
    """
    out = scaled(vector(-hole.direction))
    rig = rig_of(arm, tool, hole, out)
    standoff, psi = ([arb(float(x)) for x in values] for values in (profile.standoff, profile.psi))
    tips = [combined((vector(hole.target), arb(1)), (out, s)) for s in standoff]
    segments = []
    for k in range(1, len(tips)):
        corner = k == profile.corner
        segments.append(
            Segment(
                where="on the plunge" if k <= profile.corner else "on the retract",
                bend="in the blended corner" if corner else f"in the blend at breakpoint {k + 1}",
                begin=tips[k - 1],
                end=tips[k],
                rig=rig,
                axis=out,
                angle=(psi[k - 1], psi[k]),
                standoff=(standoff[k - 1], standoff[k]),
                length=abs(standoff[k] - standoff[k - 1]),
                radius=arb(blend if corner else passing_blend),
            )
        )
    return motion_of(segments, 0, profile.corner)


def rig_of(arm: ArmGeometry, tool: Tool, hole: Hole, z: tuple[arb, arb, arb]) -> Rig:
    """Lever and flange at psi = 0; z is the unit vector out of the hole."""
    y = across(vector(hole.psi_zero), z)
    x = cross(y, z)
    in_flange = columns(tool.T_flange_tcp[:3, :3])
    z_tool = scaled(in_flange[2])
    y_tool = across(in_flange[1], z_tool)
    x_tool = cross(y_tool, z_tool)
    a, b, c = (combined((x, x_tool[k]), (y, y_tool[k]), (z, z_tool[k])) for k in range(3))
    tip = vector(tool.T_flange_tcp[:3, 3])
    return Rig(onto((a, b, c), (-tip[0], -tip[1], -tip[2] - arb(arm.c4))), (a, b, c))
