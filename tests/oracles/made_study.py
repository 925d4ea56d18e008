"""A study of one hole with numbers that nobody computed."""

from __future__ import annotations

import numpy as np

from zerorev.cell.ensemble import HoleStudy

__all__ = ["made_study"]


def made_study(name: str, sets: int = 4, points: int = 5) -> HoleStudy:
    """Of a baseline and a plan, in the order of 0.1 mm and 0.1 N m.

    Args:
        name: of the hole.
        sets: of parameters.
        points: along the path.
    """
    numbers = np.random.default_rng(0)
    sizes = dict.fromkeys(("deviation", "vertical", "offset", "ovality"), (2, 2, sets))
    sizes |= {"swing": (2, 6, sets), "position": (2, sets), "tilt": (2, sets)}
    figures = {each: 1e-4 * numbers.uniform(0.5, 2.0, size) for each, size in sizes.items()}
    profile, torque = numbers.uniform(0, 2e-4, (2, 2, 3, points)), numbers.normal(size=(2, 6, 3, points))
    figures |= {"profile": np.sort(profile, axis=2), "torque": np.sort(torque, axis=2)}
    path, speed = np.linspace(-1, 1, points), np.array([0.2, 0.1])
    return HoleStudy(name, ("baseline", "plan"), **figures, path=path, speed=speed)
