"""What is shown before anything is opened."""

from __future__ import annotations

from nicegui import ui

from zerorev.web.session import Session
from zerorev.web.views.opener import open_demo, pick_file

__all__ = ["empty"]

EXAMPLE = """\
robot: kuka_kr6_r700_2
tool: thesis_drill
holes:
  - id: first
    target_mm: [500, 300, 800]   # bottom of the hole
    direction: [1, 0, 0]         # into the material
    depth_mm: 50
"""


def empty(session: Session) -> None:
    """Say what this is, and offer to open something.

    Args:
        session: that is to show what is opened.
    """
    with ui.element("main").classes("zr-empty"):
        ui.html("<h1>Drill without a joint reversing</h1>", sanitize=False)
        ui.label(
            "A robot that drills turns its joints back when it pulls the drill out, and each time the tool kicks. "
            "zerorev finds how to spin the drill about its own axis on the way in and out so that every joint keeps "
            "its direction, shows you why, and lets you steer it by hand."
        ).classes("zr-lead")
        with ui.element("div").classes("zr-row"):
            ui.button("Open the demo", icon="play_arrow", on_click=lambda: open_demo(session)).props(
                'unelevated no-caps data-testid="demo"'
            )
            file = ui.button("Open a job or a plan …", icon="folder_open").props(
                'outline no-caps data-testid="open-file"'
            )
            pick_file(session, file)
        with ui.element("div").classes("zr-example"):
            ui.label("A job is a text file like this one (YAML), its holes in a list or a CSV file:").classes(
                "zr-muted"
            )
            ui.html(f"<pre>{EXAMPLE}</pre>", sanitize=False)
        ui.label("Everything stays on this machine.").classes("zr-muted")
