"""How the job is planned and run: each setting with its unit, and what is wrong with it beside it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import ui

from zerorev.errors import InputError
from zerorev.files.conversion import settings_data, settings_from
from zerorev.files.schema import SettingsForm
from zerorev.files.text import Document, FieldPath
from zerorev.files.validation import problems
from zerorev.model.job import Job, Settings
from zerorev.web.session import Session
from zerorev.web.state import with_settings
from zerorev.web.views.fields import Fields, ends, form, group, number

__all__ = ["settings_dialog", "settings_of"]

WEIGHTED = "weights"
OBJECTIVES = {
    "travel": "least joint travel",
    "margin": "greatest slowest motion",
    "plunge_rotation": "least spin during the plunge",
    WEIGHTED: "a weighted sum of criteria",
}
CRITERIA_WORDS = {
    "travel": "joint travel",
    "margin": "slowest joint",
    "plunge_rotation": "spin in the plunge",
    "tool_speed_change": "change of drill speed",
    "limit_distance": "nearness to limits",
    "compliance_axial": "give along the axis",
    "compliance_lateral": "give across the axis",
    "manipulability": "nearness to singularity",
}
RULES = {"pointwise": "at every point", "mean": "on the average of each leg"}
LEGS = {"straight": "straight: spin even along each leg", "free": "free: spin varies along the axis"}
DEPTHS = {False: "at the target, depth lost to the blend", True: "deeper, so that the depth is met"}
LEAD_INS = {False: "it is shortened", True: "the motion is another one"}
MAY_BE_EMPTY = ("psi_bound_deg", "blend_shortfall_mm", "spindle_rpm")
SIX_OR_NONE = ("joint_stiffness_nm_per_rad", "near_joints_deg")


def settings_dialog(session: Session) -> Callable[[], None]:
    """A form of the settings.

    Args:
        session: whose job they are of.
    """
    dialog, card, _ = form("Settings", "settings-form", wide=True)
    fields = Fields()
    with card:
        with ui.element("div").classes("zr-scroll"):
            _motion(fields)
            _run(fields)
        dropped = ui.label().classes("zr-muted")
        fields.line()

    def take() -> None:
        job = session.state.job
        if job is None:
            return
        settings, wrong = settings_of(_values(fields), job)
        if not fields.show(wrong) and settings is not None:
            session.change(with_settings(session.state, settings))
            dialog.close()

    with card:
        ends(dialog, "Take", take)

    def opened() -> None:
        job = session.state.job
        if job is None:
            return
        data = settings_data(job.settings)
        for path, field in fields.items():
            field.set_value(_shown(path, data))
        planned = len(session.state.answers)
        dropped.set_text(
            f"Other settings drop the answers found so far ({planned}); Ctrl-Z brings them back." if planned else ""
        )
        fields.show([])
        dialog.open()

    return opened


def _motion(fields: Fields) -> None:
    with group("What counts as a good motion", "zr-two"):
        fields.text(("min_rate_deg_per_mm",), "motion threshold [deg/mm]", "min-rate")
        fields.choice(("min_rate_rule",), "kept", "min-rate-rule", RULES)
        fields.choice(("objective",), "among equal reversals", "objective", OBJECTIVES)
        fields.text(("psi_bound_deg",), "spins within ± [deg]", "psi-bound", placeholder="no bound")
        fields.choice(("legs",), "legs", "legs-setting", LEGS)
        fields.text(("max_twist_deg_per_mm",), "greatest twist of free legs [deg/mm]", "max-twist")
    with ui.element("div") as weights, group("What weighs how much; 0 or empty: nothing", "zr-four"):
        for name, words in CRITERIA_WORDS.items():
            fields.text(("objective", name), words, f"weigh-{name}")
    weights.bind_visibility_from(fields["objective",], "value", value=WEIGHTED)
    _six(fields, "reversal_weights", "What a reversal of each joint costs", "weight")
    _six(
        fields, "joint_stiffness_nm_per_rad",
        "Stiffness of each joint [N m/rad], for the give at the tip; empty: not known", "stiffness",
    )  # fmt: skip
    _six(
        fields, "near_joints_deg",
        "Angles to which free turns are chosen nearest [deg]; empty: far from the limits", "near",
    )  # fmt: skip


def _six(fields: Fields, key: str, legend: str, name: str) -> None:
    """A field a joint, and below them what is accepted."""
    with group(legend, "zr-six"):
        for n in range(6):
            fields.text((key, n), f"joint {n + 1}", f"{name}-{n + 1}")
    fields.note(key)


def _run(fields: Fields) -> None:
    with group("How it is run", "zr-two"):
        fields.text(("blend_mm",), "blend at the corner [mm]", "blend")
        fields.text(("blend_shortfall_mm",), "depth lost to it [mm]", "shortfall", placeholder="half of the blend")
        fields.choice(("deepen_corner",), "the corner lies", "deepen", DEPTHS)
        fields.text(("lead_in_mm",), "lead-in [mm]", "lead-in")
        fields.choice(("keep_lead_in",), "where a joint would reverse on it", "keep-lead-in", LEAD_INS)
        fields.text(("feed_mm_s", "plunge"), "feed of the plunge [mm/s]", "feed-plunge")
        fields.text(("feed_mm_s", "retract"), "feed of the retract [mm/s]", "feed-retract")
        fields.text(("spindle_rpm",), "spindle [rev/min]", "spindle", placeholder="not known")


def _shown(path: FieldPath, data: dict[str, Any]) -> Any:
    """What stands in the field of a setting."""
    value: Any = data
    for part in path:
        if isinstance(value, dict):
            value = value.get(str(part), "")
        else:  # six numbers, or none; of one criterion that decides alone, no weights
            value = value[part] if isinstance(value, list) and isinstance(part, int) else None
    if isinstance(value, dict):
        return WEIGHTED
    if isinstance(value, float):  # to the last bit, so that what is not touched stays the same
        return short if float(short := f"{value:.10g}") == value else repr(value)
    return "" if value is None else value


def _values(fields: Fields) -> dict[FieldPath, Any]:
    """What stands in the fields; numbers as numbers, where they are any."""
    return {path: number(field.value) if isinstance(field, ui.input) else field.value for path, field in fields.items()}


def settings_of(values: dict[FieldPath, Any], job: Job) -> tuple[Settings | None, list[tuple[FieldPath, InputError]]]:
    """The settings that a user asks for, or what is wrong with them, field by field; those not asked for stay.

    Args:
        values: by their paths in a job file.
        job: whose settings they take the place of.
    """
    data = settings_data(job.settings)
    whole = {str(path[0]): value for path, value in values.items() if len(path) == 1}
    parts: dict[str, dict[Any, Any]] = {}
    for path, value in values.items():
        if len(path) == 2:
            parts.setdefault(str(path[0]), {})[path[1]] = value
    weights = parts.pop("objective", None)
    if whole.get("objective") == WEIGHTED:
        del whole["objective"]
        if weights is not None:
            data["objective"] = {name: value for name, value in weights.items() if value != ""}
    data |= {key: None if key in MAY_BE_EMPTY and value == "" else value for key, value in whole.items()}
    for key, given in parts.items():
        if key in SIX_OR_NONE:
            data[key] = None if all(value == "" for value in given.values()) else [""] * 6
        for part, value in given.items() if data[key] is not None else ():
            data[key][part] = value
    if wrong := problems(SettingsForm, Document("", data)):
        return None, wrong
    try:
        settings = settings_from(SettingsForm.model_validate(data))
    except InputError as error:
        at = next((path for path in values if str(path[0]).startswith(error.where)), ())
        return None, [(at, error)]
    return (job.settings if data == settings_data(job.settings) else settings), []
