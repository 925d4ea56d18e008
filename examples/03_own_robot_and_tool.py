"""Your own robot and tool, in Python; the same numbers go into two small YAML files (docs/reference/files.md)."""

import numpy as np

import zerorev as zr

# the lengths of Brandstoetter et al. (2014) in metres, and how the controller counts: model = sign * shown - offset
arm = zr.ArmGeometry(
    a1=0.15, a2=-0.11, b=0.0, c1=0.45, c2=0.614, c3=0.64, c4=0.1,
    sign=(1, 1, -1, -1, -1, -1), offset=tuple(np.deg2rad([0, 0, -90, 0, 0, 180])),
)  # fmt: skip
limits = zr.JointLimits(
    lower=np.deg2rad([-170, -90, -175, -180, -135, -360]),
    upper=np.deg2rad([170, 155, 240, 180, 135, 360]),
    speed=np.deg2rad([220, 200, 220, 410, 410, 610]),
)
robot = zr.Robot("mine", arm, limits)
tool = zr.Tool.from_mm_deg((180, 0, 90), (0, -90, 0), name="right-angle drill")  # the drill points along flange +X

for offset in (0.18, 0.09, 0.0):  # the lever of the spin is the tool's offset from the wrist centre
    tool = zr.Tool.from_mm_deg((180, 0, offset * 1e3 - 100), (0, -90, 0))
    plan = zr.plan(robot, tool, zr.Hole("h", target=[0.7, 0.4, 0.6], direction=[1, 0, 0], depth=0.03))
    print(f"e = {plan.wrist_offset * 1e3:5.1f} mm: {plan.score.reversals} reversals")
