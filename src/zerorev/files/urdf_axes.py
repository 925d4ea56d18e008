"""Six axes in space out of a robot description (URDF); no mesh is looked for."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from zerorev.errors import InputError
from zerorev.files.urdf import MOST_PARTS, TURNING, Joint, joint_of, named, urdf_root
from zerorev.model._arrays import Array, rotation_rpy, rpy_of, transform
from zerorev.model.axes import Axes

__all__ = ["DescribedArm", "arm_of_urdf"]

KINDS = (*TURNING, "fixed", "prismatic", "planar", "floating")
BASES = ("base", "wbase")  # frames in which controllers count, by their names in descriptions
STEP, SNAP = math.radians(15), 5e-4  # angles of frames that were rounded lie near a multiple of the one
PARALLEL = 1e-6  # [rad]


@dataclass(frozen=True)
class DescribedArm:
    """An arm of a description, and what was chosen.

    Attributes:
        axes: as the file has them.
        snapped: with the angles of its frames at the multiples of 15 deg that they were rounded from, or None where
            none of them is near one without being it.
        notes: what was chosen, a sentence each.
    """

    axes: Axes
    snapped: Axes | None
    notes: tuple[str, ...]


def arm_of_urdf(path: str | Path, tip: str | None = None, text: bytes | None = None) -> DescribedArm:
    """The six axes of the arm in a description.

    Args:
        path: the file.
        tip: the link that the arm carries, by its name; None: it is chosen, `tool0` first, then a frame on axis 6
            whose z leaves along it, then `flange`, then the last link.
        text: what the file holds where it was made of it (xacro); else it is read.

    Raises:
        InputError: not such a file, or no chain of six turning joints.
    """
    path = Path(path)
    root = urdf_root(path, text)
    for tag in ("joint", "link"):
        if len(root.findall(tag)) > MOST_PARTS:
            raise InputError(f"more than {MOST_PARTS:,} of {tag}", where=str(path), accepted=f"{MOST_PARTS:,} or less")
    joints = [joint_of(entry, str(path), KINDS) for entry in root.findall("joint")]
    links = [named(entry, str(path)) for entry in root.findall("link")]
    tree = _Tree(joints, links, str(path))
    chain, chosen, notes = tree.chosen(tip)
    name = str(root.get("name") or path.stem)
    exact = _axes(name, tree, chain, chosen, snap=False)
    snapped = _axes(name, tree, chain, chosen, snap=True)
    return DescribedArm(exact, None if _same(exact, snapped) else snapped, tuple(notes))


class _Tree:
    """Links and joints of a description, from its root."""

    def __init__(self, joints: Sequence[Joint], links: Sequence[str], file: str) -> None:
        self.file, self.links = file, links
        self.by_child = {joint.child: joint for joint in joints}
        if len(self.by_child) < len(joints):
            accepted = "each link as the child of one joint"
            raise InputError("a link that two joints carry", where=file, accepted=accepted)
        unknown = {end for joint in joints for end in (joint.parent, joint.child)} - set(links)
        if unknown:
            raise InputError(
                f"no link {sorted(unknown)[0]}, which a joint names", where=file, accepted="links of the file"
            )
        roots = [link for link in links if link not in self.by_child]
        if len(roots) != 1:
            what = f"{len(roots)} root links" if roots else "joints that form a loop" if links else "no links"
            raise InputError(what, where=file, accepted="a tree of links with one root")
        self.root = roots[0]
        self.paths = {link: self._path(link) for link in links}

    def _path(self, link: str) -> list[Joint]:
        """The joints from the root to a link."""
        path: list[Joint] = []
        while link in self.by_child:
            if len(path) > len(self.by_child):
                raise InputError("joints that form a loop", where=self.file, accepted="a tree with one root")
            path.insert(0, self.by_child[link])
            link = path[0].parent
        return path

    def chosen(self, tip: str | None) -> tuple[list[Joint], str, list[str]]:
        """The chain of six turning joints, the link at its end, and what was chosen."""
        if tip is not None:
            if tip not in self.paths:
                ends = [link for link, path in self.paths.items() if len(_moving(path)) == 6] or self.links
                raise InputError(f"no link {tip}", where="--tip", accepted=_some(ends))
            return self._six(tip), tip, []
        clean = {link: path for link, path in self.paths.items() if all(_turns(joint) for joint in _moving(path))}
        most = max((len(_moving(path)) for path in clean.values()), default=0)
        notes = []
        if len(clean) < len(self.paths):
            others = sorted({joint.name for path in self.paths.values() for joint in path if not _turns(joint)})
            notes.append(f"what follows {_some(others)} is left aside: joints that slide, or follow others")
        ends = [link for link, path in clean.items() if len(_moving(path)) == most]
        if most == 6 and len({_moving(clean[link])[-1].name for link in ends}) > 1:
            raise InputError("two arms of six joints", where=self.file, accepted=f"--tip with one of {_some(ends)}")
        if most > 6:
            self._six(ends[-1])
        if most < 6:  # then a joint of another kind in the longest chain may be the reason
            self._six(max(self.paths, key=lambda link: len(_moving(self.paths[link]))))
        link = self._best(ends)
        others = [each for each in ends if each != link]
        notes.append(f"the tip is the link {link}" + (f"; others: {_some(others)} (--tip)" if others else ""))
        return self._six(link), link, notes

    def _six(self, link: str) -> list[Joint]:
        """The joints to a link, six of which turn and none of which moves otherwise."""
        path = self.paths[link]
        moving = _moving(path)
        if odd := [joint for joint in moving if not _turns(joint)]:
            what = "follows another (mimic)" if odd[0].mimic else f"is {odd[0].kind}"
            raise InputError(
                f"joint {odd[0].name} {what}", where=self.file, accepted="six joints that turn on their own"
            )
        if len(moving) != 6:
            raise InputError(
                f"{len(moving)} turning joints from {self.root} to {link}", where=self.file,
                accepted="an arm of six; of one with more, fix the others in the description",
            )  # fmt: skip
        return path

    def _best(self, ends: Sequence[str]) -> str:
        """Of the links behind joint 6 the one in which controllers count their tools."""
        if "tool0" in ends:
            return "tool0"
        last = [link for link in ends if self._leaves_along_axis_6(link)]
        if last:
            return last[-1]
        return "flange" if "flange" in ends else ends[-1]

    def _leaves_along_axis_6(self, link: str) -> bool:
        """Whether a link's z lies on axis 6, its origin beyond the wrist."""
        lines, T = _lines(self.paths[link], snap=False)
        z, p = lines[-1]
        on_it = np.linalg.norm(np.cross(T[:3, 3] - p, z)) < PARALLEL
        along = T[:3, 2] @ z
        out = (T[:3, 3] - lines[-2][1]) @ T[:3, 2]
        return bool(on_it and abs(along) > 1 - PARALLEL**2 and out > 0)


def _axes(name: str, tree: _Tree, chain: Sequence[Joint], tip: str, *, snap: bool) -> Axes:
    lines, T_root_tip = _lines(chain, snap=snap)
    T_root_base = np.eye(4)
    for base in BASES:
        if base in tree.paths and base != tree.root and not _moving(tree.paths[base]):
            T_root_base = _lines(tree.paths[base], snap=snap)[1]
            break
    moving = _moving(chain)
    a, b, c, d, e, f = (joint.name for joint in moving)
    limits = np.array([[math.nan if x is None else x for x in joint.limits] for joint in moving])
    return Axes(
        name, (a, b, c, d, e, f), np.array([z for z, _ in lines]), np.array([p for _, p in lines]), T_root_tip, tip,
        T_root_base, limits[:, 0], limits[:, 1], limits[:, 2],
    )  # fmt: skip


def _lines(path: Sequence[Joint], *, snap: bool) -> tuple[list[tuple[Array, Array]], Array]:
    """Direction and point of each moving axis at 0, and the frame at the end of the path, in the root frame."""
    T, lines = np.eye(4), []
    for joint in path:
        T = T @ (_snapped(joint.pose) if snap else joint.pose)
        if joint.axis is not None:
            lines.append((T[:3, :3] @ joint.axis, T[:3, 3].copy()))
    return lines, T


def _snapped(pose: Array) -> Array:
    """A frame whose angles are taken to the multiple of 15 deg that each is next to."""
    angles = np.array(rpy_of(pose[:3, :3]))
    whole = np.round(angles / STEP) * STEP
    near = np.abs(angles - whole) < SNAP
    return transform(rotation_rpy(*np.where(near, whole, angles)), pose[:3, 3])


def _same(one: Axes, other: Axes) -> bool:
    close: Mapping[str, Any] = {"rtol": 0.0, "atol": 1e-12}
    return bool(
        np.allclose(one.direction, other.direction, **close)
        and np.allclose(one.point, other.point, **close)
        and np.allclose(one.T_root_tip, other.T_root_tip, **close)
    )


def _moving(path: Sequence[Joint]) -> list[Joint]:
    return [joint for joint in path if joint.kind != "fixed"]


def _turns(joint: Joint) -> bool:
    return joint.kind == "fixed" or (joint.kind in TURNING and not joint.mimic)


def _some(names: Sequence[str], most: int = 8) -> str:
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")
