"""The three positions of the thesis (chapter 5, Appendix B), in the units in which it prints them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from zerorev.model.hole import Hole
from zerorev.model.profile import Profile


@dataclass(frozen=True)
class Position:
    """A published hole and its motion; spins as in theory §6.

    Attributes:
        name: as the thesis calls it.
        target_mm: base frame; the plunge is along +X.
        depth_mm: stroke.
        psi_deg: spins at start, target, end.
        branch: the branch on which Appendix B's joints lie.
        axis_deg: A1..A6 at start, target, end (Appendix B).
        travel_deg: of the published motion, which reverses no joint (theory §7).
        slowest_deg_per_mm: of its joints, at any point (theory §5).
        baseline: reversals of each joint where the spin is held.
        baseline_travel_deg: its travel (theory §7).
    """

    name: str
    target_mm: tuple[float, ...]
    depth_mm: float
    psi_deg: tuple[float, float, float]
    branch: int
    axis_deg: tuple[tuple[float, ...], ...]
    travel_deg: float
    slowest_deg_per_mm: float
    baseline: tuple[int, ...]
    baseline_travel_deg: float

    @property
    def hole(self) -> Hole:
        return Hole(self.name, np.array(self.target_mm) / 1e3, np.array([1.0, 0.0, 0.0]), self.depth_mm / 1e3)

    @property
    def profile(self) -> Profile:
        return Profile.straight(self.depth_mm / 1e3, *np.deg2rad(self.psi_deg))

    @property
    def held_spin(self) -> Profile:
        """The baseline's profile."""
        return Profile.straight(self.depth_mm / 1e3, *np.deg2rad(self.psi_deg[:1] * 3))


POSITIONS = (
    Position(
        "position 1",
        (500, 300, 800),
        50,
        (14.1646, -5.9388, -30.4599),
        4,
        (
            (143.1752, -107.9003, -79.0638, 11.3008, 88.3939, 217.3562),
            (141.688, -120.7634, -61.915, -4.6854, 96.3471, 217.943),
            (132.754, -121.5371, -57.5418, -21.63, 110.9973, 223.361),
        ),
        107.1,
        0.0018,
        (1, 1, 1, 1, 1, 1),
        52.5,
    ),
    Position(
        "position 2",
        (200, 400, 600),
        20,
        (180, 178.1, 142.49),
        0,
        (
            (-78.6901, -86.9817, 87.6934, 0, 89.2884, 101.3099),
            (-75.7884, -87.0847, 87.8145, -0.46682, 87.4284, 104.225),
            (-75.3314, -102.9224, 107.3981, -11.6946, 49.5235, 109.3832),
        ),
        98.5,
        0.00002,
        (1, 1, 1, 0, 1, 1),
        14.1,
    ),
    Position(
        "position 3",
        (200, 200, 1000),
        30,
        (20.2431, -4.5475, -9.6903),
        4,
        (
            (115.5591, -64.3099, -87.1047, 12.4793, 43.6965, 236.7431),
            (115.223, -75.2295, -81.4464, -2.0503, 70.8028, 245.521),
            (107.2031, -75.6544, -80.8389, -2.9439, 75.7758, 253.7521),
        ),
        90.5,
        0.0008,
        (1, 1, 1, 1, 1, 1),
        57.5,
    ),
)
