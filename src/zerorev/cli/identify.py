"""`zerorev identify`: from recordings of an arm to a cell file, and the program of the sweeps for them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from zerorev.cli.common import FINE, Output, Whole, app, check_outputs, machines, numbers
from zerorev.cli.recordings import GearRatio, planned
from zerorev.errors import InputError
from zerorev.report.words import terminal

if TYPE_CHECKING:
    from zerorev.cell.recordings.channels import Mapping
    from zerorev.cell.recordings.tip import PlannedHole
    from zerorev.model.recording import Recording

__all__ = ["identify"]

Several = Annotated[list[Path] | None, Parameter(consume_multiple=True)]


@app.command
def identify(
    *sweeps: Path,
    plan: Path,
    hole: str | None = None,
    write_sweeps: Path | None = None,
    baseline: Several = None,
    reversal_values: Path | None = None,
    feed_mm_s: float | None = None,
    corner_mm: float | None = None,
    channels: Path | None = None,
    gear_ratio: GearRatio = None,
    torque_ratio: GearRatio = None,
    sets: Whole = 600,
    seed: Whole = 0,
    workers: Whole | None = None,
    json: bool = False,
    output: Output = None,
) -> int:
    """Find out what is to be known of an arm: friction and tool mass, its controller, and gears where measured.

    Args:
        sweeps: Recordings of the sweeps, with torque: KRC4 traces, RSI captures or tables (.csv), one or several.
        plan: The plan file (JSON) whose robot and tool were recorded, and whose baselines.
        hole: At which of its holes the sweeps begin; by default the only one.
        write_sweeps: Write the robot program of the sweeps (KRL, .src) to this file, and do nothing else.
        baseline: Recordings of holes of the plan at constant spin: they narrow what the controller may be.
        reversal_values: Measured at the tool (CSV: joint,value_deg,weight_kg): they narrow gap and stiffness.
        feed_mm_s: At which the baselines were programmed [mm/s]; by default as the plan has it.
        corner_mm: Radius of the blend at their corner [mm]; by default as the plan has it.
        channels: What the channels of the files mean (YAML), where their names do not say it.
        gear_ratio: By what the positions of a trace's drives are divided: six numbers with commas between them.
        torque_ratio: By what logged torques are multiplied to be those of the joints: six numbers, likewise.
        sets: Possible arms among which those are looked for that stray as the baselines do.
        seed: Of these sets: the same seed gives the same cell.
        workers: Processes; by default as many as there are cores.
        json: Print the figures as JSON on standard output, and nothing else there.
        output: The cell file (YAML).
    """
    check_outputs((output, write_sweeps), plan, *sweeps, *(baseline or ()))
    meant = planned(plan, hole)
    assert meant is not None
    if write_sweeps is not None:
        if sweeps:
            raise InputError("stands beside recordings", where="--write-sweeps", accepted="one or the other")
        return _write(meant, write_sweeps)
    if not sweeps:
        raise InputError("no recording of sweeps", where="identify",
                         accepted="one or more files, or --write-sweeps to write their program")  # fmt: skip
    from zerorev.cell.identify.cell import identified
    from zerorev.cell.identify.controller import baseline_of, blocks_of
    from zerorev.cell.identify.lost_motion import read_reversals
    from zerorev.cell.reference import Manner
    from zerorev.files.cell_file import write_cell
    from zerorev.files.io import read_plan
    from zerorev.report.words import identified as shown

    manner = Manner(
        feed=None if feed_mm_s is None else _positive(feed_mm_s, "--feed-mm-s") / 1e3,
        corner=None if corner_mm is None else _positive(corner_mm, "--corner-mm") / 1e3,
    )
    ratio = _six(torque_ratio)
    answer, mapping = read_plan(plan), _mapping(channels, gear_ratio)
    names = answer.robot.joint_names
    values = [] if reversal_values is None else read_reversals(reversal_values, names)
    recorded = [_read(file, mapping) for file in sweeps]
    found_baselines = [baseline_of(_read(file, mapping), answer, manner.corner) for file in baseline or ()]
    with terminal.progress("simulating", blocks_of(sets, len(found_baselines)), "block") as progress:
        found = identified(
            answer, meant.drilling, meant.motion.joints[0], recorded, torque_ratio=ratio,
            reversals=values, reversals_source=reversal_values.name if reversal_values else "",
            baselines=found_baselines, manner=manner, sets=sets, seed=seed, machines=machines(workers, None),
            progress=progress,
        )  # fmt: skip
    if output is not None:
        write_cell(found.cell, output)
    if json:
        terminal.print_json(shown.identified_data(found))
    else:
        terminal.out().print(shown.identified_table(found))
        terminal.print_lines(shown.identified_lines(found, names))
    if output is not None and not json:
        terminal.say(f"cell written to {output}")
    return FINE


def _write(meant: PlannedHole, target: Path) -> int:
    from zerorev.files.output import write_text
    from zerorev.program.krl.names import KRL_NAMES
    from zerorev.program.krl.sweeps import sweeps_to_krl
    from zerorev.program.sweeps import sweeps_of

    found = sweeps_of(meant.drilling, meant.motion)
    write_text(target, sweeps_to_krl(found, target.stem))
    lasting = sum(each.cycles for each in found.sweeps)
    terminal.say(f"program of {len(found.sweeps)} sweeps written to {target}: {lasting} times there and back")
    if KRL_NAMES.of(target.stem) != target.stem:
        terminal.note(f"the controller wants this file called {KRL_NAMES.of(target.stem)}.src")
    return FINE


def _mapping(channels: Path | None, gear_ratio: str | None) -> Mapping:
    from dataclasses import replace

    from zerorev.cell.recordings.channels import NO_MAPPING, read_mapping

    mapping = NO_MAPPING if channels is None else read_mapping(channels)
    if gear_ratio is not None:
        mapping = replace(mapping, gear_ratio=tuple(numbers(gear_ratio, "--gear-ratio")))
    return mapping


def _read(file: Path, mapping: Mapping) -> Recording:
    from dataclasses import replace

    from zerorev.cell.recordings.read import read_recording

    with terminal.busy(f"reading {file.name}"):
        return replace(read_recording(file, mapping), source=file.name)


def _six(text: str | None) -> list[float]:
    found = [1.0] * 6 if text is None else numbers(text, "--torque-ratio")
    if len(found) != 6 or 0 in found:
        raise InputError("not six numbers", where="--torque-ratio", accepted="six numbers other than 0")
    return found


def _positive(value: float, where: str) -> float:
    if not 0 < value < 1e6:
        raise InputError(f"{value:g} is not above 0", where=where, accepted="a number above 0")
    return value
