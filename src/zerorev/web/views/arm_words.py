"""What the panel "on a real arm" says of a simulation: its figures, whether they still hold, what they rest on."""

from __future__ import annotations

from html import escape

import numpy as np

from zerorev.cell.ensemble import SIDES, Band, band
from zerorev.model.units import DEG, MM
from zerorev.report.scene.study_curves import DRAWN, SIDE_WORDS
from zerorev.report.words.lost_motion import WHERE_IT_HOLDS
from zerorev.report.words.study import kept_words, rests_on, thrust_words
from zerorev.web.real_arm import Simulated, outdated
from zerorev.web.state import State, shown
from zerorev.web.views.arm_charts import MOTIONS

__all__ = ["figures", "notes", "stands"]

TERMS = {
    "encoder": "what a controller's trace shows: computed from the angles of the motors",
    "tool": "where the tip really is: no encoder sees what the gears do",
    "gain": "how much less the tip strays, in the middle half of its path, than at constant spin on the same arm",
    "speed": "greatest speed of the tip along the axis: what a joint, a drive or the spin cannot follow is slowed",
}
NONE = (
    "Not simulated yet. Simulate runs this motion, and the same hole at constant spin, on many arms as they may be: "
    "friction, stiffness and lost motion of the gears, the controller."
)
SLOWER = 0.98  # of the speed of the other


def stands(found: Simulated | None, state: State) -> tuple[str, bool]:
    """What a simulation is of, and whether it is of something else than what is shown.

    Args:
        found: the last of the hole.
        state: of the page.
    """
    if found is None:
        return NONE, False
    asked, done, arms = found.asked, found.study.sets, len(found.arms.sets)
    count = f"{done:,} arms" if done == arms else f"{done:,} of {arms:,} arms so far"
    feed = "feeds as planned" if asked.feed is None else f"{MM.outside(asked.feed):g} mm/s"
    of = f"{count}, seed {asked.seed}, {feed}, thrust {asked.thrust:g} N."
    changed = outdated(found, state, shown(state))
    return (of, False) if changed is None else (f"Out of date: {changed}. Simulate again. ({of})", True)


def figures(found: Simulated | None, words: str, old: bool) -> str:
    """The figures as a table.

    Args:
        found: the last of the hole.
        words: what it is of.
        old: whether it is out of date.
    """
    said = f'<p data-testid="arm-stands" class="{"zr-warn" if old else "zr-muted"}" role="status">{escape(words)}</p>'
    if found is None:
        return said
    rows = []
    for k, side in enumerate(SIDES):
        deviations = (found.study.deviation[found.study.of(motion), k] for motion in DRAWN)
        cells = [_banded(band(values), 1e3, 3) for values in deviations]
        cells.append(_banded(band(found.study.gain()[k]), 100, 0, " %"))
        rows.append(_row(f"{SIDE_WORDS[side]} [mm]", TERMS[side], cells))
    speeds = (float(MM.outside(found.study.speed[found.study.of(motion)])) for motion in DRAWN)
    rows.append(_row("speed reached [mm/s]", TERMS["speed"], [*(f"<b>{speed:.1f}</b>" for speed in speeds), ""]))
    heads = "".join(f"<th>{MOTIONS[motion]}</th>" for motion in DRAWN)
    head = f'<tr><td></td>{heads}<th title="{TERMS["gain"]}" class="zr-term">gain</th></tr>'
    return f"{said}<table><thead>{head}</thead><tbody>{''.join(rows)}</tbody></table>"


def notes(found: Simulated | None, state: State) -> str:
    """What the figures rest on, and where they hold.

    Args:
        found: the last of the hole.
        state: of the page.
    """
    job, motion = state.job, shown(state)
    if job is None:
        return ""
    cell = state.arm.cell if found is None else found.cell
    thrust = job.settings.thrust if found is None else found.asked.thrust
    lines = [("", rests_on(cell, job.tool))]
    if found is not None and (kept := kept_words(found.arms)) is not None:
        lines.append(("", f"{kept[0].upper()}{kept[1:]}."))
    if found is not None:
        base, here = (found.study.speed[found.study.of(each)] for each in DRAWN)
        if min(base, here) < SLOWER * max(base, here):
            lines.append(("zr-warn", "The two motions are not equally fast: compare them at a feed that both can run."))
    if thrust > 0:
        lines.append(("zr-warn", thrust_words(thrust)))
    turns = "" if motion is None else f" In this motion the tool turns by {_turn(motion.profile.psi)} against the part."
    lines.append(("", f"{WHERE_IT_HOLDS}{turns}"))
    return "".join(f'<p class="{look}">{escape(line)}</p>' for look, line in lines)


def _turn(psi: np.ndarray) -> str:
    return f"{DEG.outside(float(np.ptp(psi))):.0f} deg"


def _row(name: str, term: str, cells: list[str]) -> str:
    return f'<tr><th title="{term}" class="zr-term">{name}</th>{"".join(f"<td>{cell}</td>" for cell in cells)}</tr>'


def _banded(values: Band, scale: float, digits: int, unit: str = "") -> str:
    median, low, high = (f"{value * scale:.{digits}f}".replace("-", "−") for value in values)
    return f"<b>{median}{unit}</b><i>{low} to {high}</i>"
