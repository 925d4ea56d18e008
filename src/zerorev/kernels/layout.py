"""The NamedTuples that kernels take whole: a hole's twist plane, and the constraints on its legs. SI units."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

__all__ = ["BoundRules", "Breaking", "Constraints", "TwistPlane"]

Array = npt.NDArray[np.float64]
LONGEST_TWIST = 2 * np.pi  # [rad] of one leg


class TwistPlane(NamedTuple):
    """What a kernel needs to know of a hole and a tool (theory §1): plain numbers.

    Attributes:
        target: bottom of the hole [m].
        R_base_tcp0: rotation of the tcp frame at psi = 0, row by row.
        R_tcp_flange: rotation of the flange in the tcp frame, row by row.
        wrist: wrist centre in the tcp frame [m].
    """

    target: tuple[float, ...]
    R_base_tcp0: tuple[float, ...]
    R_tcp_flange: tuple[float, ...]
    wrist: tuple[float, ...]


class Constraints(NamedTuple):
    """What legs have to keep.

    Attributes:
        lower: limits of the joints [rad], shape (6,); infinite ones are not examined. Controller angles, but for the
            bounds on free legs, which take model angles.
        upper: likewise.
        min_rate: of any joint that is to keep its direction [rad/m].
        psi_bound: spins within +- this [rad]; 0: periodic.
        steepest: twist rate [rad/m].
        longest: twist of a leg [rad].
        depth: of the legs, where they have one [m].
        mean_rule: whether `min_rate` is of the mean over a leg.
        turn_inside: whether joints that may reverse may do so within a leg, too.
    """

    lower: Array
    upper: Array
    min_rate: float
    psi_bound: float = 0.0
    steepest: float = np.inf
    longest: float = LONGEST_TWIST
    depth: float = 0.0
    mean_rule: bool = False
    turn_inside: bool = False

    def unlimited(self) -> Constraints:
        """The same without joint limits."""
        return self._replace(lower=np.full(6, -np.inf), upper=np.full(6, np.inf))


class BoundRules(NamedTuple):
    """What pairs of straight legs have to keep in a branch and bound; model angles.

    Attributes:
        depth: of the legs [m].
        min_rate: of a joint that does not reverse [rad/m]; 0: none.
        psi_bound: spins within +- this [rad]; 0: periodic.
        lower: limits of the joints, shape (6,).
        upper: likewise.
        flips: which wrist flips count, shape (2,).
        weights: what a reversal of each joint costs, shape (6,).
        most_cost: what a motion may cost at most.
        least_weight: of any joint.
        samples: at how many stand-offs a box is examined at first: 4, or 8.
        aspect: width of a box in twist as a share of its width in spin, to which slopes are halved.
    """

    depth: float
    min_rate: float
    psi_bound: float
    lower: Array
    upper: Array
    flips: npt.NDArray[np.bool_]
    weights: Array
    most_cost: float
    least_weight: float
    samples: int
    aspect: float = 1.0


class Breaking(NamedTuple):
    """How chips are broken on the way in, and what the joints keep meanwhile.

    Attributes:
        corner: stand-off of the corner [m].
        peck: from one break to the next [m].
        back: by which the tool draws back [m].
        nearest: no break lies further in [m].
        least: rate of any joint [rad/m].
        least_back: likewise of the way back, where there is a choice.
        steepest: twist rate of a way back [rad/m].
        lead: length of a lead-in in which no joint may turn round [m]; 0: none.
        evenly: whether the breaks are spread evenly over the depth, and draw back by as much in sum as they would one
            each peck: a motion that changes smoothly with its depth, whose number of breaks does not matter.
        psi_bound: spins within +- this [rad]; 0: periodic.
        lower: limits of the joints [rad], shape (6,), finite.
        upper: likewise.
    """

    corner: float
    peck: float
    back: float
    nearest: float
    least: float
    least_back: float
    steepest: float
    lead: float
    evenly: bool
    psi_bound: float
    lower: Array
    upper: Array
