"""The six joint angles along the motion, planned and with constant spin (the thesis' fig. 32)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from zerorev.model._arrays import Array
from zerorev.model.plan import Event, HolePlan, LostMotionEvent, Motion, Plan, Score
from zerorev.model.profile import Profile
from zerorev.model.strokes import each_stroke
from zerorev.motion.drilling import Drilling
from zerorev.motion.evaluation import evaluated
from zerorev.motion.joint_path import joints_along, sample_distances
from zerorev.report.figures import style
from zerorev.report.figures.loads import CROSSED
from zerorev.report.scene.joint_range import joint_range
from zerorev.report.scene.motion_look import held
from zerorev.report.words.as_shown import turning_names

__all__ = ["REVERSAL", "Placed", "in_a_row", "joint_angles", "path_distance"]

SAMPLES = 600
CROSSES = "its load changes sign"
REVERSAL = {"marker": "X", "markersize": 8.0, "markeredgecolor": "white", "markeredgewidth": 0.9, "linestyle": "none"}


class Curve(NamedTuple):
    """Joint angles [deg], shape (N, 6), over path distance [mm], shape (N,); a row of NaN between two strokes.

    Attributes:
        turns: the joints (1..6) that turn back, and where [mm]; None where that is not known.
    """

    distance: Array
    joints: Array
    turns: tuple[tuple[int, float], ...] | None

    def reversals(self, joint: int) -> list[float]:
        """Where one joint (1..6) turns back [mm]."""
        return [at for turning, at in self.turns or () if turning == joint]

    def counted(self, joint: int) -> str:
        """How many, as the heading says it."""
        return "?" if self.turns is None else str(len(self.reversals(joint)))


class Placed(NamedTuple):
    """A stroke of a hole, its motion, and where on the path of all strokes one after the other it begins [mm]."""

    answer: HolePlan
    motion: Motion
    begins: float

    @property
    def target(self) -> float:
        """Where its deepest point lies on that path [mm]."""
        return self.begins + float(self.motion.profile.distance[self.motion.profile.corner]) * 1e3

    def place(self, event: Event | LostMotionEvent) -> float:
        """Where on that path an event of the stroke lies [mm]."""
        return self.begins + path_distance(self.motion.profile, event)


def in_a_row(hole: HolePlan) -> list[Placed]:
    """The strokes of a hole, one after the other; of one that has no others the hole itself.

    Raises:
        InputError: it has no motion.
    """
    placed, begins = [], 0.0
    for answer in each_stroke(hole):
        motion = style.motion_of(answer)
        placed.append(Placed(answer, motion, begins))
        begins += float(motion.profile.distance[-1]) * 1e3
    return placed


def joint_angles(plan: Plan, hole: HolePlan | str | None = None) -> Figure:
    """Six small pictures, one per joint: its angle [deg] against path distance [mm], planned and with constant spin.

    Of a hole of several strokes all of them one after the other; what the arm does between them is not drawn.

    Args:
        plan: whose robot and tool move.
        hole: of the plan, or its id, or that of a stroke; None: the first that has a motion.

    Raises:
        InputError: there is no such hole, or it has no motion.
    """
    hole = style.hole_of(plan, hole)
    strokes = in_a_row(hole)
    figure = style.new_figure("Joint angles along the drilling motion", plan, hole, height=5.6)
    grid = figure.subplots(2, 3, sharex=True)
    planned = _curve(plan, strokes, [stroke.motion.profile for stroke in strokes], [s.answer.score for s in strokes])
    loads = [(event, stroke) for stroke in strokes for event in _loads(stroke.answer)]
    constant = [held(stroke.motion.profile) for stroke in strokes]
    scores = [
        evaluated(Drilling.of(plan, each.answer.hole), profile, each.motion.branch, plan.settings).score
        for each, profile in zip(strokes, constant, strict=True)
    ]
    baseline = _curve(plan, strokes, constant, scores)
    for i, axes in enumerate(grid.flat):
        _one_joint(axes, plan, [stroke.target for stroke in strokes], i, planned, baseline)
        at = [stroke.place(event) for event, stroke in loads if event.joint == i + 1]
        axes.plot(at, np.interp(at, planned.distance, planned.joints[:, i]), zorder=4, **CROSSED,
                  markeredgecolor=style.JOINT_COLOURS[i], label=f"{plan.robot.joint_names[i]} loads")  # fmt: skip
        if i >= 3:
            style.label(axes, x="path distance [mm]")
        if i % 3 == 0:
            axes.set_ylabel("joint angle [deg]", size=9.5, color=style.INK)
    spin = f" {style.signed(np.rad2deg(constant[0].psi[0]), 1)} deg" if len(strokes) == 1 else " in each stroke"
    doubt = ", cannot be run" if baseline.turns is None else ""
    style.legend_below(
        figure,
        [
            Line2D([], [], color=style.INK, linewidth=2.2, label="planned"),
            Line2D([], [], color=style.BASELINE_COLOUR, linewidth=1.5, linestyle=(0, (4, 2)),
                   label=f"baseline: constant spin{spin}{doubt}"),
            Line2D([], [], color=style.INK, label="reversal of the joint", **REVERSAL),  # type: ignore[arg-type]
            Line2D([], [], color=style.MUTED, linewidth=0.9, linestyle=":",
                   label="target" if len(strokes) == 1 else "deepest point of a stroke"),
            *([Line2D([], [], markeredgecolor=style.INK, label=CROSSES, **CROSSED)] if loads else []),
        ],
        columns=4,
    )  # fmt: skip
    return figure


def _loads(answer: HolePlan) -> tuple[LostMotionEvent, ...]:
    return answer.lost_motion.events if answer.lost_motion else ()


def _curve(plan: Plan, strokes: Sequence[Placed], profiles: Sequence[Profile], scores: Sequence[Score | None]) -> Curve:
    """The curve of all strokes, each run with a profile of which a score is known, or None."""
    distances, joints, turns = list[Array](), list[Array](), list[tuple[int, float]]()
    for stroke, profile, score in zip(strokes, profiles, scores, strict=True):
        distance, angles = _angles(plan, stroke.answer, stroke.motion, profile)
        if distances:  # so that no line is drawn from one to the next
            distances.append(np.array([stroke.begins]))
            joints.append(np.full((1, 6), np.nan))
        distances.append(stroke.begins + distance)
        joints.append(angles)
        turns += [(event.joint, stroke.place(event)) for event in (score.events if score else ())]
    known = all(score is not None for score in scores)
    return Curve(np.concatenate(distances), np.concatenate(joints), tuple(turns) if known else None)


def _angles(plan: Plan, hole: HolePlan, motion: Motion, profile: Profile) -> tuple[Array, Array]:
    """Path distance [mm] and controller angles [deg] with the turns of the motion, from whose start they begin."""
    distance = sample_distances(profile, SAMPLES)
    standoff, psi = profile.at(distance)
    joints = joints_along(Drilling.of(plan, hole.hole), motion.branch, standoff, psi)
    turns = np.round((motion.joints[0] - joints[0]) / (2 * np.pi)) * 2 * np.pi
    return distance * 1e3, np.rad2deg(joints + turns)


def path_distance(profile: Profile, event: Event | LostMotionEvent) -> float:
    """Where on the path an event lies [mm]."""
    corner = profile.standoff[profile.corner]
    to_corner = float(profile.standoff[0] - corner)
    if event.leg == "target":
        return to_corner * 1e3
    away = event.standoff - float(corner)
    return 1e3 * (to_corner - away if event.leg == "plunge" else to_corner + away)


def _one_joint(axes: Axes, plan: Plan, targets: list[float], i: int, planned: Curve, baseline: Curve) -> None:
    style.bare_axes(axes)
    colour, name = style.JOINT_COLOURS[i], plan.robot.joint_names[i]
    for target in targets:
        axes.axvline(target, color=style.MUTED, linewidth=0.9, linestyle=":", zorder=1)
    axes.plot(baseline.distance, baseline.joints[:, i], color=style.BASELINE_COLOUR, linewidth=1.5,
              linestyle=(0, (4, 2)), zorder=2, label=f"{name} baseline")  # fmt: skip
    axes.plot(planned.distance, planned.joints[:, i], color=colour, linewidth=2.2, zorder=3, label=f"{name} planned")
    for curve, ink in ((baseline, style.BASELINE_COLOUR), (planned, colour)):
        at = curve.reversals(i + 1)
        if at:
            axes.plot(at, np.interp(at, curve.distance, curve.joints[:, i]), color=ink, zorder=4,
                      label=f"{name} reversals", **REVERSAL)  # type: ignore[arg-type] # fmt: skip
    _frame(axes, np.concatenate([planned.joints[:, i], baseline.joints[:, i]]),
           np.rad2deg([plan.robot.limits.lower[i], plan.robot.limits.upper[i]]))  # fmt: skip
    axes.set_xlim(0, planned.distance[-1])
    _end_labels(axes, (planned.joints[-1, i], baseline.joints[-1, i]), style.JOINT_INKS[i])
    axes.set_title(
        turning_names(plan.robot)[i],
        loc="left",
        size=11,
        weight="bold",
        color=style.JOINT_INKS[i],
        pad=4,
        parse_math=False,
    )
    axes.set_title(
        f"reversals {baseline.counted(i + 1)} → {planned.counted(i + 1)}",
        loc="right",
        size=8.5,
        color=style.MUTED,
        pad=4,
    )


def _frame(axes: Axes, values: Array, limits: Array) -> None:
    """The range of the angle axis; a joint limit is shown where the motion comes near it."""
    shown = joint_range(values, *limits)
    for limit, align in ((shown.lower, "bottom"), (shown.upper, "top")):
        if limit is None:
            continue
        axes.axhline(limit, color="black", linewidth=1.6, zorder=1)
        axes.annotate(f"limit {style.signed(limit, 0)}", (0.02, limit), xycoords=("axes fraction", "data"), size=8,
                      xytext=(0, 2 if align == "bottom" else -2), textcoords="offset points", va=align,
                      color="black")  # fmt: skip
    axes.set_ylim(shown.low, shown.high)


def _end_labels(axes: Axes, ends: tuple[float, float], ink: str) -> None:
    """Name the two curves where they end, beside the picture."""
    low, high = axes.get_ylim()
    places = style.spread_out([end if np.isfinite(end) else low for end in ends], 0.085 * (high - low))
    for end, place, text, colour in zip(ends, places, ("planned", "baseline"), (ink, style.MUTED), strict=True):
        if np.isfinite(end):
            axes.annotate(text, (1.02, place), xycoords=("axes fraction", "data"), size=8, va="center", color=colour,
                          annotation_clip=False)  # fmt: skip
