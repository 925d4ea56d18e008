"""`zerorev view`: the app, a page on the user's own machine."""

from __future__ import annotations

from pathlib import Path

from zerorev.cli.common import FINE, Whole, app, need
from zerorev.report.words import terminal

__all__ = ["view"]


@app.command
def view(
    what: Path | None = None, /, *, port: Whole | None = None, no_browser: bool = False, urdf: Path | None = None
) -> int:
    """See the holes and steer the motions: open the app in the browser. It is served to this machine alone.

    The address holds a token, without which the app answers to nobody. It runs until Ctrl-C.

    Args:
        what: A job file (YAML), a plan file (JSON) or the folder of a workspace map (zarr); by default a demo, the
            three positions at which the thesis drilled.
        port: The port to serve it on; by default 8780, or a free one where that is taken.
        no_browser: Only print the address, and open nothing.
        urdf: Description of the robot of what is opened (URDF), whose meshes are shown; they lie in the same folder, or
            in a folder above it that is called as the package they name (package://).
    """
    need("nicegui", "nicegui", "view", "view")
    if urdf is not None:
        need("trimesh", "trimesh", "--urdf", "view")

    from zerorev.web.opening import demo, opened, with_meshes

    with terminal.busy("opening"):
        state = demo() if what is None else opened(what)
        state = state if urdf is None else with_meshes(state, urdf)

    from zerorev.web.server import serve

    serve(state, port=port, browser=not no_browser, say=_say)
    return FINE


def _say(address: str) -> None:
    terminal.say(address)
    terminal.note("the app is served to this machine alone; Ctrl-C ends it")
