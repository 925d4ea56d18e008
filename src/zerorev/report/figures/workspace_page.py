"""A workspace map as a page of HTML: a slice to be moved, and the targets around the robot; needs no network."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.colors import to_hex

from zerorev.maps.answers import SAME_DIRECTION, Cells, cells_of
from zerorev.maps.planes import AXES, Across, view_flips
from zerorev.model._arrays import Array
from zerorev.model.quantity import Quantity
from zerorev.report.figures import style
from zerorev.report.figures.cell import named_direction
from zerorev.report.figures.page import embedded, html_page
from zerorev.report.figures.workspace_map import ROBOT_COLOUR, VALUE_MAP, capital, colours_of
from zerorev.report.words.workspace_map import heading

if TYPE_CHECKING:
    from plotly.graph_objects import Figure
    from xarray import Dataset

__all__ = ["workspace_page"]

MOST_CELLS = 400_000  # on the page: more are thinned out, so that it stays below some 10 MB
MOST_POINTS = 20_000  # in 3D
SLICES = """<div id="controls">planes across <select id="across"></select>
drilled along <select id="direction"></select>
<label><input type="range" id="at" min="0" value="0" style="width: 30em; vertical-align: middle"> <output id="where">
</output></label></div><div id="slice" style="width: 900px; height: 680px"></div>
<script>
const map = {data};
const pick = id => document.getElementById(id);
const option = (select, value, text) => select.add(new Option(text, value));
for (const a of "xyz") if (map[a].length > 1 || a === map.across) option(pick("across"), a, a.toUpperCase());
if (map.directions.length > 1) option(pick("direction"), -1, "the best direction of each target");
map.directions.forEach((name, n) => option(pick("direction"), n, name));
pick("across").value = map.across;
const sizes = ["x", "y", "z"].map(a => map[a].length), count = map.directions.length;
function value(i, n) {{
  const place = ((i[0] * sizes[1] + i[1]) * sizes[2] + i[2]) * count;
  if (n >= 0) return map.value[place + n];
  const given = map.value.slice(place, place + count).filter(v => v !== null);
  return given.length ? Math[map.better](...given) : null;
}}
function draw() {{
  const across = pick("across").value, up = across === "z" ? "x" : "z";
  const right = ["x", "y", "z"].find(a => a !== across && a !== up);
  const [a, r, u] = [across, right, up].map(name => "xyz".indexOf(name)), n = +pick("direction").value;
  const k = Math.min(+pick("at").value, sizes[a] - 1), z = [];
  pick("at").max = sizes[a] - 1;
  pick("where").textContent = across.toUpperCase() + " = " + map[across][k] + " mm";
  for (let j = 0; j < sizes[u]; j++) {{
    z.push([]);
    for (let i = 0; i < sizes[r]; i++) {{ const c = []; c[a] = k; c[r] = i; c[u] = j; z[j].push(value(c, n)); }}
  }}
  const trace = {{type: "heatmap", x: map[right], y: map[up], z: z, zmin: map.low, zmax: map.high,
    colorscale: map.colours, colorbar: {{title: {{text: map.label, side: "right"}}, thickness: 14}},
    hovertemplate: right.toUpperCase() + " %{{x}} mm, " + up.toUpperCase() + " %{{y}} mm: %{{z:.5~g}}<extra></extra>"}};
  const axis = name => ({{title: {{text: name.toUpperCase() + " [mm]"}}, constrain: "domain", showgrid: false,
    zeroline: false}});
  const across_x = Object.assign(axis(right), map.flipped[across] ? {{autorange: "reversed"}} : {{}});
  Plotly.newPlot("slice", [trace], {{xaxis: across_x, yaxis: Object.assign(axis(up), {{scaleanchor: "x"}}),
    plot_bgcolor: map.nothing, margin: {{t: 20}}}});
}}
for (const id of ["across", "direction", "at"]) pick(id).addEventListener("input", draw);
pick("at").max = sizes["xyz".indexOf(map.across)] - 1;
pick("at").value = map.first;
draw();
</script>"""


def workspace_page(found: Dataset, robot: Array) -> str:
    """A page of HTML that needs no network: slices of a map with a slider, and its targets around the robot in 3D.

    Args:
        found: a workspace map.
        robot: places along the arm [mm], shape (P, 3).
    """
    cells = cells_of(found)
    sections = [("Targets around the robot", "Drag to turn it; the colour is that of the best direction.",
                 embedded(_scene(cells, robot)))]  # fmt: skip
    if "point" not in found.dims:
        hint = "Move the slider: grey cells have no answer. Point at a cell for its number."
        sections.insert(0, ("Slices", hint, SLICES.format(data=_json(_slices(found)))))
    return html_page(capital(cells.quantity.title), heading(found), sections)


def _json(data: dict[str, Any]) -> str:
    """JSON that can stand in a page: no tag ends in it."""
    return json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def _slices(found: Dataset) -> dict[str, Any]:
    """What the page needs of a map on a grid."""
    every = 1
    while np.prod([-(-found.sizes[axis] // every) for axis in "xyz"]) * found.sizes["direction"] > MOST_CELLS:
        every += 1
    thin = found.isel({axis: slice(None, None, every) for axis in "xyz"})
    cells = cells_of(thin)
    quantity = cells.quantity
    _, norm = colours_of(quantity, cells.value)
    wide = [axis for axis in "xyz" if thin.sizes[axis] > 1]
    mean = np.abs(cells.direction.mean(axis=0))
    across = "xyz"[int(mean.argmax())]
    if len(wide) == 2:
        across = next(axis for axis in "xyz" if axis not in wide)
    best = cells.best.reshape([thin.sizes[axis] for axis in "xyz"])
    first = 0
    if not np.isnan(best).all():
        where = np.nanargmax(best) if quantity.more_is_better else np.nanargmin(best)
        first = int(np.unravel_index(where, best.shape)["xyz".index(across)])
    numbers = cells.value.ravel()
    shown = [None if np.isnan(number) else float(f"{number:.5g}") for number in numbers]
    return {
        **{axis: np.round(thin[f"{axis}_mm"].values, 3).tolist() for axis in "xyz"},
        "directions": [named_direction(way) for way in cells.direction],
        "value": shown, "across": across, "first": first, "low": float(norm.vmin or 0), "high": float(norm.vmax or 1),
        "label": quantity.label, "better": "max" if quantity.more_is_better else "min",
        "flipped": {axis: _flipped(cells, axis) for axis in AXES},
        "nothing": style.CANNOT_RUN, "colours": _colours(quantity),
    }  # fmt: skip


def _flipped(cells: Cells, across: Across) -> bool:
    """Whether the width of a plane runs to the left for who looks along the drill, as in the pictures."""
    up: Across = "z" if across != "z" else "x"
    right = next(axis for axis in AXES if axis not in (across, up))
    towards = bool(cells.direction.mean(axis=0)[AXES.index(across)] > -SAME_DIRECTION)
    return view_flips(right, up) == towards


def _scene(cells: Cells, robot: Array) -> Figure:
    """Targets in 3D, coloured by their best direction, and the robot at home."""
    import plotly.graph_objects as go

    every = -(-len(cells.target) // MOST_POINTS)
    target, best = cells.target[::every], cells.best[::every]
    _, norm = colours_of(cells.quantity, best)
    lost = np.isnan(best)
    dots = [
        go.Scatter3d(
            x=target[~lost, 0], y=target[~lost, 1], z=target[~lost, 2], mode="markers", customdata=best[~lost],
            name="targets", showlegend=False,
            marker={"size": 4, "color": best[~lost], "colorscale": _colours(cells.quantity), "cmin": norm.vmin,
                    "cmax": norm.vmax, "colorbar": {"title": {"text": cells.quantity.label, "side": "right"}}},
            hovertemplate="(%{x:g}, %{y:g}, %{z:g}) mm: %{customdata:.5~g}<extra></extra>",
        ),
        go.Scatter3d(
            x=target[lost, 0], y=target[lost, 1], z=target[lost, 2], mode="markers", name="no answer",
            marker={"size": 2, "color": style.CANNOT_RUN}, hoverinfo="skip",
        ),
        go.Scatter3d(
            x=robot[:, 0], y=robot[:, 1], z=robot[:, 2], mode="lines+markers", name="robot at home", hoverinfo="skip",
            line={"color": ROBOT_COLOUR, "width": 8}, marker={"size": 4, "color": ROBOT_COLOUR},
        ),
    ]  # fmt: skip
    figure = go.Figure(dots)
    axes = {f"{axis}axis": {"title": {"text": f"{axis.upper()} [mm]"}} for axis in "xyz"}
    figure.update_layout(
        scene=axes | {"aspectmode": "data", "camera": {"eye": {"x": -1.5, "y": -1.5, "z": 0.8}}},
        width=1050, height=780, template="plotly_white", legend={"x": 0, "y": 1}, margin={"t": 10},
    )  # fmt: skip
    return figure


def _colours(quantity: Quantity) -> list[list[Any]]:
    """The colours of a quantity for plotly."""
    if quantity.variable == "reversals":
        colours = style.REVERSAL_COLOURS
        return [[k / len(colours), colour] for n, colour in enumerate(colours) for k in (n, n + 1)]
    import matplotlib

    scale = matplotlib.colormaps[VALUE_MAP]
    return [[k / 16, to_hex(scale(k / 16))] for k in range(17)]
