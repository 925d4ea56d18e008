"""The job: a robot, a tool, holes, and how they are to be drilled."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array, finite, is_rigid
from zerorev.model.hole import Hole
from zerorev.model.robot import Robot
from zerorev.model.tool import Tool

__all__ = ["CRITERIA", "Job", "Settings", "Weights"]

Objective = Literal["travel", "margin", "plunge_rotation"]
CRITERIA = (
    "travel", "margin", "plunge_rotation", "tool_speed_change", "limit_distance",
    "compliance_axial", "compliance_lateral", "manipulability",
)  # fmt: skip
NEED_STIFFNESS = ("compliance_axial", "compliance_lateral")
Weights = tuple[tuple[str, float], ...]
Legs = Literal["straight", "free"]


@dataclass(frozen=True)
class Settings:
    """How to plan and how to run the motion.

    Attributes:
        min_rate: motion threshold [rad/m]; every joint moves at least so much per metre of path; 0 switches it off
            (thesis sec. 4.3, theory §5).
        min_rate_rule: `pointwise` (at every point) or `mean` (on the average over each leg).
        psi_bound: spins within +- this [rad], or None for a periodic spin.
        legs: `straight` (spin linear along each leg) or `free` (spin varying freely along it; theory §4).
        max_twist: greatest twist rate |d psi / d s| of free legs [rad/m].
        objective: among plans of equal reversals that keep the threshold: least `travel`, greatest `margin` (slowest
            joint), or least `plunge_rotation`.
        weights: pairs of a criterion and its weight, whose weighted sum is to be least instead of the objective
            (`zerorev.motion.criteria`); none: the objective decides.
        joint_stiffness: of each joint [N m/rad], shape (6,), for the compliance at the tip; None: unknown.
        reversal_weights: what a reversal of each joint costs, shape (6,), each above 0.
        near_joints: joint angles [rad], shape (6,), to which free turns are chosen nearest; None: the turns farthest
            from the limits.
        blend: radius of the blend at the corner [m]; 0 stops exactly there.
        blend_shortfall: depth lost to the blend [m], as measured on the controller; None: half the radius.
        deepen_corner: place the corner deeper by the shortfall, so that the true depth is met.
        lead_in: length [m] run along the plunge leg before the drill enters.
        keep_lead_in: only motions count whose whole lead-in runs without a reversal; else it is shortened where it
            cannot, with a finding.
        feed_plunge: feed of the plunge [m/s].
        feed_retract: feed of the retract [m/s].
        spindle_rpm: speed of the spindle [rev/min], or None where the program need not know it.
        proof_boxes: how many boxes of legs a proof of the optimum, or of the deepest stroke, may examine, or where legs
            are free twice as many cells of the twist plane; 0: no proof.
    """

    min_rate: float = float(np.deg2rad(10.0))
    min_rate_rule: Literal["pointwise", "mean"] = "pointwise"
    psi_bound: float | None = None
    legs: Legs = "straight"
    max_twist: float = float(np.deg2rad(5e3))
    objective: Objective = "travel"
    weights: Weights = ()
    joint_stiffness: tuple[float, ...] | None = None
    reversal_weights: tuple[float, ...] = (1.0,) * 6
    near_joints: tuple[float, ...] | None = None
    blend: float = 1e-3
    blend_shortfall: float | None = None
    deepen_corner: bool = False
    lead_in: float = 5e-3
    keep_lead_in: bool = False
    feed_plunge: float = 5e-3
    feed_retract: float = 20e-3
    spindle_rpm: float | None = None
    proof_boxes: int = 100_000

    def __post_init__(self) -> None:
        """Check ranges."""
        for name in ("min_rate", "blend", "lead_in"):
            _check(getattr(self, name) >= 0, name, "0 or more")
        for name in ("max_twist", "feed_plunge", "feed_retract"):
            _check(getattr(self, name) > 0, name, "above 0")
        if self.psi_bound is not None:
            _check(self.psi_bound > 0, "psi_bound", "above 0, or none for a periodic spin")
        if self.blend_shortfall is not None:
            _check(0 <= self.blend_shortfall <= self.blend, "blend_shortfall", "0 to the blend radius")
        _check(self.proof_boxes >= 0, "proof_boxes", "0 or more")
        if self.spindle_rpm is not None:
            _check(self.spindle_rpm > 0, "spindle_rpm", "above 0, or none")
        _check(
            len(self.reversal_weights) == 6 and all(w > 0 for w in self.reversal_weights),
            "reversal_weights",
            "six numbers above 0",
        )
        if self.joint_stiffness is not None:
            stiff = len(self.joint_stiffness) == 6 and all(0 < k < np.inf for k in self.joint_stiffness)
            _check(stiff, "joint_stiffness", "six numbers above 0")
        self._check_weights()
        if self.near_joints is not None:
            _check(len(self.near_joints) == 6, "near_joints", "six angles")

    def _check_weights(self) -> None:
        weights = dict(self.weights)
        known = len(weights) == len(self.weights) and set(weights) <= set(CRITERIA)
        _check(known, "objective", f"each once: {', '.join(CRITERIA)}")
        _check(all(0 < weight < np.inf for weight in weights.values()), "objective", "weights above 0")
        lacking = [name for name in weights if name in NEED_STIFFNESS and self.joint_stiffness is None]
        if lacking:
            raise InputError(
                f"{lacking[0]} needs the stiffness of the joints, which is not given",
                where="objective",
                accepted="joint_stiffness_nm_per_rad beside it, six numbers above 0 [N m/rad]",
            )

    @property
    def without_proof(self) -> Settings:
        """The same without the proof of the optimum, for those who ask of very many places."""
        return replace(self, proof_boxes=0)

    @property
    def passing_blend(self) -> float:
        """Radius of the blend [m] at inner points other than the corner.

        Where the job asks for an exact stop at the corner, it is 1 mm all the same: a stop within a leg would put every
        joint at rest with the drill in the material.
        """
        return self.blend or 1e-3

    @property
    def shortfall(self) -> float:
        """Depth lost to the blend [m]: as measured, or half the radius of a parabolic blend (theory §5)."""
        return self.blend / 2 if self.blend_shortfall is None else self.blend_shortfall

    @property
    def corner(self) -> float:
        """Stand-off of the programmed corner [m]: 0, or below 0 where it is placed deeper."""
        return -self.shortfall if self.deepen_corner else 0.0


def _check(ok: bool, name: str, accepted: str) -> None:
    if not ok:  # also for NaN, of which no comparison is true
        raise InputError("out of range", where=name, accepted=accepted)


@dataclass(frozen=True)
class Job:
    """Everything that planning needs.

    Attributes:
        robot: the arm.
        tool: the drill on its flange.
        holes: what to drill, base frame.
        settings: how.
        T_base_part: part frame, shape (4, 4), translation [m].
        name: of the job; names the program.
        psi_reference: what the spins of all holes are counted from where the part is moved: one of
            `zerorev.model.hole.REFERENCES`, or a vector in the part frame; None: their own `psi_zero` moves with it.
    """

    robot: Robot
    tool: Tool
    holes: tuple[Hole, ...]
    settings: Settings = field(default_factory=Settings)
    T_base_part: Array = field(default_factory=lambda: np.eye(4))
    name: str = "job"
    psi_reference: str | tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        """Check that there are holes and that their ids differ."""
        T = finite(self.T_base_part, (4, 4), "part_frame")
        if not is_rigid(T):
            raise InputError("not a rotation and a translation", where="part_frame")
        object.__setattr__(self, "T_base_part", T)
        if not self.holes:
            raise InputError("no holes", where="holes", accepted="one hole or more")
        seen: set[str] = set()
        for hole in self.holes:
            if hole.id in seen:
                raise InputError(f"the id '{hole.id}' is used twice", where="holes", accepted="ids that differ")
            seen.add(hole.id)
