"""Between the forms of solids and the nouns; millimetres and degrees end and begin here."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from zerorev.errors import InputError
from zerorev.files.body_schema import (
    BodyForm,
    LinkBodyForm,
    ObstacleForm,
    PartForm,
    SolidForm,
    SurroundingsForm,
    ToolBodyForm,
)
from zerorev.files.meshes import mesh_from_text, mesh_text, read_mesh
from zerorev.files.units import deg, m, mm, plain, rad
from zerorev.files.validation import inside
from zerorev.model._arrays import Array, rotation_rpy, rpy_of, transform
from zerorev.model.body import Body, Box, Capsule, Mesh, Obstacle, Shape
from zerorev.model.surroundings import Surroundings

__all__ = ["around_data", "bodies_data", "bodies_from", "obstacles_from", "surroundings_data", "surroundings_from"]

FLOOR = "floor"
FLOOR_SIZE = (40.0, 40.0, 1.0)  # [m]
PART = "part"


def bodies_from(
    forms: Sequence[LinkBodyForm | ToolBodyForm], folder: Path | None, T_flange_tcp: Array
) -> tuple[Body, ...]:
    """The bodies of a robot or of a tool.

    Args:
        forms: as they were read.
        folder: where paths start; None: no other file is opened.
        T_flange_tcp: of the tool, shape (4, 4) [m].

    Raises:
        InputError: an id that is used twice; a file that cannot be read.
    """
    found: list[Body] = []
    for n, form in enumerate(forms):
        with inside(f"bodies[{n}]"):
            if any(body.id == form.id for body in found):
                raise InputError(f"the id '{form.id}' is used twice", where="id", accepted="ids that differ")
            shape, T = _shape_from(form, folder)
            if isinstance(form, LinkBodyForm):
                found.append(Body(form.id, form.link, shape, _written(T)))
                continue
            if form.frame == "tcp":
                T = T_flange_tcp @ T
                if isinstance(shape, Capsule):
                    ends = shape.ends @ T_flange_tcp[:3, :3].T + T_flange_tcp[:3, 3]
                    shape, T = Capsule(m(plain(mm(ends))), shape.radius), np.eye(4)
            found.append(Body(form.id, 6, shape, _written(T), touches_part=form.touches_part))
    return tuple(found)


def bodies_data(bodies: Sequence[Body]) -> list[dict[str, Any]]:
    """Bodies as a file of answers holds them; those of a tool have no link."""
    return [
        {"id": body.id} | _shape_data(body.shape, body.T_link) | ({"touches_part": True} if body.touches_part else {})
        for body in bodies
    ]


def obstacles_from(
    part: str | PartForm | None,
    fixtures: Sequence[ObstacleForm],
    floor_mm: float | None,
    folder: Path | None,
    T_base_part: Array,
) -> Surroundings:
    """What stands around the arm, as a job has it.

    Args:
        part: the file of the part's shape, in the part frame.
        fixtures: as they were read.
        floor_mm: height of the floor [mm], or None.
        folder: where paths start; None: no other file is opened.
        T_base_part: the part frame in the base frame, shape (4, 4) [m].

    Raises:
        InputError: an id that is used twice; a file that cannot be read.
    """
    found: list[Obstacle] = []
    if part is not None:
        form = PartForm(file=part) if isinstance(part, str) else part
        with inside("part"):
            if (form.file is None) == (form.mesh is None):
                raise InputError("has no shape, or two", accepted="exactly one of file, mesh")
            if form.mesh is not None:
                mesh = mesh_from_text(form.mesh.vertices, form.mesh.faces)
            else:
                assert form.file is not None
                mesh = _file(form.file, form.unit, folder)
            found.append(Obstacle(PART, "part", mesh, _written(T_base_part)))
    for n, fixture in enumerate(fixtures):
        with inside(f"fixtures[{n}]"):
            if fixture.id in (PART, FLOOR):
                raise InputError(f"the id '{fixture.id}' is taken", where="id", accepted="another one")
            shape, T = _shape_from(fixture, folder)
            T = T_base_part @ T if fixture.frame == "part" else T
            assert not isinstance(shape, Capsule)
            found.append(Obstacle(fixture.id, "fixture", shape, _written(T)))
    if floor_mm is not None:
        found.append(_floor(floor_mm))
    return Surroundings(tuple(found))


def surroundings_from(form: SurroundingsForm | None) -> Surroundings:
    """What stands around the arm, as a file of answers has it."""
    if form is None:
        return Surroundings()
    found: list[Obstacle] = []
    solids = ([] if form.part is None else [form.part]) + list(form.fixtures)
    for solid in solids:
        with inside(f"surroundings, {solid.id}"):
            shape, T = _shape_from(solid, None)
            assert not isinstance(shape, Capsule)
            found.append(Obstacle(solid.id, "part" if solid is form.part else "fixture", shape, T))
    if form.floor_mm is not None:
        found.append(_floor(form.floor_mm))
    return Surroundings(tuple(found))


def surroundings_data(around: Surroundings) -> dict[str, Any]:
    """What stands around the arm, as a file of answers holds it."""
    solids = {kind: [one for one in around.obstacles if one.kind == kind] for kind in ("part", "fixture", "floor")}
    data = {
        kind: [{"id": one.id} | _shape_data(one.shape, one.T_base) for one in found]
        for kind, found in solids.items()
        if kind != "floor"
    }
    heights = [float(one.T_base[2, 3]) + FLOOR_SIZE[2] / 2 for one in solids["floor"]]
    return {
        "part": data["part"][0] if data["part"] else None,
        "fixtures": data["fixture"],
        "floor_mm": plain(mm(np.array(heights[0])).item()) if heights else None,
    }


def around_data(around: Surroundings) -> dict[str, Any]:
    """What stands around the arm, as a job has it; a key that says nothing is left out."""
    data = surroundings_data(around)
    part = data["part"]
    keys = {
        "part": None if part is None else {"mesh": part["mesh"]},
        "fixtures": data["fixtures"],
        "floor_mm": data["floor_mm"],
    }
    return {key: value for key, value in keys.items() if value not in (None, [])}


def _floor(height_mm: float) -> Obstacle:
    """A wide box below a height."""
    T = transform(np.eye(3), np.array([0.0, 0.0, float(m(height_mm)) - FLOOR_SIZE[2] / 2]))
    return Obstacle(FLOOR, "floor", Box(np.array(FLOOR_SIZE)), T)


def _written(T: Array) -> Array:
    """A frame with the digits that a file of answers has."""
    xyz_mm, rpy_deg = plain(mm(T[:3, 3])), plain(deg(rpy_of(T[:3, :3])))
    return transform(rotation_rpy(*rad(rpy_deg)), m(xyz_mm))


def _shape_from(form: SolidForm, folder: Path | None) -> tuple[Shape, Array]:
    """The shape of a form, and its frame."""
    shapes = ("capsule", "box", "file", "mesh") if isinstance(form, BodyForm) else ("box", "file", "mesh")
    if (count := sum(getattr(form, name) is not None for name in shapes)) != 1:
        what = "has no shape" if count == 0 else "has several shapes"
        raise InputError(what, accepted=f"exactly one of {', '.join(shapes[:-1])}")
    if isinstance(form, BodyForm) and form.capsule is not None:
        capsule = form.capsule
        return Capsule(m([capsule.from_mm, capsule.to_mm]), float(m(capsule.radius_mm))), np.eye(4)
    if form.box is not None:
        return Box(m(form.box.size_mm)), _frame(form.box.xyz_mm, form.box.rpy_deg)
    T = _frame(form.xyz_mm, form.rpy_deg)
    if form.mesh is not None:
        return mesh_from_text(form.mesh.vertices, form.mesh.faces), T
    assert form.file is not None
    return _file(form.file, form.unit, folder), T


def _file(name: str, unit: str | None, folder: Path | None) -> Mesh:
    if folder is None:
        raise InputError("another file is not opened from here", where="file", accepted="a box")
    return read_mesh(folder / name, unit)


def _frame(xyz_mm: Sequence[float], rpy_deg: Sequence[float]) -> Array:
    return transform(rotation_rpy(*rad(rpy_deg)), m(xyz_mm))


def _shape_data(shape: Shape, T: Array) -> dict[str, Any]:
    if isinstance(shape, Capsule):
        one, other = plain(mm(shape.ends))
        return {"capsule": {"from_mm": one, "to_mm": other, "radius_mm": plain(mm(np.array(shape.radius)).item())}}
    place = {"xyz_mm": plain(mm(T[:3, 3])), "rpy_deg": plain(deg(rpy_of(T[:3, :3])))}
    if isinstance(shape, Box):
        return {"box": {"size_mm": plain(mm(shape.size))} | place}
    return {"mesh": mesh_text(shape)} | place
