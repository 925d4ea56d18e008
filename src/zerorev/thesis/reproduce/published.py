"""What the thesis prints, in its own units (mm, deg), each number with the place it is printed at.

Nothing here is ours: no figure of zerorev stands in this file, and what is printed wrongly is kept as printed (the
section on errata says what it should be).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from zerorev.model.hole import Hole
from zerorev.model.profile import Profile

__all__ = [
    "BISECTION_RANGE_MM",
    "BISECTION_RESOLUTION_MM",
    "BISECTION_STEPS",
    "DECREMENT_MM",
    "DEEPEST",
    "MAP_EXAMPLE_RAD",
    "MAP_EXAMPLE_REVERSALS",
    "MODIFIED_DH",
    "POSITIONS",
    "STANDARD_DH",
    "SYMMETRY_MM",
    "TABLE_5",
    "TABLE_5_X_MM",
    "TABLE_5_Y_MM",
    "TABLE_5_Z_MM",
    "TOOL_AS_NEEDED",
    "TOOL_AS_PRINTED",
    "TRIALS",
    "TRIAL_4_PARTICLES_IN_TEXT",
    "ZERO_PARTICLES",
    "Position",
    "Trial",
    "hole_along_x",
]

# Table 1, modified DH: alpha_(i-1) [deg], a_(i-1) [mm], d_i [mm], theta_i [deg]
MODIFIED_DH = (
    (180.0, 0.0, -400.0, 0.0),
    (90.0, 25.0, 0.0, 0.0),
    (0.0, 335.0, 0.0, -90.0),
    (90.0, 25.0, -365.0, 0.0),
    (-90.0, 0.0, 0.0, 0.0),
    (90.0, 0.0, -90.0, 0.0),
)
# Table 2, standard DH: theta_i [deg], d_i [mm], a_i [mm], alpha_i [deg]
STANDARD_DH = (
    (0.0, 0.0, 25.0, 90.0),
    (0.0, 0.0, 335.0, 180.0),
    (-90.0, 0.0, -25.0, 90.0),
    (0.0, -365.0, 0.0, 90.0),
    (0.0, 0.0, 0.0, -90.0),
    (180.0, -90.0, 0.0, 0.0),
)
# eq. 3.10: EEa, EEb [mm] as printed, and the reading that Appendix B needs
TOOL_AS_PRINTED, TOOL_AS_NEEDED = (65.0, 100.0), (100.0, 65.0)


@dataclass(frozen=True)
class Position:
    """One of the three positions at which the thesis drilled (sec. 4.6 and 5.3 to 5.4; Appendix B).

    Attributes:
        name: as the thesis calls it.
        target_mm: base frame; the plunge is along +X.
        depth_mm: stroke.
        psi_deg: spins at start, target and end, to the four digits of Appendix B.
        printed_deg: the spins as the text prints them; it prints none for position 2.
        source: where.
        axis_deg: A1 to A6 at start, target and end (Appendix B).
        turned_deg: rotation about the tool axis during plunge and retract (Appendix B).
        baseline: reversals with constant spin, as the thesis counts them.
    """

    name: str
    target_mm: tuple[float, ...]
    depth_mm: float
    psi_deg: tuple[float, float, float]
    printed_deg: tuple[float, ...]
    source: str
    axis_deg: tuple[tuple[float, ...], ...]
    turned_deg: tuple[float, float]
    baseline: int

    @property
    def hole(self) -> Hole:
        """The hole, in SI."""
        return hole_along_x(self.name, self.target_mm, self.depth_mm)

    @property
    def profile(self) -> Profile:
        """The published motion, in SI."""
        return Profile.straight(self.depth_mm / 1e3, *np.deg2rad(self.psi_deg))


def hole_along_x(name: str, target_mm: tuple[float, ...], depth_mm: float) -> Hole:
    """A hole drilled along +X, as every one of the thesis is, from millimetres."""
    return Hole(name, np.array(target_mm) / 1e3, np.array([1.0, 0.0, 0.0]), depth_mm / 1e3)


POSITIONS = (
    Position(
        "position 1",
        (500, 300, 800),
        50,
        (14.1646, -5.9388, -30.4599),
        (14.16, -5.94, -30.46),
        "sec. 4.4, eq. 5.1, Appendix B",
        (
            (143.1752, -107.9003, -79.0638, 11.3008, 88.3939, 217.3562),
            (141.688, -120.7634, -61.915, -4.6854, 96.3471, 217.943),
            (132.754, -121.5371, -57.5418, -21.63, 110.9973, 223.361),
        ),
        (20.1033, 24.5212),
        6,
    ),
    Position(
        "position 2",
        (200, 400, 600),
        20,
        (180.0, 178.1001, 142.4918),
        (),
        "sec. 5.4.1, Appendix B",
        (
            (-78.6901, -86.9817, 87.6934, 0.0, 89.2884, 101.3099),
            (-75.7884, -87.0847, 87.8145, -0.46682, 87.4284, 104.225),
            (-75.3314, -102.9224, 107.3981, -11.6946, 49.5235, 109.3832),
        ),
        (1.8999, 35.6083),
        4,
    ),
    Position(
        "position 3",
        (200, 200, 1000),
        30,
        (20.2431, -4.5475, -9.6903),
        (20.2431, -4.5475, -9.6903),
        "sec. 5.4.2, eq. 5.3, Appendix B",
        (
            (115.5591, -64.3099, -87.1047, 12.4793, 43.6965, 236.7431),
            (115.223, -75.2295, -81.4464, -2.0503, 70.8028, 245.521),
            (107.2031, -75.6544, -80.8389, -2.9439, 75.7758, 253.7521),
        ),
        (24.7906, 5.1428),
        6,
    ),
)

ZERO_PARTICLES = 40  # of 100, with zero reversals after 50 iterations (sec. 4.4, beside Fig. 11)


@dataclass(frozen=True)
class Trial:
    """One row of Table 3, beside what `zerorev.thesis.swarm.TABLE_3` holds of it, and what the text says of its figure.

    Attributes:
        number: of the trial.
        figure: number of its figure.
        inertia: the scheme as the table prints it.
        verdict: what the text concludes (sec. 4.5).
    """

    number: int
    figure: int
    inertia: str
    verdict: str


_RANDOM = "0.5 + rand()/2"
TRIALS = (
    Trial(1, 12, _RANDOM, "a significant number of particles at zero, no clear clusters of local minima"),
    Trial(2, 13, "0.95 W(t−1), W(0) = 0.7", "most particles failed to converge, some found no valid solution"),
    Trial(3, 14, _RANDOM, "the plurality of particles at zero; taken for all later runs (Table 4)"),
    Trial(4, 15, _RANDOM, "particles either at zero or noticeably trapped at local minima"),
    Trial(5, 16, "1.05 W(t−1), W(0) = 0.1", "no significant benefit over trial 3"),
    Trial(6, 17, _RANDOM, "most particles went straight to the best without much searching"),
    Trial(7, 18, "0.1 + rand()/2", "a significant number at zero, but no large region searched"),
    Trial(8, 19, "0.7 − 0.7 t/50", "not sufficiently converged, only a small number at zero"),
)
TRIAL_4_PARTICLES_IN_TEXT = 25  # sec. 4.5; Table 3 has 50

# target [mm], deepest stroke with zero reversals [mm] as printed, source
DEEPEST = (
    ((500, 300, 800), 90.0, "Table 5, by steps of 5 mm"),
    ((200, 400, 600), 21.9, "sec. 5.4.1, by bisection"),
    ((200, 200, 1000), 32.8, "sec. 5.4.2, by bisection"),
    ((500, 300, 900), 125.0, "sec. 4.6, beside Fig. 23; Table 5 has 120"),
)
BISECTION_RANGE_MM, BISECTION_STEPS, BISECTION_RESOLUTION_MM = (0.0, 200.0), 7.64, 1.0  # eq. 4.9, 4.10
DECREMENT_MM = 5.0  # sec. 4.6, first map

# Table 5: deepest stroke with zero reversals [mm] on the plane X = 500 mm, by steps of 5 mm; a row a Z, a column a Y
TABLE_5_X_MM = 500.0
TABLE_5_Y_MM = (400, 300, 200, 100, 0, -100, -200, -300, -400)
TABLE_5_Z_MM = (1200, 1100, 1000, 900, 800, 700, 600, 500, 400)
TABLE_5 = (
    (0, 0, 0, 0, 0, 0, 0, 0, 0),
    (0, 0, 0, 0, 15, 0, 0, 0, 0),
    (0, 40, 70, 60, 50, 60, 75, 40, 0),
    (75, 120, 85, 65, 45, 70, 95, 120, 70),
    (105, 90, 80, 75, 65, 85, 95, 100, 105),
    (80, 110, 100, 90, 70, 95, 110, 110, 95),
    (60, 45, 35, 25, 30, 30, 30, 40, 70),
    (40, 25, 20, 25, 20, 10, 20, 30, 40),
    (40, 50, 35, 15, 0, 20, 35, 45, 40),
)
SYMMETRY_MM = 10.0  # sec. 4.6: the results of Table 5 "are symmetrical about Y = 0 within ±10 mm"

# sec. 4.7: these spins have so many reversals on the one branch that can run them, and their mirror none that can
MAP_EXAMPLE_RAD, MAP_EXAMPLE_REVERSALS = (-1.0, 0.0, 1.0), 3
