"""Cell files: what is known of an arm, its drives and its controller, as a range of each parameter.

A parameter that a file does not have keeps its prior (`zerorev.model.ranges`).
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import ConfigDict, Field, create_model

from zerorev.files.output import write_text
from zerorev.files.stated_forms import Form, Words
from zerorev.files.text import read_text
from zerorev.files.validation import checked, inside
from zerorev.files.values import Depth, Id, Length, Name, Positive
from zerorev.files.yaml_text import yaml_document, yaml_text
from zerorev.model.ranges import RANGES, Basis, Cell, Conditioning, Law, Range

__all__ = ["CellFile", "cell_from_text", "cell_text", "read_cell", "write_cell"]

FORMAT: Literal["zerorev.cell/1"] = "zerorev.cell/1"
ACCEPTED = "a cell file (YAML)"
BEYOND = 100  # times the prior, both ways: farther off no arm is, and no number overflows


class ParameterForm(Form):
    """A range of one parameter."""

    law: Law | None = Field(default=None, description="log or even: how values are spread; by default as in the prior")
    basis: Basis = Field(default="prior", description="prior, fitted or conditioned: what the range rests on")
    source: Words = Field(default="", description="text: where the numbers come from")


def _form_of(name: str, prior: Range) -> type[ParameterForm]:
    least = prior.low / BEYOND if prior.law == "log" else 0.0
    most = min(prior.high * BEYOND, prior.most)
    number = Annotated[float, Field(ge=least, le=most)]
    accepted = f"a number from {least:g} to {most:g}"
    keys: dict[str, Any] = {
        "nominal": (number, Field(description=f"{accepted}: {prior.means}")),
        "low": (number, Field(description=f"{accepted}: the least; {prior.means}")),
        "high": (number, Field(description=f"{accepted}: the greatest; {prior.means}")),
    }
    title = "".join(part.capitalize() for part in name.split("_"))
    means = f"{prior.means[0].upper()}{prior.means[1:]}."
    return create_model(f"{title}Form", __base__=ParameterForm, __doc__=means, __module__=__name__, **keys)


def _parameters() -> type[Form]:
    keys: dict[str, Any] = {}
    for name, prior in RANGES.items():
        described = f"a mapping of nominal, low, high, law, basis and source: {prior.means}"
        keys[name] = (_form_of(name, prior) | None, Field(default=None, description=described))
    means = "Ranges by the names of the parameters; one that is missing keeps its prior."
    return create_model("ParametersForm", __base__=Form, __doc__=means, __module__=__name__, **keys)


ParametersForm = _parameters()


class ConditioningForm(Form):
    """What was measured of baselines, by the encoders."""

    baseline_mm: Annotated[dict[Id, Depth], Field(min_length=1)] = Field(
        description="a mapping of ids of holes to numbers above 0 [mm]: deviation of the baseline by the encoders"
    )
    feed_mm_s: Positive | None = Field(default=None, description="a number above 0 [mm/s], or null: the plan's feeds")
    corner_mm: Annotated[Length, Field(ge=0)] | None = Field(
        default=None, description="a number, 0 or more [mm]: radius of the blend at the corner, or null: the plan's"
    )
    factor: Annotated[float, Field(gt=1, le=1e3)] = Field(
        default=2.0, description="a number above 1: by which a set may be off at each hole"
    )


if TYPE_CHECKING:
    Parameters = Form
else:
    Parameters = ParametersForm


class CellFile(Form):
    """What is known of an arm, its drives and its controller."""

    model_config = ConfigDict(title="zerorev cell file")
    format: Literal["zerorev.cell/1"] = Field(description=FORMAT)
    robot: Name | None = Field(default=None, description="text: the name of the robot, or null: of any")
    parameters: Parameters = Field(
        default=ParametersForm(), description="a mapping of parameters to their ranges; what is missing is as the prior"
    )
    conditioning: ConditioningForm | None = Field(
        default=None, description="a mapping of baseline_mm, feed_mm_s, corner_mm, factor: what was measured; or null"
    )


def read_cell(path: str | Path) -> Cell:
    """The cell of a cell file (YAML).

    Raises:
        InputError: not such a file, or numbers that are not a range.
    """
    return cell_from_text(read_text(Path(path), ACCEPTED), str(path))


def cell_from_text(text: str, name: str) -> Cell:
    """The cell of the text of a cell file.

    Args:
        text: of the file.
        name: that it had, for messages.

    Raises:
        InputError: not such a text, or numbers that are not a range.
    """
    document = yaml_document(text, name)
    form = checked(CellFile, document)
    ranges: dict[str, Range] = {}
    for name, prior in RANGES.items():
        given = getattr(form.parameters, name)
        if given is None:
            continue
        with inside(document.where(("parameters", name))):
            ranges[name] = Range(
                given.nominal, given.low, given.high, given.law or prior.law, prior.means, given.source, given.basis,
                prior.most,
            )  # fmt: skip
    return Cell(ranges, _conditioning(form.conditioning), form.robot or "")


def _conditioning(form: ConditioningForm | None) -> Conditioning | None:
    if form is None:
        return None
    return Conditioning(
        {hole: deviation / 1e3 for hole, deviation in form.baseline_mm.items()},
        None if form.feed_mm_s is None else form.feed_mm_s / 1e3,
        None if form.corner_mm is None else form.corner_mm / 1e3,
        form.factor,
    )


def cell_text(cell: Cell) -> str:
    """The text of a cell file, with all parameters."""
    data: dict[str, Any] = {"format": FORMAT}
    if cell.robot:
        data["robot"] = cell.robot
    data["parameters"] = {
        name: {
            "nominal": float(each.nominal), "low": float(each.low), "high": float(each.high), "law": each.law,
            "basis": each.basis, "source": each.source,
        }
        for name, each in cell.ranges.items()
    }  # fmt: skip
    if (known := cell.conditioning) is not None:
        data["conditioning"] = {
            "baseline_mm": {hole: deviation * 1e3 for hole, deviation in known.baseline.items()},
            "feed_mm_s": None if known.feed is None else known.feed * 1e3,
            "corner_mm": None if known.corner is None else known.corner * 1e3,
            "factor": float(known.factor),
        }
    return yaml_text(data)


def write_cell(cell: Cell, path: str | Path) -> None:
    """Write a cell file, whole or not at all.

    Raises:
        OutputError: it cannot be written.
    """
    write_text(path, cell_text(cell))
