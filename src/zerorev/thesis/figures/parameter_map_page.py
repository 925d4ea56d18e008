"""A parameter map as a page of HTML: a slice to be moved, and the zero-reversal set to be turned; needs no network."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from zerorev.model._arrays import Array
from zerorev.report.figures import style
from zerorev.report.figures.page import embedded, html_page
from zerorev.thesis.figures.parameter_map import MOST, heading, reversal_names
from zerorev.thesis.parameter_map_lines import TURNS

if TYPE_CHECKING:
    from plotly.graph_objects import Figure
    from xarray import Dataset

__all__ = ["map_page"]

MOST_SPINS = 101  # an axis, on the page: more are thinned out, so that it stays some 12 MB
MOST_POINTS = 30_000  # of the set in 3D
EYE = {"eye": {"x": 1.1, "y": -1.7, "z": 0.75}}


def map_page(found: Dataset) -> str:
    """A page of HTML that needs no network: slices of a whole map with a slider, and its zero-reversal set in 3D."""
    sections = (
        ("Slices at a spin at the target", "Move the slider: left the objective (thesis eq. 4.7), right the reversals.",
         embedded(_slices(found))),
        ("Where no joint reverses", "Drag to turn it.", embedded(_volume(found))),
    )  # fmt: skip
    return html_page(f"Parameter map, {TURNS[found.attrs['turns']]}", heading(found), sections)


def _slices(found: Dataset) -> Figure:
    """Objective and reversals side by side, a slider over psi_target."""
    import plotly.graph_objects as go
    from plotly.subplots import make_subplots

    s, t, e = (_thinned(found[f"psi_{word}_deg"].values) for word in ("start", "target", "end"))
    part = found.sel(psi_start_deg=s, psi_target_deg=t, psi_end_deg=e)
    part = part.transpose("psi_target_deg", "psi_end_deg", "psi_start_deg")
    score = part["score"].where(part["reversals"] >= 0).values.astype(np.float32)
    reversals = part["reversals"].values
    first = int(np.abs(t).argmin())

    figure = make_subplots(1, 2, horizontal_spacing=0.17)
    figure.add_trace(
        go.Heatmap(x=s, y=e, z=score[first], zmin=0, zmax=1, colorscale="Cividis",
                   colorbar={"title": "objective [1]", "x": 0.44, "thickness": 12},
                   hovertemplate="start %{x:.1f}°, end %{y:.1f}°: %{z:.4f}<extra></extra>"),
        1, 1,
    )  # fmt: skip
    figure.add_trace(
        go.Heatmap(x=s, y=e, z=reversals[first], zmin=-1.5, zmax=MOST + 0.5, colorscale=_steps(),
                   colorbar={"title": "reversals", "thickness": 12, "tickvals": list(range(-1, MOST + 1)),
                             "ticktext": [name for name, _ in reversal_names()]},
                   hovertemplate="start %{x:.1f}°, end %{y:.1f}°: %{z} reversals<extra></extra>"),
        1, 2,
    )  # fmt: skip
    figure.update_xaxes(title="ψ at the start [deg]", constrain="domain", dtick=90, showgrid=False, zeroline=False)
    figure.update_yaxes(
        title="ψ at the end [deg]", constrain="domain", dtick=90, showgrid=False, zeroline=False, scaleratio=1
    )
    figure.update_layout(yaxis_scaleanchor="x", yaxis2_scaleanchor="x2")
    figure.frames = [
        go.Frame(name=f"{psi:.1f}", traces=[0, 1], data=[go.Heatmap(z=score[k]), go.Heatmap(z=reversals[k])])
        for k, psi in enumerate(t)
    ]
    move = {"mode": "immediate", "frame": {"duration": 0, "redraw": True}, "transition": {"duration": 0}}
    steps = [{"method": "animate", "label": f"{psi:.1f}", "args": [[f"{psi:.1f}"], move]} for psi in t]
    current = {"prefix": "ψ at the target: ", "suffix": " deg"}
    figure.update_layout(
        sliders=[{"active": first, "steps": steps, "currentvalue": current, "pad": {"t": 50}}], width=1150, height=640,
        template="plotly_white", plot_bgcolor=style.CANNOT_RUN, margin={"t": 20},
    )  # fmt: skip
    return figure


def _volume(found: Dataset) -> Figure:
    """The cells without reversals as points, coloured by travel."""
    import plotly.graph_objects as go

    zero = np.argwhere(found["reversals"].values == 0)
    zero = zero[:: -(-len(zero) // MOST_POINTS) or 1]
    t, s, e = (found[name].values[column] for name, column in zip(found["score"].dims, zero.T, strict=True))
    travel = found["travel_deg"].values[tuple(zero.T)]
    points = go.Scatter3d(
        x=s, y=e, z=t, mode="markers", customdata=travel,
        marker={"size": 2.5, "color": travel, "colorscale": "Cividis", "colorbar": {"title": "travel [deg]"}},
        hovertemplate="start %{x:.1f}°, target %{z:.1f}°, end %{y:.1f}°: %{customdata:.1f}° of travel<extra></extra>",
    )  # fmt: skip
    axes = {
        name: {"title": f"ψ at the {word} [deg]", "range": [float(psi.min()), float(psi.max())], "dtick": 90}
        for name, word in (("xaxis", "start"), ("yaxis", "end"), ("zaxis", "target"))
        for psi in [found[f"psi_{word}_deg"].values]
    }
    figure = go.Figure(points)
    figure.update_layout(
        scene=axes | {"aspectmode": "cube", "camera": EYE}, width=1000, height=800, template="plotly_white"
    )
    return figure


def _thinned(values: Array) -> Array:
    """Every so-manieth value, the first among them."""
    return np.asarray(values[:: -(-len(values) // MOST_SPINS)])


def _steps() -> list[tuple[float, str]]:
    """The colours of the classes of reversals, with hard edges between them."""
    colours = [colour for _, colour in reversal_names()]
    return [(k / len(colours), colour) for n, colour in enumerate(colours) for k in (n, n + 1)]
