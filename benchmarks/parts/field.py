"""Rate fields of the twist plane per pose, beside inverse kinematics alone; before that, the solutions are compared."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from benchmarks import arm_numpy
from benchmarks.cases import Case, positions
from benchmarks.parts import Options
from benchmarks.peers.eaik_arm import Eaik
from benchmarks.peers.opw import Opw
from benchmarks.table import Goal, Section
from benchmarks.timing import in_turns
from zerorev.kernels import field
from zerorev.model._arrays import Array
from zerorev.model.robot import Robot
from zerorev.motion import kinematics
from zerorev.motion.drilling import Drilling

__all__ = ["apart", "run"]

COMPARED = 1_000
SAME = 1e-6  # [rad]
TURN = 0.02  # [s] that each piece of work is timed for in each round
LEAST_SINE = 1e-3  # of A5: nearer to the wrist's singularity angles are known less well than that


FIELDS = "zerorev: both rate fields, `kernels.field.rates`; 4 postures, whose wrist flips share them"


def rate_fields(case: Case, standoff: Array, psi: Array) -> Callable[[int], Any]:
    """Both rate fields on all eight branches, as the product computes them of many points."""
    plane, count = Drilling(case.robot, case.tool, case.hole).plane, standoff.size
    theta_s, theta_psi = np.empty((4, 6, count)), np.empty((4, 6, count))

    def computed(_: int) -> None:
        for posture in range(4):
            field.rates(case.robot.arm, plane, posture, standoff, psi, theta_s[posture], theta_psi[posture])

    return computed


def run(options: Options) -> Section:
    """Compare the solutions, then time."""
    case = positions()[0]
    robot, rng = case.robot, np.random.default_rng(0)
    differences = _differences(robot)
    standoff, psi = rng.uniform(0.0, case.hole.depth, options.poses), rng.uniform(-np.pi, np.pi, options.poses)
    T = kinematics.tcp_pose(case.hole, standoff, psi) @ np.linalg.inv(case.tool.T_flange_tcp)
    opw, eaik = Opw(robot.arm, T), Eaik(robot.arm, T)
    work: dict[str, Callable[[int], Any]] = {
        FIELDS: rate_fields(case, standoff, psi),
        "zerorev: inverse kinematics": lambda _: kinematics.inverse(robot, T),
        "py-opw-kinematics (Rust): inverse kinematics, `batch_inverse`": lambda _: opw.nearest(),
        "py-opw-kinematics (Rust): inverse kinematics, `reach`": lambda _: opw.solutions(),
        "EAIK (C++): inverse kinematics, `IK_batched`": lambda _: eaik.solve(),
        "NumPy, vectorised: inverse kinematics": lambda _: arm_numpy.inverse(robot.arm, T),
    }
    timed = in_turns(work, options.rounds, least=TURN)
    first = timed[FIELDS].median
    per_pose = {
        name: (each.median / options.poses * 1e9, each.least / options.poses * 1e9) for name, each in timed.items()
    }
    return Section(
        name="field",
        title="The rate fields, per pose of the twist plane, all eight branches",
        columns=("work", "median [ns]", "least [ns]", "ratio to the first"),
        rows=[
            (name, f"{per_pose[name][0]:.1f}", f"{per_pose[name][1]:.1f}", f"{each.median / first:.1f}")
            for name, each in timed.items()
        ],
        notes=[
            f"{options.poses:,} poses of position 1 a batch, {options.rounds} rounds, in each of them again and"
            f" again for {TURN * 1e3:.0f} ms. The first row is the kernel on which every search, evaluation and map"
            " rests (`kernels.field.fields`, in blocks of 96 points), its results stored. `reach` returns all eight"
            " solutions, with a smallest singular value of each; `batch_inverse` the one nearest to the pose before."
            " Before anything is timed the sets of solutions are compared, of"
            f" {COMPARED:,} random poses each: greatest difference from zerorev's "
            + ", ".join(f"{value:.1e} rad ({name})" for name, value in differences.items())
            + "."
        ],
        goals=[
            Goal(
                "both rate fields, 8 branches, per (s, psi) pose, by the kernel that plans are made with",
                "opw IK alone 270 ns",
                "",
                f"{per_pose[FIELDS][0]:.1f} ns",
            )
        ],
        failures=[
            f"{name} finds other solutions of the inverse kinematics, {value:.1e} rad apart"
            for name, value in differences.items()
            if not value <= SAME
        ],
        figures={"ns_per_pose_median_least": per_pose, "apart_rad": differences},
    )


def _differences(robot: Robot) -> dict[str, float]:
    """How far the solutions of the peers lie from ours [rad]; infinite where their number differs."""
    joints = np.random.default_rng(1).uniform(robot.limits.lower, robot.limits.upper, (COMPARED, 6))
    T = kinematics.forward(robot, joints[np.abs(np.sin(joints[:, 4])) > LEAST_SINE])
    ours = kinematics.inverse(robot, T)
    theirs = {
        "py-opw-kinematics": Opw(robot.arm, T).solutions(),
        "EAIK": Eaik(robot.arm, T).solutions(),
        "NumPy": arm_numpy.inverse(robot.arm, T),
    }
    return {name: apart(ours, solutions) for name, solutions in theirs.items()}


def apart(ours: Array, theirs: Array) -> float:
    """Greatest distance [rad] from any solution to its nearest of the other side, both (N, 8, 6) in any order."""
    if (np.isnan(ours[..., 0]).sum(axis=1) != np.isnan(theirs[..., 0]).sum(axis=1)).any():
        return float("inf")
    between = np.abs(arm_numpy.wrapped(ours[:, :, None] - theirs[:, None])).max(axis=-1)
    between = np.where(np.isnan(between), np.inf, between)
    there, back = between.min(axis=2)[~np.isnan(ours[..., 0])], between.min(axis=1)[~np.isnan(theirs[..., 0])]
    return float(max(there.max(), back.max()))
