"""The hole that a free tip leaves, section by section and circle by circle; nothing of ours."""

from __future__ import annotations

import numpy as np

__all__ = ["centres", "drilled_hole", "longer_than_wide", "out_of_round"]

TURNED = np.linspace(0.0, np.pi, 721)


def drilled_hole(standoff, across, sections):
    """Mean centre, its line's slope across the axis [rad], and how far the two centres are apart at each section.

    Args:
        standoff: of the samples, falling to the turn and rising from it [m], shape (N,).
        across: where the tip is, across the axis [m], shape (N, K).
        sections: stand-off of the sections [m].
    """
    down, up = centres(standoff, across, sections)
    slopes = [np.polyfit(sections, down[:, k], 1)[0] for k in range(down.shape[1])]
    return np.linalg.norm(np.mean(down, axis=0)), np.arctan(np.linalg.norm(slopes)), np.linalg.norm(up - down, axis=1)


def centres(standoff, across, sections):
    """Where the tip crosses each section on its way down, and on its way up, each (len(sections), K)."""
    turn = int(np.argmin(standoff))
    down = [_crossing(standoff, across, z, range(turn - 1, -1, -1)) for z in sections]
    up = [_crossing(standoff, across, z, range(turn, len(standoff) - 1)) for z in sections]
    return np.array(down), np.array(up)


def longer_than_wide(one, other, radius):
    """Greatest less least width of the union of two circles, over all ways to hold a calliper."""
    rim = radius * np.stack([np.cos(2 * TURNED), np.sin(2 * TURNED)], axis=1)
    points = np.concatenate([one + rim, other + rim])
    widths = np.ptp(points @ np.stack([np.cos(TURNED), np.sin(TURNED)]), axis=0)
    return widths.max() - widths.min()


def out_of_round(one, other, radius):
    """Greatest less least radius of the rim of that union about the middle of the two centres."""
    way = np.stack([np.cos(2 * TURNED), np.sin(2 * TURNED)], axis=1)
    middle = (one + other) / 2
    reach = []
    for centre in (one - middle, other - middle):
        along = way @ centre
        reach.append(along + np.sqrt(along**2 + radius**2 - centre @ centre))
    rim = np.max(reach, axis=0)
    return rim.max() - rim.min()


def _crossing(standoff, across, z, order):
    """The place at the crossing of a stand-off that is nearest to the turn."""
    for n in order:
        low, high = sorted((standoff[n], standoff[n + 1]))
        if low <= z <= high and high > low:
            share = (z - standoff[n]) / (standoff[n + 1] - standoff[n])
            return across[n] + share * (across[n + 1] - across[n])
    raise AssertionError(f"no crossing of {z}")
