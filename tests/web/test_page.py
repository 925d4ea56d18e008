"""The page without a browser: which parts it has, and when it is drawn again."""

from __future__ import annotations

import asyncio
import gc
import weakref
from dataclasses import replace
from pathlib import Path

import pytest

pytest.importorskip("nicegui")

from nicegui import Client, core, ui
from nicegui.awaitable_response import NullResponse
from nicegui.page import page as page_of

from zerorev.web import page
from zerorev.web.computing import Work
from zerorev.web.job_edits import without_hole
from zerorev.web.opening import demo
from zerorev.web.session import Session
from zerorev.web.state import State, opened_job, selected

CSS = (Path(page.__file__).parent / "static" / "zerorev.css").read_text(encoding="utf-8")


class Slow:
    """What a browser says that has too much to do; most do not wait for it."""

    def __init__(self, *_, **__):
        pass

    def __await__(self):
        yield from asyncio.sleep(0.03).__await__()
        raise TimeoutError


def picture(monkeypatch, name, view):
    """Have a view take the place of one of the page's pictures."""
    pictures = [(each, title, view if each == name else old) for each, title, old in page.PICTURES]
    monkeypatch.setattr(page, "PICTURES", pictures)


@pytest.fixture
def shown(monkeypatch):
    """Run edits with the page of a state on it: ids of its parts after each of them, and what was to be planned."""
    planned = []
    monkeypatch.setattr(page, "plan_selected", lambda _: planned.append("a hole"))
    monkeypatch.setattr(Client, "run_javascript", lambda *_, **__: NullResponse())
    for name in ("twist-map", "cell"):  # their own tests answer for what they do once they are there
        picture(monkeypatch, name, lambda _, name=name: ui.element().props(f"data-testid={name}"))

    def run(state, *edits):
        session, parts = Session(state), []

        async def main():
            monkeypatch.setattr(core, "loop", asyncio.get_running_loop())
            with Client(page_of("/")) as client:
                page.build(session, Work(session))
                for edit in (lambda _: None, *edits):
                    edit(session)
                    await asyncio.sleep(0.02)
                    parts.append({each.props.get("data-testid") for each in client.elements.values()} - {None})

        asyncio.run(main())
        return session, parts, len(planned)

    return run


def test_nothing_opened_offers_the_demo_and_a_file(shown):
    _, (parts,), planned = shown(State())
    assert {"demo", "open-file", "theme"} <= parts
    assert "holes" not in parts
    assert not planned


def test_a_job_has_all_of_its_parts_and_its_first_hole_is_planned(shown):
    _, (parts,), planned = shown(demo())
    assert {
        "summary-reversals",
        "verdict",
        "plan",
        "bracket",
        "curves",
        "holes",
        "findings",
        "undo",
        "settings",
    } <= parts
    assert "demo" not in parts
    assert planned == 1


@pytest.mark.parametrize("state", [State(), demo()])
def test_a_page_that_is_left_leaves_nothing_of_its_session(shown, state):
    """Nothing keeps it but what keeps the tabs (`zerorev.web.pages`): no route, no task, no view."""
    left = [weakref.ref(shown(state, lambda _: ui.context.client.delete())[0]) for _ in range(3)]
    gc.collect()
    assert [ref() for ref in left] == [None] * 3


@pytest.mark.parametrize("known", [True, False])
def test_on_a_real_arm_something_is_simulated_where_its_masses_are_known(shown, known):
    job = demo().job
    robot = job.robot if known else replace(job.robot, dynamics=None)
    _, (*_, parts), _ = shown(opened_job(replace(job, robot=robot)), *[lambda _: None] * 5)
    assert ("simulate" in parts, "arm-missing" in parts) == (known, not known)


def test_the_holes_are_there_before_the_pictures_and_no_form_before_it_is_opened(shown, monkeypatch):
    seen = {}

    def holes(session):
        seen["at once"] = {each.props.get("data-testid") for each in ui.context.client.elements.values()}

    monkeypatch.setattr(Client, "run_javascript", Slow)
    _, (*_, last), _ = shown(demo(), holes, *[lambda _: None] * 10)
    assert "holes" in seen["at once"]
    assert not {"twist-map", "cell", "bracket", "curves"} & seen["at once"]
    assert {"twist-map", "cell", "bracket", "curves"} <= last
    assert not {"settings-form", "hole-form", "paste-form"} & last


def test_a_page_that_is_drawn_again_before_it_is_complete_has_each_picture_once(shown, monkeypatch):
    def count(session):
        names = [each.props.get("data-testid") for each in ui.context.client.elements.values()]
        assert [names.count(name) for name in ("twist-map", "cell", "bracket", "curves")] == [1] * 4

    def reopen(session):
        session.change(opened_job(demo().job))

    monkeypatch.setattr(Client, "run_javascript", Slow)
    shown(demo(), reopen, *[lambda _: None] * 10, count)


def test_a_picture_with_a_fault_says_so_and_the_others_are_drawn(shown, monkeypatch, caplog):
    def faulty(session):
        raise RuntimeError("on purpose")

    def said(session):
        texts = [getattr(each, "text", "") for each in ui.context.client.elements.values()]
        assert texts.count("This could not be drawn: a fault in zerorev itself. The terminal says more.") == 1

    picture(monkeypatch, "cell", faulty)
    _, (parts, _), _ = shown(demo(), said)
    assert {"twist-map", "bracket", "curves"} <= parts
    assert "on purpose" in caplog.text


def test_a_hole_without_an_answer_is_planned_when_it_is_selected(shown):
    _, _, planned = shown(demo(), lambda session: session.change(selected(session.state, "position_2")))
    assert planned == 2


def test_another_file_draws_the_page_again_and_no_part_of_the_old_one_is_called(shown):
    views = []

    def reopen(session):
        old = list(session._views)
        session.change(opened_job(demo().job))
        views.extend(view for view in old if view in session._views)

    _, (before, after), _ = shown(demo(), reopen)
    assert before == after
    assert len(views) == 1  # the page itself


def test_from_nothing_to_a_job_and_an_edit_keeps_the_page(shown):
    seen = []

    def edit(session):
        seen.append(list(session._views))
        session.change(without_hole(session.state, "position_1"))
        seen.append(list(session._views))

    session, parts, _ = shown(State(), lambda session: session.change(demo()), edit)
    assert "holes" in parts[1]
    assert seen[0] == seen[1]
    assert session.state.selected == "position_2"


def test_names_out_of_a_file_are_never_markup(shown):
    state = demo()
    job = replace(state.job, name="<img src=x>", holes=(replace(state.job.holes[0], id="<b>h</b>"),))

    def contents(session):
        for each in ui.context.client.elements.values():
            assert "<img" not in str(each.props.get("innerHTML", ""))
            assert "<b>h" not in str(each.props.get("innerHTML", ""))

    shown(opened_job(job), contents)


def test_light_and_dark_name_the_same_colours_and_letters_can_be_read():
    light, dark = (_colours(CSS, start) for start in (":root {", "body.body--dark {"))
    assert set(dark) <= set(light)
    for theme in (light, {**light, **dark}):
        for ink in ("ink", "muted", "accent", "good", "warn", "bad"):
            for ground in ("surface", "page"):
                assert _contrast(theme[ink], theme[ground]) >= 4.5, (ink, ground)
        assert _contrast(theme["on-accent"], theme["accent"]) >= 4.5
        for tone in ("good", "warn", "bad"):
            assert _contrast(theme[tone], theme[f"{tone}-wash"]) >= 4.5


def _colours(css, start):
    block = css[css.index(start) :]
    pairs = (line.split(":") for line in block[: block.index("}")].splitlines() if "--zr-" in line and "#" in line)
    return {name.strip().removeprefix("--zr-"): value.strip(" ;") for name, value in pairs}


def _contrast(one, other):
    """As WCAG 2 has it."""

    def luminance(colour):
        parts = [int(colour[n : n + 2], 16) / 255 for n in (1, 3, 5)]
        linear = [part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    dark, light = sorted((luminance(one), luminance(other)))
    return (light + 0.05) / (dark + 0.05)
