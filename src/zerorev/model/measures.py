"""What a motion is judged by beside its reversals: each criterion is stated here, once.

Its figure of a motion is computed in `zerorev.motion.criteria`, and once more, in another way, in
`zerorev.verify.figures`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Generic, TypeVar

from zerorev.model.stated import stated, with_attributes
from zerorev.model.stated_figures import Figure
from zerorev.model.units import DEG, DEG_PER_MM, MM, RPM, UM_PER_N

if TYPE_CHECKING:
    from zerorev.model._arrays import Array

__all__ = ["CRITERIA", "Criterion", "Measures", "V", "criteria"]

V = TypeVar("V", float, "Array")


@dataclass(frozen=True, kw_only=True)
class Criterion(Figure):
    """A figure of a motion that can be weighed: a cost of about 0 for the best and about 1 for a poor motion.

    Attributes:
        weighs: what is weighed, as in `weight of the joint travel`.
        scale: the figure [SI] that costs 1, or, where more is better, that costs nothing.
        more_is_better: whether the cost is 1 less the figure's share of the scale.
        needs_stiffness: whether it takes the stiffness of the joints.
        needs_dynamics: whether it takes the masses of the robot.
        cost: the cost in words, for the table.
        absolute: how far the figure of a file may be from the one that the check computes, in the unit outside.
    """

    null: object = math.nan
    weighs: str
    scale: float = 1.0
    more_is_better: bool = False
    needs_stiffness: bool = False
    needs_dynamics: bool = False
    cost: str
    absolute: float = 1e-12

    def __call__(self, motion: Measures[V]) -> V:
        """Cost of the motion, or of each of many."""
        figure: V = getattr(motion, self.name)
        return self.cost_of(figure)

    def cost_of(self, figure: V) -> V:
        """Cost of a figure, or of each of many."""
        share = figure / self.scale
        return 1 - share if self.more_is_better else share


@dataclass(frozen=True)
class Measures(Generic[V]):
    """What the criteria measure of a motion beside its reversals; or of many motions, in arrays of one shape."""

    travel: Annotated[
        V,
        Criterion(
            "sum over the joints of the angle moved",
            DEG,
            weighs="the joint travel",
            label="joint travel",
            scale=12 * math.pi,
            cost="joint travel, in six full turns (2160°), as in thesis eq. 4.7",
            absolute=1e-8,
        ),
    ]
    margin: Annotated[
        V,
        Criterion(
            "slowest motion of a joint that does not reverse, by min_rate_rule",
            DEG_PER_MM,
            weighs="the slowest joint",
            label="slowest joint",
            scale=math.radians(100.0),
            more_is_better=True,
            cost="1 − slowest motion / 0.1 °/mm, by `min_rate_rule`",
            absolute=1e-13,
        ),
    ]
    plunge_rotation: Annotated[
        V,
        Criterion(
            "spin of the tool during the plunge",
            DEG,
            weighs="the tool's spin during the plunge",
            label="spin in the plunge",
            scale=math.pi,
            cost="spin of the tool during the plunge, in half turns",
            absolute=1e-8,
        ),
    ]
    tool_speed_change: Annotated[
        V,
        Criterion(
            "greatest change of the drill's speed by the spin during the plunge",
            RPM,
            weighs="the change of the drill's speed by the spin",
            label="change of drill speed",
            scale=math.pi / 3,
            cost="greatest change of the drill's speed by the spin, at the plunge feed, in 10 rev/min (thesis eq. 5.4)",
            absolute=1e-11,
        ),
    ]
    limit_distance: Annotated[
        V,
        Criterion(
            "least distance of a joint to a limit, 0 at it, 1 in the middle of its range",
            weighs="the distance to the joint limits",
            label="nearness to limits",
            more_is_better=True,
            cost="1 at a joint limit, 0 where all joints stay in the middle of their ranges",
            absolute=1e-10,
        ),
    ]
    compliance_axial: Annotated[
        V,
        Criterion(
            "greatest give of the tip along the drill axis",
            UM_PER_N,
            none="no joint stiffness is given",
            weighs="the give along the drill axis",
            label="give along the axis",
            scale=10e-6,
            needs_stiffness=True,
            cost="greatest give of the tip along the drill axis, in 10 µm/N",
        ),
    ]
    compliance_lateral: Annotated[
        V,
        Criterion(
            "greatest give of the tip across the drill axis",
            UM_PER_N,
            none="no joint stiffness is given",
            weighs="the give across the drill axis",
            label="give across the axis",
            scale=10e-6,
            needs_stiffness=True,
            cost="greatest give of the tip across the drill axis, the way it gives most, in 10 µm/N",
        ),
    ]
    manipulability: Annotated[
        V,
        Criterion(
            "least manipulability, 0 where the arm is singular, always below 1",
            weighs="the distance from singular postures",
            label="nearness to singularity",
            more_is_better=True,
            cost="1 − least manipulability; 1 where the arm is singular",
        ),
    ]
    lost_motion: Annotated[
        V,
        Criterion(
            "greatest deviation of the tip across the axis that the gears are predicted to cause",
            MM,
            none="the robot's masses are not known",
            weighs="the predicted lost motion at the tip",
            label="lost motion",
            scale=50e-6,
            needs_dynamics=True,
            added=True,
            cost="predicted lost motion at the tip, in 50 µm (theory §9)",
            absolute=1e-9,
        ),
    ]


Measures.__doc__ = with_attributes(Measures)


def criteria(noun: type[Any]) -> dict[str, Criterion]:
    """The criteria that are stated in a noun, by name."""
    return {each.name: each for each in stated(noun) if isinstance(each, Criterion)}


CRITERIA = criteria(Measures)
"""The criteria by the names that a job file gives them."""
