"""Symmetry (eq. 4.12), chaining (4.13), the rotation moved to the retract (4.14, 4.15), the drill's speed (5.4)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from zerorev.model.hole import Hole
from zerorev.model.job import Settings
from zerorev.model.profile import Profile
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import Evaluation, evaluated
from zerorev.motion.joint_path import joint_path
from zerorev.report.figures.style import png
from zerorev.search.exact import search
from zerorev.thesis.figures.reproduced import rotation_split
from zerorev.thesis.reproduce.context import Context
from zerorev.thesis.reproduce.published import POSITIONS, Position
from zerorev.thesis.reproduce.section import Column, Picture, Result, Section, Table

__all__ = ["Spins", "best_of", "make", "rev_per_min"]

Spins = tuple[float, ...]
"""psi_start, psi_target, psi_end [deg]"""

CHAIN, PITCH_MM = 6, 10.0  # holes in a row along Y, as on a panel
PROGRAM_FEED = 0.2  # [m/s] $VEL.CP of Appendix B
EXAMPLE_DEG, EXAMPLE_S = 30.0, 0.5  # eq. 5.4


def best_of(context: Context, hole: Hole, spins_deg: Spins) -> tuple[int, Evaluation]:
    """The branch, and its evaluation, on which a straight motion does best: fewest reversals, then least travel.

    Args:
        context: the robot and the tool.
        hole: what is drilled.
        spins_deg: start, target, end [deg].
    """
    profile = Profile.straight(hole.depth, *np.deg2rad(spins_deg))
    found = [evaluated(Drilling(context.robot, context.tool, hole), profile, branch) for branch in range(8)]

    def cost(branch: int) -> tuple[float, float]:
        score = found[branch].score
        # the two flips of a wrist travel alike but for the last bits
        return (np.inf, np.inf) if score is None else (score.reversals, round(score.travel, 9))

    best = min(range(8), key=cost)
    return best, found[best]


def rev_per_min(turned_deg: float, depth_mm: float, feed: float) -> float:
    """Change of the drill's speed [rev/min] by a spin of so many degrees over a stroke at a feed [m/s] (eq. 5.4)."""
    return turned_deg / (depth_mm / 1e3 / feed) / 360 * 60


def make(context: Context) -> Section:
    """Everything that sec. 4.7 and 5.5 conclude from the symmetry of a motion."""
    mirrored, symmetry = _symmetry(context)
    shifted = _shifts(context)
    chain, chained = _chain(context)
    split, moved, picture = _moved(context)
    speeds, speed = _speeds(context)
    text = (
        "A motion run backwards reverses nothing that it did not reverse before. So every motion has a twin with start"
        " and end exchanged, as long as each joint's turns are chosen for the whole path (eq. 4.11); a row of holes can"
        " be drilled by a motion and its twin in turn; and of the two, that one can be taken which turns the tool less"
        " while it cuts.",
    )
    return Section(text, (shifted, symmetry, chained, *moved, *speed), (mirrored, chain, split, speeds), (picture,))


def _symmetry(context: Context) -> tuple[Table, Result]:
    columns = (
        Column("position"),
        Column("motion"),
        Column("ψs", "deg", 4),
        Column("ψt", "deg", 4),
        Column("ψe", "deg", 4),
        Column("branch"),
        Column("reversals"),
        Column("travel", "deg", 6),
    )
    rows: list[tuple[str | int | float, ...]] = []
    worst = 0.0
    for position in POSITIONS:
        travels = []
        for name, spins in (("published", position.psi_deg), ("exchanged", position.psi_deg[::-1])):
            branch, found = best_of(context, position.hole, spins)
            assert found.score is not None
            travels.append(float(np.rad2deg(found.score.travel)))
            rows.append((position.name, name, *spins, branch, found.score.reversals, travels[-1]))
        worst = max(worst, abs(travels[1] - travels[0]))
    caption = "The three published motions and their twins, turns chosen for the whole path."
    result = Result(
        "f(ψs, ψt, ψe) = f(ψe, ψt, ψs)",
        "holds after shifting joints by ±360° by hand",
        "eq. 4.12",
        f"equal reversals; travel equal to {worst:.0e}°",
        "both twins are found; that with less rotation in the plunge is reported",
        "Holds without any shifting by hand, because the turns are chosen after the extents are known.",
    )
    return Table("mirror", caption, columns, tuple(rows)), result


def _shifts(context: Context) -> Result:
    """Eq. 4.11: how many of the published joint targets need a turn, and that the motions run within the limits."""
    joints = np.array([axis for position in POSITIONS for axis in position.axis_deg])
    outside = int((np.abs(joints) > 180).any(axis=1).sum())
    runs = 0
    for position in POSITIONS:
        branch, found = best_of(context, position.hole, position.psi_deg)
        path = joint_path(Drilling(context.robot, context.tool, position.hole), position.profile, branch)
        runs += path.runs and found.score is not None
    return Result(
        "θ = θ ± 360° k",
        "the first point is wrapped close to zero; motions then leave the limits",
        "eq. 4.11, sec. 4.7",
        f"{outside} of the 9 joint targets of Appendix B have a joint beyond ±180°",
        f"{runs} of 3 motions run within the limits",
        "The thesis' own program needs such turns: joint 6 runs beyond 180° at positions 1 and 3.",
    )


def _chain(context: Context) -> tuple[Table, Result]:
    """A row of holes beside position 1, drilled by the published spins and their twin in turn (eq. 4.13)."""
    position = POSITIONS[0]
    columns = (
        Column("hole"),
        Column("Y", "mm", 0),
        Column("ψs", "deg"),
        Column("ψe", "deg"),
        Column("reversals"),
        Column("travel", "deg"),
        Column("to it, chained", "deg"),
        Column("to it, the same ψ each time", "deg"),
    )
    rows: list[tuple[str | int | float | None, ...]] = []
    ends: dict[bool, np.ndarray] = {}
    branch, _ = best_of(context, position.hole, position.psi_deg)
    for n in range(CHAIN):
        x, y, z = position.target_mm
        hole = replace(position.hole, id=f"{n + 1}", target=np.array([x, y + PITCH_MM * n, z]) / 1e3)
        between: list[float | None] = []
        for chained in (True, False):
            spins = position.psi_deg[::-1] if chained and n % 2 else position.psi_deg
            found = evaluated(
                Drilling(context.robot, context.tool, hole), Profile.straight(hole.depth, *np.deg2rad(spins)), branch
            )
            assert found.motion is not None
            assert found.score is not None
            joints = np.rad2deg(found.motion.joints)
            between.append(float(np.abs(joints[0] - ends[chained]).max()) if chained in ends else None)
            ends[chained] = joints[-1]
            if chained:
                given = (spins[0], spins[2], found.score.reversals, float(np.rad2deg(found.score.travel)))
        rows.append((hole.id, y + PITCH_MM * n, *given, *between))
    reversals = sum(int(row[4] or 0) for row in rows)
    with_chain, without = (max(float(row[k] or 0) for row in rows) for k in (-2, -1))
    caption = (
        f"{CHAIN} holes {PITCH_MM:g} mm apart along Y, beside position 1, with its published spins; on the way to each,"
        " the greatest move of one joint."
    )
    result = Result(
        "chaining: ψ of a hole begins where the last one ended",
        "more efficient",
        "eq. 4.13",
        f"{CHAIN} holes, {reversals} reversals; at most {with_chain:.1f}° of one joint between two holes, instead of"
        f" {without:.1f}°",
        "",
        "The tool need not turn back between holes, and every second hole is drilled by the twin.",
    )
    return Table("chain", caption, columns, tuple(rows)), result


def _moved(context: Context) -> tuple[Table, tuple[Result, ...], Picture]:
    """The rotation in plunge and retract: published, its twin, the thesis' rule, and the least by the exact search."""
    columns = (
        Column("position"),
        Column("motion"),
        Column("ψs", "deg", 2),
        Column("ψt", "deg", 2),
        Column("ψe", "deg", 2),
        Column("|ψt − ψs|, plunge", "deg", 2),
        Column("|ψe − ψt|, retract", "deg", 2),
        Column("reversals"),
        Column("travel", "deg"),
    )
    rows: list[tuple[str | int | float | None, ...]] = []
    least = {}
    for position in POSITIONS:
        start, target, end = position.psi_deg
        motions = [
            ("published", position.psi_deg),
            ("ψs and ψe exchanged", (end, target, start)),
            ("−ψt for ψt (eq. 4.15)", (start, -target, end)),
            ("least in the plunge, exact", _least_plunge(context, position)),
        ]
        for name, spins in motions:
            _, found = best_of(context, position.hole, spins)
            score = found.score
            counted = (None, None) if score is None else (score.reversals, float(np.rad2deg(score.travel)))
            rows.append((position.name, name, *spins, abs(spins[1] - spins[0]), abs(spins[2] - spins[1]), *counted))
        least[position.name] = rows[-1]
    published, twin, negated, exact = rows[:4]
    results = (
        Result(
            "rotation in the plunge much greater than in the retract [deg]",
            "|ψt − ψs| ≫ |ψe − ψt|",
            "eq. 4.14",
            f"{published[5]:.2f} and {published[6]:.2f} at position 1",
            f"{exact[5]:.2f} and {exact[6]:.2f}, the least in the plunge",
            "At position 1 the published halves are about equal, at position 3 the plunge has most.",
        ),
        Result(
            "moving the rotation to the retract, position 1",
            "−ψt in place of ψt",
            "eq. 4.15",
            f"{negated[7]} reversals with −ψt; {twin[7]} with ψs and ψe exchanged",
            f"{exact[7]} reversals with {exact[5]:.1f}° in the plunge and {exact[6]:.1f}° in the retract",
            "An error in the thesis: it is the exchange of start and end that moves the rotation.",
        ),
    )
    caption = "Where the tool turns: in the plunge, while it cuts, or in the retract."
    table = Table("rotation_split", caption, columns, tuple(rows))
    drawn = [(str(row[0]), str(row[1]), float(row[5] or 0), float(row[6] or 0), row[7]) for row in rows]
    picture = Picture(
        "rotation_split",
        "Rotation of the tool in the plunge and in the retract. The number beside each bar is the count"
        " of reversals, and the bar has its colour.",
        png(rotation_split(drawn)),
    )
    return table, results, picture


def _least_plunge(context: Context, position: Position) -> Spins:
    settings = replace(context.thesis, objective="plunge_rotation")
    found = search(Drilling(context.robot, context.tool, position.hole), settings)
    assert found is not None
    return tuple(np.rad2deg(found.profile.psi).tolist())


def _speeds(context: Context) -> tuple[Table, tuple[Result, ...]]:
    columns = (
        Column("position"),
        Column("rotation in the plunge", "deg", 2),
        Column("stroke", "mm", 0),
        Column("at 5 mm/s", "rev/min", 2),
        Column("at 0.2 m/s (Appendix B)", "rev/min", 2),
        Column("least rotation, exact", "deg", 2),
        Column("then at 0.2 m/s", "rev/min", 2),
    )
    rows = []
    for position in POSITIONS:
        start, target, _ = position.psi_deg
        best_start, best_target, _ = _least_plunge(context, position)
        turned, least, depth = abs(target - start), abs(best_target - best_start), position.depth_mm
        slow = rev_per_min(turned, depth, Settings().feed_plunge)
        fast, best = (rev_per_min(angle, depth, PROGRAM_FEED) for angle in (turned, least))
        rows.append((position.name, turned, depth, slow, fast, least, best))
    example = EXAMPLE_DEG / EXAMPLE_S / 360 * 60
    results = (
        Result(
            f"change of drill speed by {EXAMPLE_DEG:g}° in {EXAMPLE_S:g} s [rev/min]",
            "10",
            "eq. 5.4",
            f"{example:.4g}",
            "",
            "Agrees; an example, not one of the published motions.",
        ),
        Result(
            "the same at position 1, at the 0.2 m/s of Appendix B [rev/min]",
            "–",
            "eq. 5.4, Appendix B",
            f"{rows[0][4]:.2f}",
            f"{rows[0][6]:.2f}",
            "The thesis does not tell the figure of its own motions; at a drilling feed of 5 mm/s it is"
            " forty times less.",
        ),
    )
    return Table(
        "drill_speed", "By how much the spin changes the speed of the drill (eq. 5.4).", columns, tuple(rows)
    ), results
