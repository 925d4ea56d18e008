"""One HTML file that plays the motions of a plan: to be sent to a colleague, opened from disk, with no network."""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Sequence
from html import escape
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from zerorev.errors import InputError
from zerorev.files.units import deg, deg_per_mm, mm
from zerorev.model.plan import HolePlan, Plan
from zerorev.model.strokes import each_stroke
from zerorev.motion.drilling import Drilling
from zerorev.report.scene.cell_data import SAMPLES, arm_data, holes_data, motion_data
from zerorev.report.scene.solids_data import solids_data
from zerorev.report.scene.urdf_meshes import Mesh
from zerorev.report.words.lost_motion import GUESSED, WHERE_IT_HOLDS, lost_motion_words
from zerorev.report.words.tables import hole_findings, slowest

__all__ = ["MOST_HOLES", "replay_page"]

STATIC = Path(__file__).parent / "static"
MODULES = (
    "cell.js",
    "cell_arm.js",
    "cell_around.js",
    "cell_bar.js",
    "cell_copies.js",
    "cell_hands.js",
    "cell_room.js",
    "cell_trace.js",
    "replay.js",
)
MOST_HOLES = 2000
POINTS, FEWEST_SAMPLES = 24_000, 24  # of all motions together, and of one


def replay_page(plan: Plan, ids: Sequence[str] | None = None, meshes: Sequence[Sequence[Mesh]] | None = None) -> str:
    """The whole file: the player, the robot, and the holes with their motions, figures and findings.

    The strokes of a hole are played one after the other, but for the moves between them.

    Args:
        plan: of which; of several tools the first one is shown.
        ids: of the holes, or of single strokes, that are in it, in the order of the plan; None: all of them.
        meshes: of the robot's links, in place of shapes made from its geometry (`report.urdf_meshes`).

    Raises:
        InputError: an unknown id, no hole with a motion, too many holes, or the player's library is not installed.
    """
    chosen = _chosen(plan, ids)
    samples = int(np.clip(POINTS // len(chosen), FEWEST_SAMPLES, SAMPLES))
    holes = list({motion.whole.hole.id: motion.whole for motion in chosen}.values())
    data: dict[str, Any] = {
        "arm": arm_data(plan.robot, plan.tool, meshes),
        "solids": solids_data(plan.robot, plan.tool, plan.settings),
        "scene": holes_data(
            [each.hole for each in holes],
            plan.T_base_part,
            {each.hole.id: each for each in holes},
            shaped=plan.settings.surroundings.part is not None,
        ),
        "holes": [_hole(plan, motion, samples) for motion in chosen],
        "note": f"Lost motion: {GUESSED} {WHERE_IT_HOLDS}" if any(each.answer.lost_motion for each in chosen) else "",
    }
    parts = {
        "title": escape(f"Replay of {plan.name}"),
        "subtitle": escape(f"{data['arm']['robot']}, {_tool(plan)}, {_what(len(holes), len(chosen))}"),
        "version": escape(version("zerorev")),
        "shapes": "the robot's description" if meshes else "its geometry, not from the maker's drawings",
        "style": (STATIC / "replay.css").read_text() + (STATIC / "cell.css").read_text(),
        "imports": _script({"imports": _modules()}),
        "data": _script(data),
    }
    template = (STATIC / "replay.html").read_text()
    return re.sub(r"\{\{(\w+)\}\}", lambda found: parts[found[1]], template)  # once: what is put in is not examined


class _Motion(NamedTuple):
    """What is played at a time: a hole, or one of its strokes, and which of how many that is, from 1."""

    whole: HolePlan
    answer: HolePlan
    number: int
    of: int


def _tool(plan: Plan) -> str:
    """The tool, and that there are others, which are not in the file."""
    others = f" (the first of {len(plan.of_all_tools)})" if plan.further else ""
    return f"tool {plan.tool.name}{others}"


def _what(holes: int, motions: int) -> str:
    return _count(holes, "hole") + (f", {motions:,} strokes" if motions > holes else "")


def _chosen(plan: Plan, ids: Sequence[str] | None) -> list[_Motion]:
    motions = [
        _Motion(hole, answer, number, max(len(hole.strokes), 1))
        for hole in plan.holes
        for number, answer in enumerate(each_stroke(hole), 1)
    ]
    known = {name for motion in motions for name in (motion.whole.hole.id, motion.answer.hole.id)}
    for name in ids or ():
        if name not in known:
            holes = [hole.hole.id for hole in plan.holes]
            few = ", ".join(holes[:6]) + (", ..." if len(holes) > 6 else "")
            raise InputError(f"no hole '{name}' in the plan", where="hole", accepted=few)
    chosen = [motion for motion in motions if ids is None or {motion.whole.hole.id, motion.answer.hole.id} & set(ids)]
    if not any(motion.answer.motion for motion in chosen):
        raise InputError("no motion to replay", where=f"plan {plan.name}", accepted="a planned or evaluated hole")
    if len(chosen) > MOST_HOLES:
        raise InputError(f"{len(chosen):,} holes", where="replay", accepted=f"{MOST_HOLES:,} or less: choose some")
    return chosen


def _hole(plan: Plan, playing: _Motion, samples: int) -> dict[str, Any]:
    answer = playing.answer
    motion, score = answer.motion, answer.score
    played = None
    if motion is not None:
        drilling = Drilling.of(plan, answer.hole)
        played = motion_data(drilling, motion.profile, motion.branch, plan.settings, samples)
    return {
        "id": answer.hole.id,
        "hole": playing.whole.hole.id,
        "stroke": [playing.number, playing.of],
        "verdict": "no motion" if score is None else _count(score.reversals, "reversal"),
        "tone": "bad" if score is None else "warn" if score.reversals else "good",
        "figures": _figures(plan, answer),
        "findings": [[finding.level, finding.message] for finding in hole_findings(answer)],
        "motion": played,
    }


def _figures(plan: Plan, answer: HolePlan) -> list[list[str]]:
    """Rows of a name, the figure of the motion, and that of the same hole drilled with constant spin."""
    motion, score, base = answer.motion, answer.score, answer.baseline
    rows = [["depth [mm]", _number(mm(answer.hole.depth), 2), ""]]
    if motion is None or score is None:
        return rows
    rows.append(["reversals", str(score.reversals), "cannot run" if base is None else str(base.reversals)])
    for i, name in enumerate(plan.robot.joint_names):
        before = 0 if base is None else base.reversals_per_joint[i]
        if before or score.reversals_per_joint[i]:
            rows.append([f"of {name}", str(score.reversals_per_joint[i]), "" if base is None else str(before)])
    rows.append(["travel [deg]", _number(deg(score.travel), 1), "" if base is None else _number(deg(base.travel), 1)])
    if slow := slowest(score, plan.settings):
        text = f"{_number(deg_per_mm(slow[0]), 4)} {plan.robot.joint_names[slow[1]]}"
        rows.append(["slowest joint [deg/mm]", text, ""])
    rows.append(["nearest to a limit [deg]", _number(deg(score.limit_distance.min()), 1), ""])
    spins = [motion.profile.psi[n] for n in (0, motion.profile.corner, -1)]
    rows.append(["spin: start, target, end [deg]", ", ".join(_number(deg(spin), 1) for spin in spins), ""])
    if answer.deepest is not None:
        rows.append(["deepest without reversal [mm]", _number(mm(answer.deepest), 1), ""])
    if answer.lost_motion is not None:
        here, swapped = lost_motion_words(answer.lost_motion)
        rows.append(["lost motion at the tip [mm]", here, ""])
        rows.append(["... with the legs swapped [mm]", swapped, ""])
    if (near := answer.clearance) is not None:
        where = "" if near.standoff is None else f", {mm(near.standoff):.1f} mm out"
        rows.append(["least clearance [mm]", _number(mm(near.least), 2), ""])
        rows.append(["... between", f"{' and '.join(near.between)}{where}", ""])
    verified = answer.verified
    rows.append(["checked", "not yet" if verified is None else "passed" if verified.passed else "FAILED", ""])
    if answer.certificate is not None:
        rows.append(["certificate", answer.certificate.verdict, ""])
    if (within := answer.certified_within) is not None:
        rows.append(["certified within", f"{mm(within.position):.6g} mm, {deg(within.rotation):.6g} deg", ""])
    return rows


def _modules() -> dict[str, str]:
    """What the names of the modules stand for: themselves, written out."""
    found = find_spec("nicegui")  # whose three.js is taken; it is not imported
    if found is None or found.origin is None:
        raise InputError(
            "needs three.js as NiceGUI brings it, which is not installed", where="replay",
            accepted="pip install 'zerorev[view]'",
        )  # fmt: skip
    three = Path(found.origin).parent / "elements" / "scene" / "dist" / "index.js"
    code = {"nicegui-scene": three} | {f"zerorev-cell/{name}": STATIC / name for name in MODULES}
    return {name: f"data:text/javascript;base64,{_base64(path)}" for name, path in code.items()}


def _base64(path: Path) -> str:
    return base64.b64encode(path.read_bytes()).decode("ascii")


def _script(data: Any) -> str:
    """JSON that cannot end the script element it stands in, regardless of the ids of holes."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _count(number: int, what: str) -> str:
    return f"{number:,} {what}{'' if number == 1 else 's'}"


def _number(value: Any, digits: int) -> str:
    return f"{round(float(value), digits) + 0.0:.{digits}f}"
