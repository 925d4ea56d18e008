"""How `zerorev check` treats each field of a plan file: as an input, as a figure that it computes again, or not at all.

A field that is added to the file has to be added here; a test walks the schema and finds those that are missing.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from zerorev.model.measures import CRITERIA, Criterion
from zerorev.model.units import DEG_PER_MM

__all__ = ["HEAD_FIELDS", "HOLE_FIELDS", "Field", "field_of"]

How = Literal["input", "motion", "figure", "search", "finding", "check", "not recomputed"]


class Field(NamedTuple):
    """What is done with a field, and how near a number that is stated has to be to the one that is found.

    Attributes:
        how: `input`, what everything else is computed from; `motion`, followed and held by `verify.check`; `figure`,
            computed by `verify.figures`; `search`, found by searching again; `finding`, what has to be said of the
            answer; `check`, the outcome of the check itself; `not recomputed`, and the field's description says so.
        relative: of the number.
        absolute: in the unit of the file.
        optional: whether null claims nothing, so that it is not held against what is found.
        nil: in the unit of the file, on an arm of size 1: at this and below it a joint is at rest, and has no rate.
    """

    how: How
    relative: float = 0.0
    absolute: float = 0.0
    optional: bool = False
    nil: float = 0.0


# the digits of a file, and of the two ways in which a figure is computed
DIGITS = 1e-9
CLEARANCE = 0.02  # [mm]: it is found to 0.01 mm
WAY = ("lead_in", "approach", "retract")  # that a clearance covers
ANYWHERE = 1e6  # [mm]: where a distance is the least along a whole leg, nothing says where on it that is
# of the least rate: planning narrows a dip down until it falls by less than 1e-6 of the rate between samples
DIP = 2e-6
# [deg/mm] on an arm of size 1: a joint that is slower than half of this does not move (conventions: signature)
AT_REST = 2e-9
# of the deepest stroke: so much of it the search keeps back, and its steps end below it
DEEPEST = 1e-5

# of a bound on the travel: where a search stops depends a little on the last digits of what it starts from
BOUND = 1e-4

_ANGLE = Field("figure", DIGITS, 1e-8)  # [deg]
_RATE = Field("figure", DIGITS, 1e-13)  # [deg/mm]
_SLOWEST = _RATE._replace(relative=DIP, nil=AT_REST)
_EXACT = Field("figure")


def _criterion(criterion: Criterion) -> Field:
    # of a least rate, what the least rates of the joints are
    return _SLOWEST if criterion.unit is DEG_PER_MM else Field("figure", DIGITS, criterion.absolute, criterion.added)


_CORNER = {
    "corner": Field("figure", optional=True),
    "corner.kind": _EXACT,
    "corner.shortfall_mm": Field("figure", DIGITS, 1e-9),
    "corner.interval_mm": Field("figure", DIGITS, 1e-9),
    "corner.law": _EXACT,
    "corner.reach_mm": Field("figure", DIGITS, 1e-6),  # it is cut where a tolerance is met
    "corner.off_axis_mm": Field("figure", 1e-4, 1e-8),
    "corner.tilt_deg": Field("figure", 1e-4, 1e-8),
    "corner.dwell_s": Field("figure", DIGITS, 1e-9, optional=True),
    "corner.spin_deg": Field("figure", DIGITS, 1e-8, optional=True),
    "corner.spin_moves": Field("figure", optional=True),
}


HEAD_FIELDS: dict[str, Field] = {
    "format": Field("input"),
    "name": Field("input"),
    "robot": Field("input"),
    "tool": Field("input"),
    "part_frame": Field("input"),
    "settings": Field("input"),
    "surroundings": Field("input"),
    "order": Field("input"),
    "transitions": _EXACT,
    "transitions.from": _EXACT,
    "transitions.to": _EXACT,
    "transitions.joints_deg": Field("figure", DIGITS, 1e-5),  # a lead-in is cut where a search ends
    "transitions.time_s": Field("figure", DIGITS, 1e-6),
    "transitions.changes_posture": _EXACT,
    "transitions.largest_axis_move_deg": Field("figure", DIGITS, 1e-5),
    "transitions.clearance_mm": Field("figure", DIGITS, CLEARANCE, optional=True),
    "transitions.around": Field("figure", optional=True),
    "transitions.around.least_mm": Field("figure", DIGITS, CLEARANCE),
    "transitions.around.standoff_mm": _EXACT,
    "transitions.around.between": _EXACT,
    "transitions.around.certified": _EXACT,
    **{f"transitions.around.{part}_mm": _EXACT for part in WAY},
    "transitions.findings": Field("finding"),
    "cycle_time_s": Field("figure", DIGITS, 1e-6),
    "findings": Field("finding"),
    "tools": Field("input"),  # each is checked as a plan of its own
}
"""By the path of a field in a file; an input and a finding stand for all below them."""

HOLE_FIELDS: dict[str, Field] = {
    "id": Field("input"),
    "group": Field("input"),
    "target_mm": Field("input"),
    "direction": Field("input"),
    "depth_mm": Field("input"),
    "psi_zero": Field("input"),
    "given": Field("input"),
    "cycle": Field("input"),
    "deepest_mm": Field("search", DEEPEST, 1e-9, optional=True),
    "deepest_at_most_mm": Field("search", BOUND, 1e-9, optional=True),
    "status": Field("search"),
    "branch": Field("motion"),
    "standoff_mm": Field("motion"),
    "psi_deg": Field("motion"),
    "joints_deg.start": Field("motion"),
    "joints_deg.target": Field("motion"),
    "joints_deg.end": Field("motion"),
    "joints_deg.breakpoints": Field("motion"),
    "reversals": _EXACT,
    "reversals_per_joint": _EXACT,
    "events": _EXACT,
    "events.joint": _EXACT,
    "events.leg": _EXACT,
    "events.standoff_mm": Field("figure", DIGITS, 1e-8),
    "travel_deg": _ANGLE,
    "min_rate_deg_per_mm": _SLOWEST,
    "mean_rate_deg_per_mm": _RATE,
    "limit_distance_deg": _ANGLE,
    "critical_rates_deg_per_mm": _RATE._replace(optional=True),
    "twist_spread_deg_per_mm": _RATE._replace(optional=True),
    "wrist_offset_mm": Field("figure", DIGITS, 1e-9),
    "optimality": Field("search", optional=True),
    "optimality.reversals_at_least": Field("search", DIGITS),
    "optimality.travel_at_least_deg": Field("search", BOUND, 1e-8),
    "optimality.gap_percent": Field("search", absolute=1e-6),
    "optimality.proven": Field("search"),
    "baseline": _EXACT,
    "baseline.reversals": _EXACT,
    "baseline.reversals_per_joint": _EXACT,
    "baseline.travel_deg": _ANGLE,
    "verified": Field("check", optional=True),
    "verified.passed": Field("check"),
    "verified.samples": Field("check"),
    "verified.blend_samples": Field("check"),
    "verified.reversals_per_joint": Field("check"),
    "verified.max_position_error_mm": Field("check", absolute=1e-5),  # below what it allows they are but rounding
    "verified.max_rotation_error_deg": Field("check", absolute=6e-7),
    "verified.max_joint_step_deg": Field("check", 1e-6, 1e-9),
    "verified.min_limit_distance_deg": Field("check", DIGITS, 1e-8),
    "verified.failures": Field("check"),
    "certificate": Field("not recomputed"),
    "certified_within": Field("not recomputed"),
    "criteria": Field("figure", optional=True),
    **{f"criteria.{each.path[-1]}": _criterion(each) for each in CRITERIA.values()},
    "lost_motion": Field("figure", optional=True),
    "lost_motion.at_tip_mm": Field("figure", DIGITS, 1e-9),
    "lost_motion.twin_at_tip_mm": Field("figure", DIGITS, 1e-9),
    "lost_motion.events": _EXACT,
    "lost_motion.events.joint": _EXACT,
    "lost_motion.events.leg": _EXACT,
    "lost_motion.events.standoff_mm": Field("figure", DIGITS, 1e-7),
    "lost_motion.events.friction": _EXACT,
    **_CORNER,
    "clearance": Field("figure", optional=True),
    "clearance.least_mm": Field("figure", DIGITS, CLEARANCE),
    "clearance.standoff_mm": Field("figure", absolute=ANYWHERE),
    "clearance.between": _EXACT,
    "clearance.certified": Field("check"),
    **{f"clearance.{part}_mm": Field("figure", DIGITS, 1e-6, optional=True) for part in WAY},
    "cycle_time_s": Field("figure", DIGITS, 1e-6, optional=True),
    "strokes": Field("figure", optional=True),
    "strokes.depth_mm": Field("figure", DIGITS),
    "strokes.standoff_mm": Field("motion", DIGITS, 1e-9),
    "strokes.psi_deg": Field("motion"),
    **{f"strokes.joints_deg.{each}": Field("motion") for each in ("start", "target", "end", "breakpoints")},
    "strokes.feeds_mm_s.plunge": Field("figure", DIGITS),
    "strokes.feeds_mm_s.retract": Field("figure", DIGITS),
    **{f"strokes.{key}": field for key, field in _CORNER.items()},
    "strokes.reversals_in_material": _EXACT,
    "strokes.reversals_in_air": _EXACT,
    "strokes.tool": _EXACT,
    "strokes.answer": Field("input"),  # each is checked as a hole of its own
    "findings": Field("finding"),
}
"""Likewise of a hole, by the path within it; that of a depth file has its own below `plan`."""


def field_of(path: str, fields: dict[str, Field]) -> Field | None:
    """What is done with the field of a path such as `events[0].standoff_mm`; None where nobody has said.

    Args:
        path: with or without the places of entries in lists.
        fields: of the head or of a hole.
    """
    names = [name.split("[")[0] for name in path.split(".")]
    for end in range(len(names), 0, -1):
        found = fields.get(".".join(names[:end]))
        if found is not None:
            return found if end == len(names) or found.how in ("input", "finding", "not recomputed") else None
    return None
