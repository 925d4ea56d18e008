"""The robot: an ortho-parallel arm with a spherical wrist, its joints as the controller shows them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, NamedTuple

import numpy as np

from zerorev.errors import InputError
from zerorev.model._arrays import Array, finite, rotation_rpy, transform
from zerorev.model.body import Body
from zerorev.model.dynamics import Dynamics
from zerorev.model.stated import Number, Switch, with_attributes
from zerorev.model.stated import Six as SixNumbers
from zerorev.model.units import DEG, DEG_S, DEG_S2, KG, MM

__all__ = ["LENGTHS", "NIL_RATE", "ArmGeometry", "Display", "JointLimits", "Robot"]

MIDDLE_REACH = 0.7  # [m] of an arm of size 1
NIL_RATE = float(np.deg2rad(1e-6))  # [rad/m] 1e-9 deg/mm, at this size

Six = tuple[float, float, float, float, float, float]


class ArmGeometry(NamedTuple):
    """Seven lengths [m], and how the controller counts the joints; a NamedTuple, so that kernels take it whole.

    The lengths are those of Brandstoetter, Angerer, Hofbaur (2014), fig. 1.
    Model angle q = sign * controller angle - offset; at q = 0 the arm stands straight up.
    """

    a1: Annotated[float, Number("shoulder forward of axis 1", MM, key="a1")]
    a2: Annotated[float, Number("elbow offset", MM, key="a2")]
    b: Annotated[float, Number("lateral offset", MM, key="b")]
    c1: Annotated[float, Number("height of the shoulder", MM, key="c1")]
    c2: Annotated[float, Number("upper arm", MM, key="c2", above=0)]
    c3: Annotated[float, Number("forearm", MM, key="c3")]
    c4: Annotated[float, Number("wrist centre to flange", MM, key="c4")]
    sign: Six
    offset: Six  # [rad]


@dataclass(frozen=True)
class JointLimits:
    """What the joints may do, as the controller counts them; the arrays have shape (6,)."""

    lower: Annotated[Array, SixNumbers("the lower joint limits", DEG)]
    upper: Annotated[Array, SixNumbers("the upper joint limits", DEG)]
    speed: Annotated[Array, SixNumbers("the greatest joint speeds", DEG_S, above=0)]
    acceleration: Annotated[
        Array | None, SixNumbers("the greatest joint accelerations", DEG_S2, above=0, none="guessed for times")
    ] = None

    def __post_init__(self) -> None:
        """Check shapes, finiteness and order."""
        for name in ("lower", "upper", "speed"):
            object.__setattr__(self, name, finite(getattr(self, name), (6,), f"joint limits, {name}"))
        if not (self.lower < self.upper).all():
            raise InputError("a lower joint limit is not below its upper one", accepted="lower < upper for each joint")
        if not (self.speed > 0).all():
            raise InputError("a joint speed is not positive", accepted="speeds above 0")
        if self.acceleration is not None:
            object.__setattr__(self, "acceleration", finite(self.acceleration, (6,), "joint limits, acceleration"))
            if not (self.acceleration > 0).all():
                raise InputError("a joint acceleration is not positive", accepted="accelerations above 0")


@dataclass(frozen=True)
class Display:
    """What the controller shows of the joints where that is not the joint that turns."""

    j3_less_j2: Annotated[
        bool,
        Switch(
            "whether the controller shows joint 3 less joint 2, its angle against the ground (FANUC), and not what "
            "joint 3 turns by against link 2"
        ),
    ] = False


@dataclass(frozen=True)
class Robot:
    """A six-axis robot of the ortho-parallel, spherical-wrist class.

    Attributes:
        name: how jobs call it.
        arm: geometry, signs and offsets.
        limits: joint limits and speeds.
        joint_names: as the controller shows them, e.g. A1..A6.
        manufacturer: who makes it, e.g. KUKA.
        model: the maker's name of it.
        sources: where each group of numbers comes from.
        second_sources: what others say of them.
        caveats: what to know before trusting them.
        dynamics: what the links weigh, or None where that is not known.
        display: what the controller shows of the joints. Limits, rates and reversals are of the joints that turn.
        base_in_root: the base frame from which the controller counts, in the base frame of the arm: x, y, z [m] and
            roll, pitch, yaw [rad]; None where they are one.
        payload: as the maker rates it; where what the links weigh is known, that says it instead (`rated_load`).
        bodies: solids on its links; empty: none is stated, and capsules about its own lines stand for it.
    """

    name: str
    arm: ArmGeometry
    limits: JointLimits
    joint_names: tuple[str, str, str, str, str, str] = ("A1", "A2", "A3", "A4", "A5", "A6")
    manufacturer: str = ""
    model: str = ""
    sources: dict[str, str] = field(default_factory=dict, compare=False)
    second_sources: tuple[str, ...] = field(default=(), compare=False)
    caveats: tuple[str, ...] = field(default=(), compare=False)
    dynamics: Dynamics | None = None
    display: Display = Display()
    pulses_per_deg: Annotated[
        Six | None,
        SixNumbers(
            "pulses of the controller for one degree of each joint that turns, with their signs; none of them 0",
            none="not known",
        ),
    ] = None
    base_in_root: Six | None = None
    bodies: tuple[Body, ...] = ()
    payload: Annotated[float | None, Number("the load that the maker rates it for", KG, above=0, none="not known")] = (
        field(default=None, compare=False)
    )

    @property
    def rated_load(self) -> float | None:
        """The load that the maker rates the arm for [kg], or None: of the robot, or of what its links weigh."""
        return self.payload if self.payload is not None or self.dynamics is None else self.dynamics.payload

    @property
    def wrist_reach(self) -> float:
        """Greatest distance [m] of the wrist centre from axis 1: the arm stretched out level with the shoulder."""
        return float(np.hypot(self.arm.a1 + self.reach, self.arm.b))

    @property
    def T_root_base(self) -> Array:
        """The controller's base frame in the base frame of the arm, shape (4, 4), [m]."""
        x, y, z, *rpy = self.base_in_root or (0.0,) * 6
        return transform(rotation_rpy(*rpy), np.array([x, y, z]))

    def shown(self, joints: Array) -> Array:
        """What the controller shows of the joints, as a new array.

        Args:
            joints: that turn [rad], shape (..., 6).
        """
        shown = np.array(joints, dtype=np.float64)
        if self.display.j3_less_j2:
            shown[..., 2] -= shown[..., 1]
        return shown

    def from_shown(self, shown: Array) -> Array:
        """The joints that turn, as a new array: the inverse of `shown`.

        Args:
            shown: what the controller shows of them [rad], shape (..., 6).
        """
        joints = np.array(shown, dtype=np.float64)
        if self.display.j3_less_j2:
            joints[..., 2] += joints[..., 1]
        return joints

    def bend(self, joints: Array) -> Array:
        """By how much joint 5 is bent from a straight wrist, as the controller counts it [rad], shape (...,).

        Args:
            joints: that turn [rad], shape (..., 6).
        """
        return np.asarray(joints[..., 4] - self.arm.sign[4] * self.arm.offset[4])

    def allowed(self, margin: float) -> JointLimits:
        """The joint limits with room kept at both ends; without any, the limits themselves.

        Args:
            margin: the room [rad], 0 or more.

        Raises:
            InputError: it leaves a joint nothing.
        """
        limits = self.limits
        if margin == 0:
            return limits
        width = (limits.upper - limits.lower) / 2
        if not (margin < width).all():
            joint = int(np.argmin(width))
            most = np.rad2deg(width[joint])
            raise InputError(
                f"{np.rad2deg(margin):g} deg at both ends leave {self.joint_names[joint]} no way to move",
                where="limit_margin_deg",
                accepted=f"less than {most:g}, half of its {2 * most:g} deg",
            )
        return replace(limits, lower=limits.lower + margin, upper=limits.upper - margin)

    @property
    def reach(self) -> float:
        """Length of the stretched arm, from the shoulder to the wrist centre [m]: the size of the robot."""
        return float(self.arm.c2 + np.hypot(self.arm.a2, self.arm.c3))

    @property
    def size(self) -> float:
        """The power of two next to the reach in 0.7 m: what a tolerance in metres, made for 0.7 m, is multiplied by.

        It is 1 for an arm of 0.5 to 1 m. A power of two changes no digit of what it multiplies.
        """
        return float(2.0 ** round(float(np.log2(self.reach / MIDDLE_REACH))))

    @property
    def nil_rate(self) -> float:
        """The rate up to which a joint does not move [rad/m]: 1e-9 deg/mm for an arm of 0.5 to 1 m (signature)."""
        return NIL_RATE / self.size

    def __post_init__(self) -> None:
        """Check the arm's numbers."""
        arm = self.arm
        lengths = finite(arm[:7], (7,), f"robot {self.name}, geometry")
        if min(arm.c2, np.hypot(arm.c3, arm.a2)) <= 0:
            raise InputError(
                "the upper arm or the forearm has no length",
                where=f"robot {self.name}, geometry",
                accepted="c2 > 0 and c3 or a2 other than 0",
            )
        if any(abs(s) != 1 for s in arm.sign):
            raise InputError("a joint sign is neither 1 nor -1", where=f"robot {self.name}", accepted="1 or -1")
        offset = finite(arm.offset, (6,), f"robot {self.name}, offset")
        # plain floats throughout: an int would be another type, and another compilation, to the kernels
        a1, a2, b, c1, c2, c3, c4 = map(float, lengths)
        object.__setattr__(self, "arm", ArmGeometry(a1, a2, b, c1, c2, c3, c4, six(arm.sign), six(offset)))
        self._check_controller()

    def _check_controller(self) -> None:
        """Check how the controller counts."""
        if self.display.j3_less_j2 and self.arm.sign[1] == self.arm.sign[2]:
            raise InputError(
                "joints 2 and 3 have the same sign, so that joint 3 less joint 2 is not an angle against the ground",
                where="display.j3_less_j2",
                accepted="joints.sign of joint 2 other than that of joint 3, or false",
            )
        if self.pulses_per_deg is not None:
            pulses = finite(self.pulses_per_deg, (6,), "pulses_per_deg")
            for name, count in zip(self.joint_names, pulses, strict=True):
                if count == 0:
                    raise InputError(f"is 0 for {name}", where="pulses_per_deg", accepted="six numbers, none of them 0")
            object.__setattr__(self, "pulses_per_deg", six(pulses))
        if self.base_in_root is not None:
            base = six(finite(self.base_in_root, (6,), "base_in_root"))
            object.__setattr__(self, "base_in_root", base if any(base) else None)


def six(values: Array | Sequence[float]) -> Six:
    """Six plain floats."""
    a, b, c, d, e, f = map(float, values)
    return (a, b, c, d, e, f)


LENGTHS = ArmGeometry._fields[:7]

for _noun in (ArmGeometry, JointLimits, Display, Robot):
    _noun.__doc__ = with_attributes(_noun)
