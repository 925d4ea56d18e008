"""One hole: robot, tool and hole in, the best motion out."""

import zerorev as zr

robot, tool = zr.read_robot("kuka_kr6_r700_2"), zr.read_tool("thesis_drill")
hole = zr.Hole("first", target=[0.5, 0.3, 0.8], direction=[1, 0, 0], depth=0.05)  # metres, base frame
plan = zr.plan(robot, tool, hole)
print(plan.baseline.reversals, "reversals at constant spin,", plan.score.reversals, "as planned:", plan.verified.passed)
