"""The panel "on a real arm": what possible arms are predicted to make of the motion that is shown."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from nicegui import ui

from zerorev.cell.followed import dynamics_of
from zerorev.errors import InputError
from zerorev.motion.drilling import Drilling
from zerorev.motion.loads import twins_lost_motion
from zerorev.report.words.lost_motion import GUESSED, lost_motion_words
from zerorev.web.computing import Work
from zerorev.web.real_arm import Simulated
from zerorev.web.session import Session
from zerorev.web.state import State, Steered, shown
from zerorev.web.throttle import throttled
from zerorev.web.views.arm_charts import stray_options, torque_options
from zerorev.web.views.arm_form import ask, asked_of
from zerorev.web.views.arm_words import figures, notes, stands
from zerorev.web.views.chart import Chart

__all__ = ["real_arm"]

STATIC = Path(__file__).parents[1] / "static"
KEYS = """<span class="zr-key-arm"></span>this motion <span class="zr-key-constant"></span>constant spin
<span class="zr-key-band"></span>5 to 95 % of the arms <span class="zr-key-ring"></span>torque changes sign"""
MISSING = (
    "Write them into a robot file of your own, under dynamics: payload_kg, and for each of the six links mass_kg, "
    "com_mm, inertia_kgm2 and frame, as the maker's description (URDF) of the arm has them."
)


def real_arm(session: Session, work: Work) -> None:
    """Draw the panel; for a robot without masses, what is missing and where to write it.

    Args:
        session: whose motion is simulated.
        work: what it is simulated in.
    """
    ui.add_css(STATIC / "real_arm.css")
    assert session.state.job is not None
    try:
        dynamics_of(session.state.job.robot)
    except InputError as error:
        missing = ui.label(f"{error.what[0].upper()}{error.what[1:]}. {MISSING}").classes("zr-arm-missing")
        missing.props('data-testid="arm-missing"')
        return
    ui.html(KEYS, sanitize=False).classes("zr-curve-keys").props('aria-hidden="true"')
    with ui.element("div").classes("zr-arm-parts zr-arm-empty") as parts:
        with ui.element("div").classes("zr-arm-left"):
            form = ask(session, work)
            with ui.element("div").classes("zr-arm-figures"):
                _lost(session, form)
                table = ui.html(sanitize=False).props('data-testid="arm-figures"')
        stray = Chart("how far the tip strays along the path, in this motion and at constant spin", "arm-stray")
        torques = Chart("torques of the six drives along the path, in this motion and at constant spin", "arm-torques")
        words = ui.html(sanitize=False).classes("zr-arm-notes").props('data-testid="arm-notes"')
    _shown(session, parts, table, (stray.classes("zr-arm-stray"), torques.classes("zr-arm-torque")), words)


def _shown(session: Session, parts: ui.element, table: ui.html, charts: tuple[Chart, Chart], words: ui.html) -> None:
    """Keep the figures and curves of the hole's last simulation up to date, and whether they still hold."""
    stray, torques = charts
    drawn: list[Simulated | None] = []

    def draw() -> None:
        state = session.state
        if state.job is None:
            return
        found = state.arm.simulated.get(state.selected or "")
        of, old = stands(found, state)
        table.set_content(figures(found, of, old))
        words.set_content(notes(found, state))
        for chart in charts:
            chart.classes(add="zr-arm-old" if old else "", remove="" if old else "zr-arm-old")
        parts.classes(add="zr-arm-empty" if found is None else "", remove="" if found is None else "zr-arm-empty")
        if not drawn or drawn[0] is not found:
            drawn[:] = [found]
            stray.show(stray_options(found))
            torques.show(torque_options(found, state.job.robot.joint_names))

    soon = throttled(draw)

    def changed(before: State, after: State) -> None:
        if _moved(before, after) or before.arm is not after.arm:
            soon()

    draw()
    session.watch(changed)


def _lost(session: Session, form: Mapping[str, ui.input]) -> None:
    """The predicted lost motion, in closed form: also while a motion is dragged."""
    with ui.element("div").classes("zr-arm-lost").props('role="status"').tooltip(GUESSED):
        ui.label("lost motion, predicted").classes("zr-muted")
        here = ui.label().props('data-testid="arm-lost"')
        twin = ui.label().classes("zr-muted").props('data-testid="arm-lost-twin"')

    def draw(motion: Steered | None) -> None:
        job, hole = session.state.job, session.state.hole
        if job is None or hole is None:
            return
        asked, _ = asked_of({name: field.value for name, field in form.items()}, job.settings)
        thrust = job.settings.thrust if asked is None else asked.thrust
        lost = None
        if motion is not None:
            drilling = Drilling.of(job, hole)
            lost = twins_lost_motion(drilling, motion.profile, motion.branch, thrust)
        own, swapped = lost_motion_words(lost)
        here.set_text(f"{own} mm" + (f" with {thrust:g} N" if thrust else ""))
        twin.set_text(f"legs swapped {swapped} mm")

    draw(shown(session.state))
    session.watch(lambda before, after: draw(shown(after)) if _moved(before, after) else None)
    session.hear("steer", draw)
    form["thrust"].on_value_change(lambda: draw(shown(session.state)))


def _moved(before: State, after: State) -> bool:
    """Whether another motion is shown, or of another hole or job."""
    return any(
        getattr(before, name) is not getattr(after, name) for name in ("steered", "answer", "hole", "stroke", "job")
    )
