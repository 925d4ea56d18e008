"""What is said of the predicted lost motion at the tip, wherever it is shown."""

from __future__ import annotations

from zerorev.files.units import mm
from zerorev.model.plan import LostMotion

__all__ = ["GUESSED", "HEADING", "PREDICTED", "WHERE_IT_HOLDS", "lost_motion_cell", "lost_motion_words"]

HEADING = "lost motion\n(swapped) [mm]"
PREDICTED = "at the tip, in brackets with the legs swapped; friction, stiffness and gap of the gears are guesses"

GUESSED = (
    "Friction, stiffness and gap of the gears are guesses, not facts of the robot: the prediction tells better motions "
    "from worse ones and states no gain."
)
WHERE_IT_HOLDS = (
    "The gain of the thesis holds without thrust, or where a foot on the part takes the thrust while the arm moves, "
    "and such a foot must let the tool turn; an end effector with a feed axis of its own holds the arm still while it "
    "drills, and there this method has nothing to give but the choice of posture."
)


def lost_motion_words(lost: LostMotion | None) -> tuple[str, str]:
    """The predicted lost motion at the tip [mm], of a motion and with its legs swapped; a dash where there is none."""
    return _mm(None if lost is None else lost.at_tip), _mm(None if lost is None else lost.twin_at_tip)


def lost_motion_cell(lost: LostMotion | None) -> str:
    """The same as it stands in a table, under `HEADING`."""
    here, swapped = lost_motion_words(lost)
    return "–" if lost is None else f"{here} ({swapped})"


def _mm(value: float | None) -> str:
    return "–" if value is None else f"{mm(value):.3f}"
