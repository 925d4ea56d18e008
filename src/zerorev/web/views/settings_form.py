"""How the job is planned and run: each setting with its unit, and what is wrong with it beside it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nicegui import ui

from zerorev.errors import InputError
from zerorev.model.conversion import settings_data, settings_from
from zerorev.model.job import Job, Settings
from zerorev.model.schema import SettingsForm
from zerorev.model.text import Document, FieldPath
from zerorev.model.validation import problems
from zerorev.web.session import Session
from zerorev.web.state import with_settings
from zerorev.web.views.fields import Fields, ends, form, group, number

__all__ = ["settings_dialog", "settings_of"]

AS_IN_FILE = "weights"
OBJECTIVES = {
    "travel": "least joint travel",
    "margin": "greatest slowest motion",
    "plunge_rotation": "least spin during the plunge",
}
RULES = {"pointwise": "at every point", "mean": "on the average of each leg"}
LEGS = {"straight": "straight: spin even along each leg", "free": "free: spin varies along the axis"}
DEPTHS = {False: "at the target, depth lost to the blend", True: "deeper, so that the depth is met"}
MAY_BE_EMPTY = ("psi_bound_deg", "blend_shortfall_mm", "spindle_rpm")


def settings_dialog(session: Session) -> Callable[[], None]:
    """A form of the settings.

    Args:
        session: whose job they are of.
    """
    dialog, card, _ = form("Settings", "settings-form")
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
        weighted = {AS_IN_FILE: "weighted, as the file has it"} if job.settings.weights else {}
        fields["objective",].set_options(OBJECTIVES | weighted)
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
    with group("What a reversal of each joint costs", "zr-six"):
        for n in range(6):
            fields.text(("reversal_weights", n), f"joint {n + 1}", f"weight-{n + 1}")
    fields.note("reversal_weights")


def _run(fields: Fields) -> None:
    with group("How it is run", "zr-two"):
        fields.text(("blend_mm",), "blend at the corner [mm]", "blend")
        fields.text(("blend_shortfall_mm",), "depth lost to it [mm]", "shortfall", placeholder="half of the blend")
        fields.choice(("deepen_corner",), "the corner lies", "deepen", DEPTHS)
        fields.text(("lead_in_mm",), "lead-in [mm]", "lead-in")
        fields.text(("feed_mm_s", "plunge"), "feed of the plunge [mm/s]", "feed-plunge")
        fields.text(("feed_mm_s", "retract"), "feed of the retract [mm/s]", "feed-retract")
        fields.text(("spindle_rpm",), "spindle [rev/min]", "spindle", placeholder="not known")


def _shown(path: FieldPath, data: dict[str, Any]) -> Any:
    """What stands in the field of a setting."""
    value: Any = data
    for part in path:
        value = value[part]
    if isinstance(value, dict):
        return AS_IN_FILE
    return "" if value is None else f"{value:.10g}" if isinstance(value, float) else value


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
    for path, value in values.items():
        if path == ("objective",) and value == AS_IN_FILE:
            continue
        into: Any = data
        for part in path[:-1]:
            into = into[part]
        into[path[-1]] = None if path[0] in MAY_BE_EMPTY and value == "" else value
    if wrong := problems(SettingsForm, Document("", data)):
        return None, wrong
    try:
        settings = settings_from(SettingsForm.model_validate(data))
    except InputError as error:
        at = next((path for path in values if str(path[0]).startswith(error.where)), ())
        return None, [(at, error)]
    return (job.settings if data == settings_data(job.settings) else settings), []
