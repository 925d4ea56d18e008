"""What the commands `place` and `share` write and show: plain data, a table, and a few lines."""

from __future__ import annotations

from typing import Any

import numpy as np
from rich import box
from rich.table import Table
from rich.text import Text

from zerorev.files.conversion import robot_data, settings_data, tool_data
from zerorev.files.moved_job import frame_text
from zerorev.files.units import deg, mm, plain
from zerorev.model._arrays import Array
from zerorev.model.job import Job
from zerorev.placement.freedom import AXES, Freedom, frame_at
from zerorev.placement.search import Placement
from zerorev.placement.sharing import Shares
from zerorev.report.words.answer import how_deep

__all__ = [
    "NAMES", "in_unit", "place_words", "placement_data", "placement_lines", "placement_table", "robot_instead",
    "share_data", "share_lines", "share_table",
]  # fmt: skip

ROWS = 60
ENDS = ("start", "stop")
NAMES = {"x": "x_mm", "y": "y_mm", "z": "z_mm", "turn": "turn_deg"}


def in_unit(axis: str, values: Array) -> Array:
    """Values along an axis of the freedom, in mm or deg."""
    return np.asarray((deg if axis == "turn" else mm)(values)) + 0.0


def robot_instead(T_base_part: Array, place: Array) -> Array:
    """Where the robot's base should stand in its present base frame, if the part is left alone; shape (4, 4)."""
    return np.asarray(T_base_part @ np.linalg.inv(frame_at(T_base_part, place)))


def placement_data(job: Job, freedom: Freedom, found: Placement) -> dict[str, Any]:
    """The answer as plain data, in the form of a placement file (docs/howto/place_a_part.md)."""
    granted = {NAMES[axis]: in_unit(axis, np.array(getattr(freedom, axis))) for axis in AXES}
    best = _place_data(job, found.place, found.margins) | {
        "room": None if found.room is None else _room(found.room),
        "at_end_of": {NAMES[AXES[axis]]: ENDS[side] for axis, side in found.pressed},
    }
    holes = zip(job.holes, found.margins, found.as_it_stands, strict=True)
    data = {
        "format": "zerorev.placement/1",
        "name": job.name,
        "finished": found.finished,
        "robot": robot_data(job.robot),
        "tool": tool_data(job.tool),
        "part_frame": frame_text(job.T_base_part),
        "settings": settings_data(job.settings),
        "freedom": granted,
        "drillable": found.least >= 0,
        "best": best,
        "enough": None if found.enough is None else _enough_data(job, found, found.enough),
        "as_it_stands": {"least_margin_mm": mm(found.as_it_stands.min())},
        "holes": [
            {
                "id": hole.id,
                "depth_mm": mm(hole.depth),
                "deepest_mm": mm(hole.depth + margin),
                "deepest_as_it_stands_mm": mm(hole.depth + before),
            }
            for hole, margin, before in holes
        ],
        "grid": {NAMES[axis]: in_unit(axis, values) for axis, values in zip(AXES, found.grid, strict=True)}
        | {"least_margin_mm": mm(found.found)},
        "slices": [
            {NAMES[axis]: in_unit(axis, values) for axis, values in zip(each.axes, each.values, strict=True)}
            | {"axes": [NAMES[axis] for axis in each.axes], "least_margin_mm": mm(each.margin)}
            for each in found.slices
        ],
        "strokes": found.strokes,
    }
    return dict(plain(data))


def _place_data(job: Job, place: Array, margins: Array) -> dict[str, Any]:
    return {
        "shift_mm": mm(place[:3]),
        "turn_deg": deg(place[3]),
        "part_frame": frame_text(frame_at(job.T_base_part, place)),
        "robot_instead": frame_text(robot_instead(job.T_base_part, place)),
        "least_margin_mm": mm(margins.min()),
        "worst_hole": job.holes[int(margins.argmin())].id,
    }


def _enough_data(job: Job, found: Placement, enough: float) -> dict[str, Any]:
    data: dict[str, Any] = {"margin_mm": mm(enough), "nearest": None, "most_room": None}
    for key, each in (("nearest", found.nearest), ("most_room", found.roomiest)):
        if each is not None:
            data[key] = _place_data(job, each.place, each.margins) | {"distance_mm": mm(each.distance)}
    if found.roomiest is not None and found.roomiest.room is not None:
        room = found.roomiest.room
        data["most_room"]["room_mm"] = mm(room) if np.isfinite(room) else None
    return data


def _room(room: Array) -> dict[str, Array]:
    return {NAMES[axis]: in_unit(axis, ends) for axis, ends in zip(AXES, room, strict=True)}


def place_words(place: Array) -> str:
    """A place as one line: shift along x, y, z, and turn."""
    shift = ", ".join(f"{value:.6g}" for value in mm(place[:3]) + 0.0)
    return f"shift ({shift}) mm, turn {deg(place[3]) + 0.0:.5g} deg"


def placement_table(job: Job, found: Placement) -> Table:
    """One row per hole, the worst first: depth needed, deepest as it stands and at the best place."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for heading in (
        "hole",
        "depth\n[mm]",
        "deepest as it stands\n[mm]",
        "deepest at the best place\n[mm]",
        "margin\n[mm]",
    ):
        table.add_column(Text(heading), justify="left" if heading == "hole" else "right")
    for k in np.argsort(found.margins, kind="stable")[:ROWS]:
        hole = job.holes[k]
        before, after = (float(mm(hole.depth + margins[k])) for margins in (found.as_it_stands, found.margins))
        table.add_row(
            Text(hole.id), Text(f"{mm(hole.depth):.6g}"), Text(f"{before:.1f}"), Text(f"{after:.1f}"),
            _signed(found.margins[k]),
        )  # fmt: skip
    return table


def placement_lines(job: Job, freedom: Freedom, found: Placement) -> list[Text]:
    """What it comes to, and what it is held to."""
    lines = [Text(f"deepest strokes with {how_deep(job.settings)}", style="dim")]
    if len(job.holes) > ROWS:
        lines.append(Text(f"the {ROWS} holes of least margin of {len(job.holes)}"))
    before = float(mm(found.as_it_stands.min()))
    lines.append(Text(f"as it stands: least margin {before:+.1f} mm ({_drillable(found.as_it_stands)})"))
    margin, words = float(mm(found.least)), place_words(found.place)
    worst = job.holes[found.worst].id
    if found.least < 0:
        short = f"no place that was examined drills every hole; at the best of them, {words}, hole {worst} is"
        lines.append(Text(f"{short} {-margin:.1f} mm too shallow ({_drillable(found.margins)})", style="yellow"))
        return [*lines, *_end_lines(freedom, found), *_enough_lines(job, found)]
    lines.append(Text(f"best place: {words}; least margin {margin:+.1f} mm, hole {worst}", style="green"))
    lines.append(_frame_line(job, found.place))
    robot = frame_text(robot_instead(job.T_base_part, found.place))
    lines.append(Text(f"or move the robot's base instead: xyz_mm {robot['xyz_mm']}, turn {robot['rpy_deg'][2]:g} deg"))
    if found.room is not None:
        ways = [
            f"{NAMES[AXES[axis]].replace('_', ' [')}] {low:+.4g} to {high:+.4g}"
            for axis in freedom.granted
            for low, high in [in_unit(AXES[axis], found.room[axis])]
        ]
        if ways:
            lines.append(Text(f"room from there, one axis at a time: {'; '.join(ways)}"))
    return [*lines, *_end_lines(freedom, found), *_enough_lines(job, found)]


def _frame_line(job: Job, place: Array) -> Text:
    frame = frame_text(frame_at(job.T_base_part, place))
    return Text(f"part_frame: {{xyz_mm: {frame['xyz_mm']}, rpy_deg: {frame['rpy_deg']}}}")


def _enough_lines(job: Job, found: Placement) -> list[Text]:
    """The nearest place with enough margin, and the one with most room around it."""
    if found.enough is None:
        return []
    wanted = f"{float(mm(found.enough)):g} mm margin or more"
    if found.nearest is None:
        return [Text(f"no place that was examined has {wanted}", style="yellow")] if found.finished else []
    lines = []
    for what, each in (("nearest place", found.nearest), ("place with most room", found.roomiest)):
        if each is None:
            continue
        margin, worst = float(mm(each.margins.min())), job.holes[int(each.margins.argmin())].id
        where = f"{place_words(each.place)}; least margin {margin:+.1f} mm, hole {worst}"
        lines += [Text(f"{what} with {wanted}: {where}", style="green"), _frame_line(job, each.place)]
        if each.room is None:
            lines.append(Text(f"no hole moves there by more than {float(mm(each.distance)):.1f} mm"))
        elif np.isinf(each.room):
            lines.append(Text("every place that was examined has it"))
        else:
            held = f"no hole by more than {float(mm(each.room)):.1f} mm"
            lines.append(Text(f"room around it: as long as a shift and turn move {held}, every place examined has it"))
    return lines


def _end_lines(freedom: Freedom, found: Placement) -> list[Text]:
    """Where the ranges may be too narrow, and how to widen them."""
    lines = []
    for axis, side in found.pressed:
        option = f"--{NAMES[AXES[axis]].replace('_', '-')}"
        low, high = in_unit(AXES[axis], np.array(freedom.widened(axis, side)))
        where = f"that place lies at the {ENDS[side]} of {option}, and a better one may lie beyond"
        lines.append(Text(f"{where}: widen it, e.g. {option}={low:.6g}:{high:.6g}", style="yellow"))
    return lines


def _drillable(margins: Array) -> str:
    return f"{int((margins >= 0).sum())} of {margins.size} holes can be drilled without a reversal"


def _signed(margin: float) -> Text:
    if np.isnan(margin):
        return Text("")
    return Text(f"{mm(margin):+.1f}", style="green" if margin >= 0 else "red")


def share_data(jobs: list[Job], shares: Shares) -> dict[str, Any]:
    """Who takes which hole, as plain data, in the form of a share file (docs/howto/place_a_part.md)."""
    robots = [
        {"job": job.name, "robot": robot_data(job.robot), "tool": tool_data(job.tool),
         "part_frame": frame_text(job.T_base_part), "holes": int((shares.taken_by == r).sum())}
        for r, job in enumerate(jobs)
    ]  # fmt: skip
    holes = [
        {"id": name, "taken_by": None if shares.taken_by[k] < 0 else int(shares.taken_by[k]),
         "margin_mm": mm(shares.margins[:, k])}
        for k, name in enumerate(shares.ids)
    ]  # fmt: skip
    data = {"format": "zerorev.share/1", "robots": robots, "holes": holes, "least_margin_mm": mm(shares.least)}
    return dict(plain(data))


def share_table(jobs: list[Job], shares: Shares) -> Table:
    """One row per hole: the margin of each robot on it, and who takes it."""
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    table.add_column(Text("hole"))
    for job in jobs:
        table.add_column(Text(f"margin of {job.name}\n[mm]"), justify="right")
    table.add_column(Text("taken by"))
    for k, name in enumerate(shares.ids[:ROWS]):
        taker = shares.taken_by[k]
        who = Text("nobody", style="red") if taker < 0 else Text(jobs[taker].name)
        table.add_row(Text(name), *(_signed(margin) for margin in shares.margins[:, k]), who)
    return table


def share_lines(jobs: list[Job], shares: Shares) -> list[Text]:
    """How many each takes, and the least margin."""
    lines = [Text(f"{len(shares.ids)} holes, {ROWS} shown")] if len(shares.ids) > ROWS else []
    for r, job in enumerate(jobs):
        able = int((shares.margins[r] >= 0).sum())
        text = (
            f"{job.name} ({job.robot.name}): takes {int((shares.taken_by == r).sum())} of the {able} holes it can drill"
        )
        lines.append(Text(f"{text}; {how_deep(job.settings)}"))
    left = int((shares.taken_by < 0).sum())
    if left:
        lines.append(Text(f"{left} holes are drilled by none", style="yellow"))
    if not np.isnan(shares.least):
        lines.append(Text(f"least margin of the holes that are taken: {mm(shares.least):+.1f} mm", style="green"))
    return lines
