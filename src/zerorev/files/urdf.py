"""A robot description (URDF), read as data: links, joints, what is to be seen of each link. No mesh is opened here.

XML of unknown origin: document types and entities are refused before anything is made of them, and a mesh is only ever
looked for inside the folder of the file itself, or of the package above it that the mesh names.
"""

from __future__ import annotations

import reprlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any
from urllib.parse import urlsplit

import numpy as np

from zerorev.errors import InputError
from zerorev.files.text import read_bytes
from zerorev.model._arrays import Array, rotation_rpy, transform

__all__ = ["Description", "Joint", "Visual", "joint_of", "named", "read_urdf", "urdf_root"]

XACRO = "wiki/xacro}"  # of the tags of its own
TURNING = ("revolute", "continuous")
MOST_BYTES = 20 * 2**20
MOST_PARTS = 1_000  # joints, links, materials, and what is seen of links, of each
LONGEST_NAME = 1_000  # of a mesh
GREATEST = 1e6  # number, in metres or radians
GREY = "#c9c9c9"


@dataclass(frozen=True)
class Visual:
    """What is seen of a link.

    Attributes:
        pose: in the link's frame, shape (4, 4), translation [m].
        kind: `mesh`, `box`, `cylinder` or `sphere`.
        file: of a mesh.
        size: scale of a mesh [1], edges of a box, radius and length of a cylinder, radius of a sphere [m].
        colour: as #rrggbb.
    """

    pose: Array
    kind: str
    file: Path | None
    size: tuple[float, ...]
    colour: str


@dataclass(frozen=True)
class Joint:
    """What joins two links.

    Attributes:
        parent: link that is nearer to the base.
        child: link that it carries.
        pose: of the child in the parent where the joint is at 0, shape (4, 4), translation [m].
        axis: unit vector in the child's frame, shape (3,), or None for a joint that does not move.
        name: of the joint.
        kind: `fixed`, `revolute`, `continuous`, or what else a description may hold.
        mimic: whether it follows another joint.
        limits: lower and upper angle [rad] and greatest speed [rad/s], each None where the file does not state it.
    """

    parent: str
    child: str
    pose: Array
    axis: Array | None
    name: str = ""
    kind: str = "revolute"
    mimic: bool = False
    limits: tuple[float | None, float | None, float | None] = (None, None, None)


@dataclass(frozen=True)
class Description:
    """A chain of six turning joints, with all that is fixed to its links.

    Attributes:
        file: where it was read.
        base: the link that stands still.
        chain: the joints from the base on, fixed ones among them, as far as the link after the sixth.
        fixed: joints that do not move and lie beside or beyond the chain.
        visuals: of each link, by its name.
    """

    file: Path
    base: str
    chain: tuple[Joint, ...]
    fixed: tuple[Joint, ...]
    visuals: dict[str, tuple[Visual, ...]]


def read_urdf(path: str | Path) -> Description:
    """Read a description of a six-axis robot.

    Args:
        path: the file (.urdf, not .xacro).

    Raises:
        InputError: not such a file, XML with a document type or entities, a mesh outside of the file's folder and of
            its package's, or other than six turning joints in one chain.
    """
    root = urdf_root(Path(path))
    for tag in ("joint", "link", "material", "link/visual"):
        if len(root.findall(tag)) > MOST_PARTS:
            raise InputError(f"more than {MOST_PARTS:,} of {tag}", where=str(path), accepted=f"{MOST_PARTS:,} or less")
    joints = [joint_of(entry, str(path)) for entry in root.findall("joint")]
    moving = [joint for joint in joints if joint.axis is not None]
    children = {joint.child for joint in joints}
    links = [named(entry, str(path)) for entry in root.findall("link")]
    bases = [link for link in links if link not in children]
    if len(bases) != 1:
        raise InputError(f"{len(bases)} root links", where=str(path), accepted="one")
    by_child = {joint.child: joint for joint in joints}
    if len(by_child) < len(joints):
        raise InputError(
            "a link that two joints carry", where=str(path), accepted="each link as the child of one joint"
        )
    ends = [joint for joint in moving if _depth(joint, by_child, str(path)) == 6]
    if len(moving) != 6 or len(ends) != 1:
        raise InputError(
            f"{len(moving)} moving joints",
            where=str(path),
            accepted="six revolute joints in one chain; the others fixed",
        )
    chain = [ends[0]]
    while chain[0].parent in by_child:
        chain.insert(0, by_child[chain[0].parent])
    of_chain = {id(joint) for joint in chain}
    folder = Path(path).resolve().parent
    colours = {named(entry, str(path)): _rgb(entry) for entry in root.findall("material")}
    visuals = {
        named(entry, str(path)): tuple(_visual(each, folder, colours, str(path)) for each in entry.findall("visual"))
        for entry in root.findall("link")
    }
    fixed = tuple(joint for joint in joints if id(joint) not in of_chain)
    return Description(Path(path), bases[0], tuple(chain), fixed, visuals)


def urdf_root(path: Path, text: bytes | None = None) -> Any:
    """The root element of a robot description.

    Args:
        path: the file.
        text: what it holds, where that was made of it; else it is read.

    Raises:
        InputError: no such file, no XML, XML with a document type or entities, or of another kind.
    """
    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import ParseError, fromstring

    try:
        text = read_bytes(path, "a URDF file", MOST_BYTES) if text is None else text
        root = fromstring(text, forbid_dtd=True)
    except DefusedXmlException:
        message = "holds a document type or entities, which are not read"
        raise InputError(message, where=str(path), accepted="plain XML") from None
    except (ParseError, ValueError, LookupError) as error:  # LookupError: an encoding that nobody knows
        raise InputError(f"is not XML: {error}", where=str(path), accepted="a URDF file") from None
    if any(XACRO in str(entry.tag) or any("${" in value for value in entry.attrib.values()) for entry in root.iter()):
        accepted = f"a URDF file: expand it first (xacro {path.name} > {path.stem}.urdf)"
        raise InputError("is xacro, which is not expanded here", where=str(path), accepted=accepted)
    if root.tag != "robot":
        raise InputError(
            f"begins with <{root.tag}>", where=str(path), accepted="<robot>: a URDF file, not xacro or SDF"
        )
    return root


def joint_of(entry: Any, file: str, kinds: Sequence[str] = (*TURNING, "fixed")) -> Joint:
    """A joint of a description.

    Args:
        entry: its XML element.
        file: how messages name the file.
        kinds: that may occur.

    Raises:
        InputError: of another kind, without its two links, or with numbers that are none.
    """
    where = f"{file}, joint {entry.get('name')}"
    kind = entry.get("type")
    parent, child = entry.find("parent"), entry.find("child")
    if parent is None or child is None or kind not in kinds:
        accepted = f"{', '.join(kinds[:-1])} or {kinds[-1]}, of two links"
        raise InputError(f"a joint of type '{kind}'", where=where, accepted=accepted)
    axis = None
    if kind != "fixed":
        given = entry.find("axis")
        axis = np.array(_numbers("1 0 0" if given is None else given.get("xyz"), 3, where))
        length = float(np.linalg.norm(axis))
        if not length > 1e-9:
            raise InputError("an axis of no length", where=where, accepted="a vector other than 0")
        axis = axis / length
    links = [end.get("link") for end in (parent, child)]
    if not all(links):
        raise InputError("an end that names no link", where=where, accepted='<parent link="…"/> and <child link="…"/>')
    return Joint(
        str(links[0]), str(links[1]), _origin(entry, where), axis, str(entry.get("name")), kind,
        entry.find("mimic") is not None, _limits(entry, where),
    )  # fmt: skip


def _limits(entry: Any, where: str) -> tuple[float | None, float | None, float | None]:
    """Lower, upper and velocity, as far as they are stated; a continuous joint has no ends."""
    limit = entry.find("limit")
    keys = ("velocity",) if entry.get("type") == "continuous" else ("lower", "upper", "velocity")
    stated = {} if limit is None else {key: limit.get(key) for key in keys if limit.get(key) is not None}
    lower, upper, speed = (
        _numbers(stated[key], 1, where)[0] if key in stated else None for key in ("lower", "upper", "velocity")
    )
    return lower, upper, speed


def _depth(joint: Joint, by_child: dict[str, Joint], where: str) -> int:
    """How many moving joints there are from the base to behind this one."""
    count, seen, at = 0, set[str](), joint
    while True:
        if at.child in seen:
            raise InputError("joints that form a loop", where=where, accepted="a chain")
        seen.add(at.child)
        count += at.axis is not None
        if at.parent not in by_child:
            return count
        at = by_child[at.parent]


def _visual(entry: Any, folder: Path, colours: dict[str, str], where: str) -> Visual:
    shape = next(iter(entry.find("geometry") if entry.find("geometry") is not None else ()), None)
    if shape is None or shape.tag not in ("mesh", "box", "cylinder", "sphere"):
        raise InputError("a visual without a shape", where=where, accepted="mesh, box, cylinder or sphere")
    file = None
    if shape.tag == "mesh":
        file = _inside(str(shape.get("filename")), folder, where)
        size = _numbers(shape.get("scale", "1 1 1"), 3, where)
    elif shape.tag == "box":
        size = _numbers(shape.get("size"), 3, where)
    elif shape.tag == "cylinder":
        size = (*_numbers(shape.get("radius"), 1, where), *_numbers(shape.get("length"), 1, where))
    else:
        size = _numbers(shape.get("radius"), 1, where)
    material = entry.find("material")
    colour = GREY
    if material is not None:
        colour = _rgb(material) if material.find("color") is not None else colours.get(str(material.get("name")), GREY)
    return Visual(_origin(entry, where), shape.tag, file, size, colour)


def _inside(name: str, folder: Path, where: str) -> Path:
    """The mesh's file, which must lie in the folder of the description, or in that of the package it names."""
    accepted = "a path inside the file's folder, or package://"
    try:
        parts = urlsplit(name)
        if len(name) > LONGEST_NAME or parts.scheme not in ("", "package", "file"):
            raise InputError(f"the mesh {reprlib.repr(name)}", where=where, accepted=accepted)
        inner = PurePosixPath(parts.path.lstrip("/") if parts.scheme else name)
        package = _package(parts.netloc, folder) if parts.scheme == "package" else None
        places = [(folder, path) for path in _places(inner, folder)]
        if package is not None:
            places.append((package, package / inner))
        for within, path in places:
            found = path.resolve()
            if found.is_relative_to(within) and found.is_file():
                return found
    except (OSError, ValueError, RuntimeError):  # a name that no file can have; links that form a loop
        raise InputError(f"the mesh {reprlib.repr(name)}", where=where, accepted=accepted) from None
    accepted = "meshes in the folder of the file, or in a folder above it that is called as its package"
    raise InputError(f"no mesh {name} inside {folder if package is None else package}", where=where, accepted=accepted)


def _package(name: str, folder: Path) -> Path | None:
    """The nearest folder of a package, by its name: that of the description, or one above it."""
    return next((place for place in (folder, *folder.parents) if name and place.name == name), None)


def _places(path: PurePosixPath, folder: Path) -> Iterator[Path]:
    """Where a mesh may lie: a package is often copied beside the description, with or without its folders."""
    for n in range(len(path.parts)):
        yield folder.joinpath(*path.parts[n:])


def _origin(entry: Any, where: str) -> Array:
    origin = entry.find("origin")
    if origin is None:
        return np.eye(4)
    roll, pitch, yaw = _numbers(origin.get("rpy", "0 0 0"), 3, where)
    return transform(rotation_rpy(roll, pitch, yaw), np.array(_numbers(origin.get("xyz", "0 0 0"), 3, where)))


def _rgb(material: Any) -> str:
    colour = material.find("color")
    if colour is None:
        return GREY
    values: Sequence[float] = _numbers(colour.get("rgba"), 4, "material")[:3]
    return "#" + "".join(f"{round(255 * min(1.0, max(0.0, value))):02x}" for value in values)


def named(entry: Any, where: str) -> str:
    """The name of a link, a joint or a material.

    Args:
        entry: its XML element.
        where: the file.

    Raises:
        InputError: it has none.
    """
    name = entry.get("name")
    if not name:
        raise InputError(f"a {entry.tag} without a name", where=where, accepted="a name")
    return str(name)


def _numbers(text: str | None, count: int, where: str) -> tuple[float, ...]:
    try:
        values = tuple(map(float, (text or "").split()))
    except ValueError:
        values = ()
    if len(values) != count or not all(abs(value) <= GREATEST for value in values):
        accepted = f"{count} numbers from {-GREATEST:g} to {GREATEST:g}"
        raise InputError(f"{reprlib.repr(text)} is not {count} numbers", where=where, accepted=accepted)
    return values
