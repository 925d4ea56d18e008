"""The line that says how the selected hole stands."""

from __future__ import annotations

from html import escape

from nicegui import ui

from zerorev.model.job import Job
from zerorev.motion.drilling import Drilling
from zerorev.report.scene.motion_look import look
from zerorev.report.words.headline import Headline, headline
from zerorev.web.session import Session
from zerorev.web.state import State, selected, shown, with_stroke
from zerorev.web.throttle import throttled

__all__ = ["summary"]

MARKS = {"good": "✓", "warn": "!", "bad": "✕", "plain": "○"}
FIGURES = ("travel", "slowest joint", "depth", "margin", "branch")


def summary(session: Session) -> None:
    """Draw the line, with the way to the hole before and the one after.

    Args:
        session: whose selected hole is described.
    """
    with ui.element("div").classes("zr-summary"):
        with ui.element("div").classes("zr-hole"):
            _step(session, -1, "chevron_left", "the hole before")
            with ui.element("div"):
                name, place = ui.label().classes("zr-hole-name"), ui.label().classes("zr-muted")
            _step(session, 1, "chevron_right", "the next hole")
        _strokes(session)
        with ui.element("div").classes("zr-count").props('role="status" aria-label="reversals"'):
            count = ui.html(sanitize=False).props('data-testid="summary-reversals"')
            ui.label("reversals").classes("zr-unit")
        with ui.element("dl").classes("zr-figures"):
            cells = {}
            for figure in FIGURES:
                with ui.element("div"):
                    ui.html(f"<dt>{figure}</dt>", sanitize=False)
                    cells[figure] = ui.html(tag="dd", sanitize=False)
        verdict = ui.html(sanitize=False).props('data-testid="verdict"')
        why = ui.label().classes("zr-why")

    def draw() -> None:
        job, hole = session.state.job, session.state.hole
        if job is None or hole is None:
            return
        line = _headline(session.state, job)
        name.set_text(hole.id)
        name.props["title"] = hole.id
        number = next(n for n, each in enumerate(job.holes, 1) if each is hole)  # `index` would compare their arrays
        place.set_text(f"hole {number} of {len(job.holes)}" if len(job.holes) > 1 else "one hole")
        count.set_content(_count(line))
        for figure, text in zip(FIGURES, _figures(line), strict=True):
            cells[figure].set_content(text)
        verdict.set_content(f'<span class="zr-chip zr-{line.tone}"><b>{MARKS[line.tone]}</b> {line.verdict}</span>')
        why.set_text(_why(session.state, line))

    soon = throttled(draw)

    def changed(before: State, after: State) -> None:
        if before.steered is not after.steered:
            soon()
        elif any(getattr(before, name) is not getattr(after, name) for name in ("job", "selected", "answer", "stroke")):
            draw()

    draw()
    session.watch(changed)


def _strokes(session: Session) -> None:
    """Which stroke of the hole is shown, where it is drilled in several."""

    def chosen(number: int | None) -> None:
        if number is not None:
            session.change(with_stroke(session.state, number))

    choice = ui.select({0: ""}, on_change=lambda event: chosen(event.value)).classes("zr-choice")
    choice.props('outlined dense options-dense aria-label="stroke that is shown" data-testid="stroke"')

    def draw(state: State) -> None:
        strokes = state.answer.strokes if state.answer else ()
        choice.set_visibility(bool(strokes))
        names = {n: f"stroke {n + 1}, {stroke.answer.hole.depth * 1e3:.6g} mm" for n, stroke in enumerate(strokes)}
        if strokes:
            choice.set_options(names, value=min(state.stroke, len(strokes) - 1))

    def changed(before: State, after: State) -> None:
        if before.answer is not after.answer or before.stroke != after.stroke:
            draw(after)

    draw(session.state)
    session.watch(changed)


def _why(state: State, line: Headline) -> str:
    """What is said of the motion that is shown; of one by hand the map says the rest."""
    if state.steered is None:
        return line.why
    strokes = state.answer.strokes if state.answer else ()
    return f"the hole is drilled in {len(strokes)} strokes: one by hand cannot be kept" if strokes else ""


def _headline(state: State, job: Job) -> Headline:
    hole, motion = state.hole, shown(state)
    assert hole is not None
    by_hand = None
    if state.steered is not None:
        by_hand = look(Drilling.of(job, hole), state.steered.profile, state.steered.branch, job.settings)
    branch = None if motion is None else motion.branch
    return headline(hole, state.answer, job.robot.joint_names, job.settings, by_hand, branch)


def _count(line: Headline) -> str:
    after = "–" if line.after is None else str(line.after)
    before = "?" if line.before is None else str(line.before)
    tone = "plain" if line.after is None else "warn" if line.after else "good"
    arrow = f'<span class="zr-before" title="with constant spin">{before}</span><span class="zr-arrow">→</span>'
    return f'{arrow}<span class="zr-after zr-{tone}">{after}</span>'


def _figures(line: Headline) -> tuple[str, ...]:
    slow = "–" if line.slowest is None else f"{line.slowest[0]:.4f} <i>deg/mm</i> {escape(line.slowest[1])}"
    return (
        "–" if line.travel is None else f"{line.travel:.1f} <i>deg</i>",
        slow,
        f"{line.depth:.4g} <i>mm</i>",
        "–" if line.margin is None else f"{line.margin:+.1f} <i>mm</i>".replace("-", "−"),
        "–" if line.branch is None else str(line.branch),
    )


def _step(session: Session, by: int, icon: str, words: str) -> None:
    def step() -> None:
        state = session.state
        if state.job is not None:
            ids = [hole.id for hole in state.job.holes]
            at = ids.index(state.selected) if state.selected in ids else 0
            session.change(selected(state, ids[(at + by) % len(ids)]))

    button = ui.button(icon=icon, on_click=step, color=None).classes("zr-quiet").props("flat round dense")
    button.props(f'aria-label="{words}" data-testid="hole-{"next" if by > 0 else "before"}"')
