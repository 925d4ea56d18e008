"""Masses and drives of an arm: what its links and its tool weigh, and what its drives are guessed to be like."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
import numpy.typing as npt

from zerorev.errors import InputError
from zerorev.model._arrays import Array, finite, is_rigid
from zerorev.model.stated import Number, Six, with_attributes
from zerorev.model.stated_arrays import Tensor, Three
from zerorev.model.stated_figures import Text
from zerorev.model.units import KG, KG_M2, MM, NM

__all__ = ["Drives", "Dynamics", "Link", "Load", "nominal_drives"]

ABOUT_THE_CENTRE = "xx, xy, xz, yy, yz, zz about the centre of mass"
ARCMIN = float(np.deg2rad(1 / 60))
ROUNDING = 1e-6  # of the moments of inertia, which files round


@dataclass(frozen=True)
class Link:
    """A link of an arm as a rigid body.

    Attributes:
        T_base_link: the link's frame in the base frame where all controller angles are 0, shape (4, 4), [m].
    """

    mass: Annotated[float, Number("", KG, above=0)]
    com: Annotated[Array, Three("the centre of mass in the link's frame", MM)]
    inertia: Annotated[Array, Tensor(f"{ABOUT_THE_CENTRE}; axes of the link's frame", KG_M2)]
    T_base_link: Array

    def __post_init__(self) -> None:
        """Check that it is a body."""
        _check_mass(self.mass)
        object.__setattr__(self, "com", finite(self.com, (3,), "com_mm"))
        object.__setattr__(self, "inertia", _inertia(self.inertia))
        T = finite(self.T_base_link, (4, 4), "frame")
        if not is_rigid(T):
            raise InputError("not a rotation and a translation", where="frame")
        object.__setattr__(self, "T_base_link", T)


@dataclass(frozen=True)
class Load:
    """What hangs on the flange as a rigid body."""

    mass: Annotated[float, Number("what the tool weighs", KG, above=0)]
    com: Annotated[Array, Three("its centre of mass in the flange frame, beside mass_kg", MM)]
    inertia: Annotated[
        Array,
        Tensor(f"{ABOUT_THE_CENTRE}; axes of the flange frame; left out, the mass is taken for a point", KG_M2),
    ]

    def __post_init__(self) -> None:
        """Check that it is a body; one without an inertia of its own is a point."""
        _check_mass(self.mass)
        object.__setattr__(self, "com", finite(self.com, (3,), "com_mm"))
        inertia = finite(self.inertia, (3, 3), "inertia_kgm2")
        object.__setattr__(self, "inertia", _inertia(inertia) if inertia.any() else inertia)


@dataclass(frozen=True)
class Dynamics:
    """What the links of an arm weigh.

    Attributes:
        links: the six that move, from the base outwards.
    """

    links: tuple[Link, Link, Link, Link, Link, Link]
    payload: Annotated[float, Number("the rated load, from which the drives are guessed", KG, above=0)]
    effort_limit: Annotated[Array | None, Six("the greatest torque of each joint", NM, above=0, none="not known")] = (
        None
    )
    source: Annotated[str, Text("where the numbers come from")] = ""

    def __post_init__(self) -> None:
        """Check the numbers."""
        if not 0 < self.payload < np.inf:
            raise InputError("the payload is not above 0", where="payload_kg", accepted="a number above 0 [kg]")
        if self.effort_limit is not None:
            limit = finite(self.effort_limit, (6,), "effort_limit_nm")
            if not (limit > 0).all():
                raise InputError("a torque is not above 0", where="effort_limit_nm", accepted="six numbers above 0")
            object.__setattr__(self, "effort_limit", limit)


@dataclass(frozen=True)
class Drives:
    """The drives of an arm, all on the side of the joint.

    Attributes:
        coulomb: dry friction [N m], shape (6,).
        viscous: friction by speed [N m s/rad], shape (6,).
        inertia: of the rotors, times the gear ratio squared [kg m^2], shape (6,).
        stiffness: of the gears [N m/rad], shape (6,).
        lost_motion: width of the gap between the flanks of the gears [rad], shape (6,).
    """

    coulomb: Array
    viscous: Array
    inertia: Array
    stiffness: Array
    lost_motion: Array


# Two arms whose drives were measured: payload [kg], dry friction [N m], viscous friction [N m s/rad], inertia [kg m^2].
# Staubli TX40: github TUM-ICS/BIRDy TX40.m @ 3d8f2dce3a. Manutec r3: modelica/ModelicaStandardLibrary, the example
# RobotR3 (Tuerk 1990, Otter 1995), from the motor's to the joint's side by its gear ratios; its viscous friction of
# joint 5 (0.03) is an outlier, and that of the TX40 stands in its place.
_TX40 = (
    2.0,
    (6.9822, 7.8301, 6.1939, 2.4063, 3.4092, 1.8313),
    (7.9379, 5.6948, 1.9804, 1.1141, 1.6, 0.6894),
    (0.362, 0.507, 0.0829, 0.0341, 0.0361, 0.0114),
)
_R3 = (
    15.0,
    (42.0, 105.0, 42.0, 21.8, 30.1, 10.9),
    (8.9578125, 33.923077, 5.5384615, 9.8, 1.6, 3.92),
    (14.3325, 57.33, 4.68, 1.56816, 1.1290752, 0.421443),
)
_STIFFNESS = (6.0, (1.2e5, 1.2e5, 6e4, 1.5e4, 1.5e4, 1.5e4))  # no source: for 6 kg, in proportion to the payload
_LOST_MOTION = ARCMIN  # servo gears are sold with 1 to 3 arcmin


def nominal_drives(payload: float) -> Drives:
    """A guess with a rule: between two measured arms by the payload, in logarithms. To be varied, never a fact.

    Friction and inertia follow the rule; of stiffness and lost motion there is no source.

    Args:
        payload: rated load of the arm [kg].
    """
    share = np.log(payload / _TX40[0]) / np.log(_R3[0] / _TX40[0])
    coulomb, viscous, inertia = (
        np.exp((1 - share) * np.log(small) + share * np.log(large))
        for small, large in zip(_TX40[1:], _R3[1:], strict=True)
    )
    stiffness = np.array(_STIFFNESS[1]) * payload / _STIFFNESS[0]
    return Drives(coulomb, viscous, inertia, stiffness, np.full(6, _LOST_MOTION))


def _check_mass(mass: float) -> None:
    if not 0 < mass < np.inf:
        raise InputError("a mass that is not above 0", where="mass_kg", accepted="a number above 0 [kg]")


def _inertia(value: npt.ArrayLike) -> Array:
    """An inertia tensor [kg m^2], shape (3, 3).

    Raises:
        InputError: one that no body has.
    """
    inertia = finite(value, (3, 3), "inertia_kgm2")
    principal = np.linalg.eigvalsh(inertia)
    if principal[0] <= 0 or principal[0] + principal[1] < principal[2] * (1 - ROUNDING):
        moments = ", ".join(f"{moment:.4g}" for moment in principal)
        raise InputError(
            f"the inertia of no body: its principal moments are {moments} kg m^2",
            where="inertia_kgm2",
            accepted="moments above 0, none greater than the sum of the other two",
        )
    return inertia


for _noun in (Link, Load, Dynamics):
    _noun.__doc__ = with_attributes(_noun)
