"""A study on disk: a folder of zarr with one group a hole, each written whole, so that an interrupted study resumes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from zerorev.cell.ensemble import ENDS, QUANTILES, SIDES, HoleStudy
from zerorev.cell.parameters import ParameterSet
from zerorev.cell.reference import Manner
from zerorev.errors import InputError
from zerorev.files.output import check_whole_folder, write_whole_folder
from zerorev.model.fingerprint import fingerprint
from zerorev.model.plan import Plan

__all__ = ["StoredStudy", "StudyFolder", "check_place", "read_holes", "read_study"]

KIND, FORMAT = "zerorev.study/", "zerorev.study/2"
MARK = "zarr.json"


def check_place(path: Path) -> None:
    """Make sure, before long work, that a study can be written there.

    Raises:
        OutputError: it cannot.
    """
    check_whole_folder(path, MARK)


class StudyFolder:
    """The folder of a study that is being made."""

    def __init__(
        self, path: Path, plan: Plan, sets: Sequence[ParameterSet], seed: int, manner: Manner, thrust: float
    ) -> None:
        """Begin, or resume what was begun with the same plan, sets and manner.

        Args:
            path: of the folder.
            plan: that is studied.
            sets: of parameters.
            seed: of them.
            manner: of the controller.
            thrust: of the drill [N].

        Raises:
            InputError: there is another study.
            OutputError: it cannot be written there.
        """
        import zarr

        self.path = path
        own = _fingerprint(plan, [each.values for each in sets], manner, thrust)
        if path.exists():
            stated = _head(path)
            if stated.get("fingerprint") != own:
                raise InputError(
                    "there is another study", where=str(path), accepted="another folder, or the same plan and options"
                )
            return
        names = sorted({name for each in sets for name in each.values})

        def fill(folder: Path) -> None:
            group = zarr.open_group(folder, mode="w", zarr_format=3)
            group.attrs.update({
                "format": FORMAT, "fingerprint": own, "plan": plan.name, "robot": plan.robot.name, "seed": seed,
                "thrust_n": thrust, "manner": asdict(manner), "parameters": names,
            })  # fmt: skip
            table = np.array([[each.values[name] for name in names] for each in sets])
            group.create_array("parameters", data=table)

        write_whole_folder(path, MARK, fill)

    def known(self) -> dict[str, HoleStudy]:
        """Holes that are finished, by id."""
        return {each.id: each for each in read_holes(self.path)}

    def add(self, number: int, study: HoleStudy) -> None:
        """Write a hole, whole or not at all.

        Args:
            number: of the hole in its plan, from 0.
            study: of it.
        """
        import xarray

        dataset = xarray.Dataset(
            {
                "deviation_m": (("motion", "side", "set"), study.deviation),
                "vertical_m": (("motion", "side", "set"), study.vertical),
                "offset_m": (("motion", "side", "set"), study.offset),
                "swing_nm": (("motion", "joint", "set"), study.swing),
                "position_m": (("motion", "set"), study.position),
                "tilt_rad": (("motion", "set"), study.tilt),
                "ovality_m": (("motion", "end", "set"), study.ovality),
                "profile_m": (("motion", "side", "quantile", "path"), study.profile),
                "torque_nm": (("motion", "joint", "quantile", "path"), study.torque),
                "speed_m_s": (("motion",), study.speed),
            },
            coords={"joint": np.arange(1, 7), "quantile": list(QUANTILES), "path": study.path},
            attrs={"hole": study.id, "motions": list(study.motions), "sides": list(SIDES), "ends": list(ENDS)},
        )

        def fill(folder: Path) -> None:
            dataset.to_zarr(folder, mode="w", consolidated=False, zarr_format=3)

        write_whole_folder(self.path / f"hole_{number:05d}", MARK, fill)


class StoredStudy(NamedTuple):
    """A study that was read.

    Attributes:
        holes: that are finished, in the plan's order.
        sets: how many.
        seed: of them.
        thrust: of the drill [N].
    """

    holes: list[HoleStudy]
    sets: int
    seed: int
    thrust: float


def read_study(path: Path, plan: Plan) -> StoredStudy:
    """A study of a plan.

    Args:
        path: of its folder.
        plan: that was studied.

    Raises:
        InputError: no study, or one of another plan.
    """
    import zarr

    head = _head(path)
    try:
        table = np.asarray(zarr.open_array(path / "parameters", mode="r")[:])
        sets = [dict(zip(head["parameters"], map(float, row), strict=True)) for row in table]
        manner, thrust, seed = Manner(**head["manner"]), float(head["thrust_n"]), int(head["seed"])
    except Exception as error:  # what zarr raises on a damaged folder is of many kinds
        raise InputError(
            f"its parameters are damaged: {error}", where=str(path), accepted="remove the folder; it is made again"
        ) from error
    if head["fingerprint"] != _fingerprint(plan, sets, manner, thrust):
        raise InputError(
            f"is a study of another plan than {plan.name or 'this one'}", where=str(path),
            accepted="a study of the same plan file, which zerorev simulate writes",
        )  # fmt: skip
    return StoredStudy(read_holes(path), len(sets), seed, thrust)


def _fingerprint(plan: Plan, sets: Sequence[Mapping[str, float]], manner: Manner, thrust: float) -> str:
    values = [tuple(sorted(each.items())) for each in sets]
    # what was planned, not what the check said of it, or when
    planned = [(hole.hole, hole.motion) for hole in plan.holes]
    return fingerprint(plan.robot, plan.tool, plan.settings, planned, values, manner, thrust)


def read_holes(path: Path) -> list[HoleStudy]:
    """The finished holes of a study, in the plan's order.

    Args:
        path: of its folder.

    Raises:
        InputError: no study.
    """
    import xarray

    _head(path)
    found = []
    for folder in sorted(path.glob("hole_*")):
        if not (folder / MARK).exists():
            continue
        try:
            held = xarray.open_zarr(folder, chunks=None, consolidated=False, zarr_format=3).load()
        except Exception as error:  # what zarr raises on a damaged folder is of many kinds
            raise InputError(
                f"{folder.name} is damaged: {error}", where=str(path), accepted="remove it; it is made again"
            ) from error
        found.append(HoleStudy(
            str(held.attrs["hole"]), tuple(held.attrs["motions"]), held["deviation_m"].values,
            held["vertical_m"].values, held["offset_m"].values, held["swing_nm"].values, held["position_m"].values,
            held["tilt_rad"].values, held["ovality_m"].values, held["profile_m"].values,
            held["torque_nm"].values, held["path"].values, held["speed_m_s"].values,
        ))  # fmt: skip
    return found


def _head(path: Path) -> dict[str, Any]:
    import zarr

    accepted = "a folder that zerorev simulate has written"
    try:
        head = dict(zarr.open_group(path, mode="r", zarr_format=3).attrs)
    except Exception as error:
        raise InputError("no study", where=str(path), accepted=accepted) from error
    stated = head.get("format")
    if isinstance(stated, str) and stated.startswith(KIND) and stated != FORMAT:
        raise InputError(
            f"is a study of another version ({stated}), with other figures", where=str(path),
            accepted=f"{FORMAT}: another folder, in which the study is made again",
        )  # fmt: skip
    if stated != FORMAT:
        raise InputError("no study", where=str(path), accepted=accepted)
    return head
