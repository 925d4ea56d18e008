"""How deep can a hole be drilled without a reversal? Straight legs, with the default motion threshold and without."""

import zerorev as zr

robot, tool = zr.read_robot("kuka_kr6_r700_2"), zr.read_tool("thesis_drill")
for target in ([0.5, 0.3, 0.8], [0.2, 0.4, 0.6], [0.2, 0.2, 1.0]):
    hole = zr.Hole("h", target=target, direction=[1, 0, 0], depth=0.01)  # the depth itself is not examined
    deepest = [zr.deepest_stroke(robot, tool, hole, zr.Settings(min_rate=rate)) for rate in (zr.Settings.min_rate, 0.0)]
    print(target, "m: {:.1f} mm with the threshold, {:.1f} mm without".format(*(each.depth * 1e3 for each in deepest)))
