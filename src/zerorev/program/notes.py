"""What a program alone tells about itself: the depth lost to the blend, clearance, spindle speed, unchecked moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from zerorev.model._arrays import Array
from zerorev.model.finding import Finding, FindingKind, Level
from zerorev.model.job import Settings
from zerorev.model.written import WrittenProgram
from zerorev.program import joint_speeds
from zerorev.program.neutral import HoleProgram, Move, Program

__all__ = [
    "CornerDepth",
    "calls",
    "corner_depth",
    "notes",
    "only_numbered",
    "pieces",
    "segments",
    "tool_turn",
    "turn_speed",
]

NOTICEABLE = 1e-6  # [m] a depth below this is not worth a word
TWO_CYCLES = 24e-3  # [s]: a controller interpolates every 12 ms, or faster
SPINDLE_SHARE = 0.01  # a change of the spindle's speed beyond this share is a warning


@dataclass(frozen=True)
class CornerDepth:
    """How deep the tip comes where the motion turns.

    Attributes:
        blend: radius at the corner, as written [m].
        below: how far below the target the corner is placed [m].
        shortfall: how far short of the corner the blend turns back [m].
    """

    blend: float
    below: float
    shortfall: float

    @property
    def lost(self) -> float:
        """Depth lost at the target [m]; negative where the tip comes out deeper."""
        return self.shortfall - self.below


def corner_depth(program: Program, hole: HoleProgram) -> CornerDepth:
    """Depth at the corner of one hole (theory §5).

    A parabolic blend of radius r turns back r/2 short; a measured shortfall takes the place of r/2, and shrinks in
    proportion where the radius had to be clipped.
    """
    turning, move = program.settings.turning, hole.corner_move
    share = move.blend / turning.radius if turning.radius > 0 else 0.0
    return CornerDepth(move.blend, -move.standoff, turning.shortfall * share)


def segments(hole: HoleProgram) -> list[tuple[float, float, Move]]:
    """Stand-off [m] and spin [rad] at which each linear move of a hole begins, and the move."""
    ends = [(hole.start.standoff, hole.start.psi), *((move.standoff, move.psi) for move in hole.moves)]
    return [(standoff, psi, move) for (standoff, psi), move in zip(ends, hole.moves, strict=False)]


def turn_speed(hole: HoleProgram) -> float:
    """Greatest speed at which the moves of a hole turn the tool about the drill axis [rad/s]."""
    return joint_speeds.turn_speed(pieces(hole))


def pieces(hole: HoleProgram) -> list[joint_speeds.Piece]:
    """The linear moves of a hole with their feeds, in the twist plane."""
    return [
        joint_speeds.Piece(move.leg, (standoff, psi), (move.standoff, move.psi), move.feed)
        for standoff, psi, move in segments(hole)
    ]


def notes(program: Program) -> tuple[Finding, ...]:
    """Findings that need no more than the program; what holds for every hole alike is said once."""
    return (
        *program.findings,
        *_blend(program),
        *_clearance(program),
        *_spindle(program),
        *_short_moves(program),
        *calls(program.settings),
        *_unchecked(program),
    )


def _said_once(program: Program, level: Level, kind: FindingKind, messages: list[str]) -> tuple[Finding, ...]:
    """One finding a hole, or one for the whole program where all holes have the same; empty messages are left out."""
    if len(set(messages)) == 1 and messages[0] and len(messages) > 1:
        return (Finding(level, kind, f"{messages[0]} (at every hole)"),)
    return tuple(
        Finding(level, kind, message, hole.id) for hole, message in zip(program.holes, messages, strict=True) if message
    )


def _blend(program: Program) -> tuple[Finding, ...]:
    depths = [corner_depth(program, hole) for hole in program.holes]
    wanted = program.settings.turning.radius
    clipped = [
        f"the blend at the corner is {depth.blend * 1e3:.2f} mm instead of {wanted * 1e3:g} mm: half the shorter of "
        "the two moves that meet there"
        if 0 < depth.blend < wanted - NOTICEABLE and program.settings.turning.kind == "blend"
        else ""
        for depth in depths
    ]
    return (
        *_said_once(program, "warning", "blend_clipped", clipped),
        *_said_once(program, "info", "blend", [_depth_lost(program, depth) for depth in depths]),
    )


def _depth_lost(program: Program, depth: CornerDepth) -> str:
    if depth.blend == 0:
        return ""
    turning = program.settings.turning
    what = f"the blend of radius {depth.blend * 1e3:.4g} mm"
    if turning.kind in ("joint", "spin"):
        what = f"the blend of the joint moves ({depth.blend * 1e3:.4g} mm to either side, at most)"
    says = f"{what} turns back {depth.shortfall * 1e3:.4g} mm short ({turning.law})"
    if depth.lost > NOTICEABLE:
        option = "" if depth.below > 0 else "; deepen_corner places the corner that much deeper"
        return f"{says}: the hole comes out {depth.lost * 1e3:.4g} mm less deep{option}"
    if depth.lost < -NOTICEABLE:
        return f"{says}: the hole comes out {-depth.lost * 1e3:.4g} mm deeper than asked for"
    return f"{says}: the corner is placed that much deeper, so that the depth is met"


def _clearance(program: Program) -> tuple[Finding, ...]:
    """The corner below the target: a stop or a single step goes all the way to it (theory §5)."""
    depths = [corner_depth(program, hole) for hole in program.holes]
    messages = [
        f"the programmed corner lies {depth.below * 1e3:.4g} mm below the target; stopping or stepping there goes to "
        "the true corner, so the clearance behind the material must allow it"
        if depth.below > NOTICEABLE
        else ""
        for depth in depths
    ]
    found = _said_once(program, "warning", "clearance", messages)
    if program.settings.deepen_corner and program.settings.turning.shortfall > 0:
        at_target = [
            "deepen_corner is asked for, but the plan's corner lies at the target: plan the hole again"
            if depth.below <= NOTICEABLE and depth.blend > 0
            else ""
            for depth in depths
        ]
        found += _said_once(program, "warning", "corner_not_deepened", at_target)
    return found


def _spindle(program: Program) -> tuple[Finding, ...]:
    """Change of the spindle's speed by the twist: deg/mm times mm/s over 6 is rev/min (thesis eq. 5.4)."""
    rpm = program.settings.spindle_rpm
    if rpm is None:
        return ()
    changes: list[tuple[float, str, Move]] = []
    for hole in program.holes:
        for standoff, psi, move in segments(hole):
            # the tool body turns by -psi about the plunge direction, which is the sense of a right-hand drill
            rate = -(move.psi - psi) / abs(move.standoff - standoff) * move.feed
            changes.append((float(rate * 60 / (2 * np.pi)), hole.id, move))
    change, hole_id, move = max(changes, key=lambda entry: abs(entry[0]))
    share = abs(change) / rpm
    message = (
        f"the twist changes the speed of a right-hand drill by {change:+.3g} rev/min at most ({share:.2%} of {rpm:g}), "
        f"in the {move.leg} of hole {hole_id}"
    )
    return (Finding("warning" if share > SPINDLE_SHARE else "info", "spindle_speed", message),)


def _short_moves(program: Program) -> tuple[Finding, ...]:
    """Linear moves that a controller has hardly time to plan: it computes a point of the path once per cycle."""
    short = [
        (abs(move.standoff - standoff) / move.feed, abs(move.standoff - standoff), hole.id, move)
        for hole in program.holes
        for standoff, _, move in segments(hole)
        if abs(move.standoff - standoff) < TWO_CYCLES * move.feed
    ]
    if not short:
        return ()
    time, length, hole_id, move = min(short, key=lambda entry: entry[0])
    count = f"{len(short):,} linear moves last" if len(short) > 1 else "a linear move lasts"
    message = (
        f"{count} less than two cycles of a controller ({TWO_CYCLES * 1e3:g} ms): {time * 1e3:.3g} ms for "
        f"{length * 1e3:.3g} mm at {move.feed * 1e3:g} mm/s in the {move.leg} of hole {hole_id}; the feed may drop. "
        "A lower feed, a longer stroke or lead-in, or fewer breakpoints make them longer"
    )
    return (Finding("warning", "short_move", message),)


def calls(settings: Settings) -> tuple[Finding, ...]:
    """Which programs of the controller are called where: nobody here knows what they do."""
    places = [f"{', '.join(map(str, called))} {place}" for place, called in settings.calls.places()]
    message = f"calls {'; '.join(places)}: what these programs do is not examined"
    return (Finding("info", "calls", message),) if places else ()


def only_numbered(program: WrittenProgram) -> tuple[Finding, ...]:
    """Of which frames a program has but the number: what stands under it on the controller nobody here knows.

    Args:
        program: as read back.
    """
    names = [name for name, frame in (("tool", program.tool), ("part frame", program.base)) if frame is None]
    if not names:
        return ()
    message = (
        f"the program has the {' and the '.join(names)} by number alone: what is said of it holds where the plan's "
        "values stand there on the controller, which is not examined"
    )
    return (Finding("info", "controller", message),)


def _unchecked(program: Program) -> tuple[Finding, ...]:
    message = (
        "the moves of all axes from hole to hole are checked against the surface of the part alone, not for fixtures, "
        "the cell or the arm's own links; the first one, from wherever the robot is, is not checked at all"
    )
    return (Finding("info", "unchecked_moves", message),)


def tool_turn(T_start: Array, T_end: Array) -> float:
    """Angle between two poses [rad], by the half-angle form, which keeps its digits at 0 and at 180 deg."""
    R = T_start[:3, :3].T @ T_end[:3, :3]
    sine = np.linalg.norm([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    return float(np.arctan2(sine, np.trace(R) - 1.0))
