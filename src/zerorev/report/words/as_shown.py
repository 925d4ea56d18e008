"""How a robot's controller counts, in words: what it shows of joint 3, where its base is, its pulses per degree."""

from __future__ import annotations

import numpy as np

from zerorev.model.robot import Robot

__all__ = ["controller_rows", "shown_note", "turning_names", "turning_note"]


def shown_note(robot: Robot) -> str:
    """One sentence beside angles as the controller shows them; empty where these are the joints that turn."""
    if not robot.display.j3_less_j2:
        return ""
    second, third = robot.joint_names[1:3]
    return (
        f"{third} as the controller shows it, against the ground ({third} less {second}); its limits, rates and "
        "reversals are those of the joint that turns"
    )


def turning_note(robot: Robot) -> str:
    """One sentence beside angles of the joints that turn; empty where the controller shows these."""
    if not robot.display.j3_less_j2:
        return ""
    second, third = robot.joint_names[1:3]
    return (
        f"{third} is the joint that turns, against link 2; the controller shows {third} less {second}, its angle "
        "against the ground"
    )


def turning_names(robot: Robot) -> tuple[str, ...]:
    """The names of the joints where the angles of the joints that turn are drawn."""
    first, second, third, *rest = robot.joint_names
    return (first, second, f"{third} against link 2" if robot.display.j3_less_j2 else third, *rest)


def controller_rows(robot: Robot) -> list[tuple[str, str]]:
    """How a robot's controller counts: a heading and a text each; none where it counts as the arm does."""
    rows = []
    if note := turning_note(robot):
        rows.append((f"shown {robot.joint_names[2]}", note))
    if robot.base_in_root is not None:
        x, y, z = (f"{round(each * 1e3, 6) + 0.0:g}" for each in robot.base_in_root[:3])
        angles = ", ".join(f"{round(float(each), 6) + 0.0:g}" for each in np.rad2deg(robot.base_in_root[3:]))
        turned = f", roll pitch yaw ({angles}) deg" if any(robot.base_in_root[3:]) else ""
        rows.append(("base", f"the controller counts from ({x}, {y}, {z}) mm{turned} in the base frame of the arm"))
    if robot.pulses_per_deg is not None:
        counts = zip(robot.joint_names, robot.pulses_per_deg, strict=True)
        rows.append(("pulses per deg", "  ".join(f"{name} {count:.6g}" for name, count in counts)))
    return rows
