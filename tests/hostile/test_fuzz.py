"""Twenty thousand inputs that nobody would write, reader by reader: each is refused in one message, or read as it says.

What is accepted is compared with what other parsers find in the same bytes, and with conversions written again here.
"""

from __future__ import annotations

import csv
import json
import math
import random
import re
import resource
import time
import xml.etree.ElementTree as ET
from collections.abc import Callable
from dataclasses import dataclass, replace
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation

import zerorev as zr
from oracles.hostile_inputs import changed_bytes, changed_data, made_up
from zerorev.errors import ZerorevError
from zerorev.files.cell_file import CellFile, read_cell
from zerorev.files.conversion import robot_data, settings_data
from zerorev.files.dh_file import DhFile, axes_of_dh
from zerorev.files.hole_list import in_base_frame, read_hole_list
from zerorev.files.hole_meaning import AS_IN_A_JOB
from zerorev.files.io import job_from_text, plan_from_text, plan_to_json, read_robot, read_tool
from zerorev.files.map_file import read_map_file
from zerorev.files.map_schema import MapFile
from zerorev.files.part import Part
from zerorev.files.plan_schema import PlanFile
from zerorev.files.robot_schema import RobotFile, ToolFile
from zerorev.files.schema import JobFile
from zerorev.files.table_layout import Given
from zerorev.files.text import json_text
from zerorev.files.urdf import read_urdf
from zerorev.files.urdf_axes import arm_of_urdf
from zerorev.files.yaml_text import yaml_text
from zerorev.model._arrays import rotation_rpy, transform
from zerorev.motion.importing import import_robot
from zerorev.planning import job as jobs
from zerorev.program.export import export
from zerorev.program.krl.read import read_krl
from zerorev.visible import one_line, visible

LONGEST = 10.0  # [s] of one input
MOST = 500 * 2**20  # [bytes] that the process may grow by

JOB: dict[str, Any] = {
    "format": "zerorev.job/1", "name": "panel", "robot": "kuka_kr6_r700_2",
    "tool": {"name": "drill", "tcp_mm": [100, 0, 65], "rpy_deg": [0, -90, 0]},
    "part_frame": {"xyz_mm": [10, -20, 30], "rpy_deg": [5, -10, 20]}, "psi_reference": "base_y",
    "min_rate_deg_per_mm": 0.02, "psi_bound_deg": 300, "legs": "straight", "objective": {"travel": 1, "margin": 0.5},
    "reversal_weights": [1, 1, 2, 1, 1, 1], "blend_mm": 2, "blend_shortfall_mm": 0.5, "lead_in_mm": 4,
    "feed_mm_s": {"plunge": 4, "retract": 30}, "spindle_rpm": 3000, "proof_boxes": 0,
    "holes": [
        {"id": "a", "target_mm": [480, 300, 800], "direction": [1, 0, 0], "depth_mm": 20},
        {"id": 2, "target_mm": [490.5, 310, 790], "direction": [2, 0.1, 0], "depth_mm": 12.5, "branch": 4},
        {"id": "c", "target_mm": [480, 330, 800], "direction": [1, 0, 0], "depth_mm": 8, "psi_deg": [10, 20, 30]},
    ],
}  # fmt: skip
MAP: dict[str, Any] = {
    "robot": "kuka_kr6_r700_2", "tool": "thesis_drill", "quantity": "least_travel", "depth_mm": 10, "legs": "straight",
    "targets": {"x_mm": [450, 500.5], "y_mm": {"start": -200, "stop": 200, "step": 50}, "z_mm": [700]},
    "directions": [[1, 0, 0], [1, 0.5, 0]], "min_rate_deg_per_mm": 0.01, "psi_bound_deg": 300,
}  # fmt: skip
CELL = """format: zerorev.cell/1
robot: kuka_kr6_r700_2
parameters:
  friction_2: {nominal: 1.12, low: 1.08, high: 1.16, law: log, basis: fitted, source: sweeps}
  tcp_error: {nominal: 0, low: 0, high: 2.0e-4, law: even}
conditioning: {baseline_mm: {P1: 0.2, '2': 0.15}, feed_mm_s: 200.0, corner_mm: 10.0, factor: 2.0}
"""
TABLE = (
    "id,x_mm,y_mm,z_mm,i,j,k,depth_mm\na,480,300,800,1,0,0,20\nb,490.5,310,790,1,0.1,0,12.5\nc,480,33e1,800,1,0,0,8\n"
)
URDF = """<?xml version="1.0"?><robot name="r"><link name="base"><visual><geometry><box size="1 1 1"/></geometry>
<material name="m"><color rgba="1 0.5 0 1"/></material></visual></link>{}</robot>""".format(
    "".join(
        f'<link name="l{n}"/><joint name="j{n}" type="revolute"><parent link="{f"l{n - 1}" if n else "base"}"/><child '
        f'link="l{n}"/><origin xyz="{n} 0.5 0" rpy="0 0.25 0"/><axis xyz="0 0 1"/></joint>'
        for n in range(6)
    )
)


# --- what other parsers find ------------------------------------------------------------------------------------------


class Core(yaml.SafeLoader):
    """PyYAML's own reader in Python, with the scalars of YAML 1.2's core schema."""

    yaml_implicit_resolvers: dict[str, Any] = {}  # noqa: RUF012


for tag, expression in (
    ("null", r"(?:~|null|Null|NULL|)$"),
    ("bool", r"(?:true|True|TRUE|false|False|FALSE)$"),
    ("int", r"[-+]?[0-9]+$"),
    (
        "float",
        r"(?:[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN))$",
    ),
):
    Core.add_implicit_resolver(f"tag:yaml.org,2002:{tag}", re.compile(expression), None)
Core.add_constructor("tag:yaml.org,2002:int", lambda loader, node: int(node.value))
Core.add_constructor("tag:yaml.org,2002:float", lambda loader, node: float(node.value))


def text_of(data: bytes) -> str:
    return data.decode("utf-8-sig")


def yaml_of(data: bytes) -> Any:
    """By PyYAML's own reader; a tab that separates is none to it, though YAML has it."""
    text = text_of(data)
    try:
        return yaml.load(text, Core)
    except yaml.YAMLError:
        return yaml.load(text.replace("\t", " "), Core)


def same(found: Any, said: Any, path: str = "") -> None:
    """What was read is what is said; what was not said, or said to be null, may have become anything."""
    if said is None:
        return
    if isinstance(said, dict):
        for key, value in said.items():
            if value is not None:
                assert key in found, f"{path}.{key} is not read"
                same(found[key], value, f"{path}.{key}")
    elif isinstance(said, list):
        assert len(found) == len(said), path
        for n, (one, other) in enumerate(zip(found, said, strict=True)):
            same(one, other, f"{path}[{n}]")
    elif isinstance(said, bool):
        assert found is said, path
    elif isinstance(said, (int, float)):
        assert math.isclose(float(found), said, rel_tol=1e-9, abs_tol=1e-9), f"{path}: {found}, but {said} is said"
    else:
        assert found == one_line(said), f"{path}: {found!r}, but {said!r} is said"


def turned(rpy_deg: list[float]) -> Any:
    return Rotation.from_euler("xyz", rpy_deg, degrees=True)


def same_hole(hole: zr.Hole, said: dict[str, Any], frame: dict[str, Any]) -> None:
    """A hole in the base frame, and what a file says of it in the part frame."""
    R, origin = turned(frame.get("rpy_deg", [0, 0, 0])), np.array(frame.get("xyz_mm", [0, 0, 0]), dtype=float)
    assert hole.id == one_line(str(said["id"]))
    np.testing.assert_allclose(hole.target * 1e3, R.apply(said["target_mm"]) + origin, rtol=1e-9, atol=1e-6)
    direction = np.array(said["direction"], dtype=float)
    direction = direction / np.abs(direction).max()
    np.testing.assert_allclose(hole.direction, R.apply(direction / np.linalg.norm(direction)), atol=1e-9)
    if said.get("depth_mm") is not None:
        np.testing.assert_allclose(hole.depth * 1e3, said["depth_mm"], rtol=1e-9)
    assert hole.branch == said.get("branch")
    if said.get("psi_deg") is not None:
        np.testing.assert_allclose(np.rad2deg(hole.profile.psi), said["psi_deg"], rtol=1e-9, atol=1e-9)
    else:
        assert hole.profile is None


# --- the readers ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Reader:
    """A reader, a good file of its kind, and what else to try.

    Attributes:
        good: bytes of a good file.
        check: reads bytes; where they are accepted, compares what was read with what they say.
        load: bytes to plain data, and `dump` back, or None where only bytes are changed.
        schema: of the data, or None.
        share: how many of a thousand inputs are for this reader.
    """

    good: bytes
    check: Callable[[bytes, Path], object]
    load: Callable[[bytes], Any] | None = None
    dump: Callable[[Any], str] | None = None
    schema: Any = None
    share: int = 100


def check_job(data: bytes, _: Path) -> None:
    job = job_from_text(text_of(data), "fuzz.yaml")
    said = yaml_of(data)
    frame = of_kuka(said.get("part_frame", {}), "xyz_mm")
    assert len(job.holes) == len(said["holes"])
    for hole, its in zip(job.holes, said["holes"], strict=True):
        same_hole(hole, as_meant(its, said), frame)
    assert job.robot.name == said["robot"]
    assert job.name == one_line(said.get("name") or "fuzz")
    settings = {key: value for key, value in said.items() if key in settings_data(zr.Settings())}
    if isinstance(settings.get("objective"), dict):  # a weight of 0 is none
        settings["objective"] = {key: value for key, value in settings["objective"].items() if value}
    same(settings_data(job.settings), settings)
    if isinstance(said["tool"], dict):
        tool = of_kuka(said["tool"], "tcp_mm")
        np.testing.assert_allclose(job.tool.T_flange_tcp[:3, 3] * 1e3, tool["tcp_mm"], rtol=1e-9, atol=1e-9)
        turn = turned(tool["rpy_deg"])
        if tool.get("tool_x") == "drill":
            turn = turn * Rotation.from_euler("y", -90, degrees=True)
        turn = turn.as_matrix()
        np.testing.assert_allclose(job.tool.T_flange_tcp[:3, :3], turn, atol=1e-9)


def of_kuka(frame: dict[str, Any], origin: str) -> dict[str, Any]:
    """A frame that is given by x, y, z, a, b, c or abc_deg, in the other keys."""
    lower = {key.lower(): value for key, value in frame.items()}
    if any(key in lower for key in "xyzabc"):
        lower.setdefault(origin, [lower.get(key, 0.0) for key in "xyz"])
        angles = lower["abc_deg"][::-1] if "abc_deg" in lower else [lower.get(key, 0.0) for key in "cba"]
        lower.setdefault("rpy_deg", angles)
    elif "abc_deg" in lower:
        lower["rpy_deg"] = lower["abc_deg"][::-1]
    return lower


def as_meant(hole: dict[str, Any], job: dict[str, Any]) -> dict[str, Any]:
    """A hole with the bottom of its stroke and its direction into the material, of a job that means something else."""
    depth = hole.get("depth_mm") if hole.get("depth_mm") is not None else job.get("depth_mm")
    direction = np.array(hole["direction"], dtype=float) * (-1 if job.get("normals") == "out" else 1)
    further = job.get("breakthrough_mm", 0) + (depth if job.get("point") == "entry" else 0)
    scaled = direction / np.abs(direction).max()
    bottom = np.array(hole["target_mm"], dtype=float) + further * scaled / np.linalg.norm(scaled)
    depth = None if depth is None else depth + job.get("breakthrough_mm", 0)
    return hole | {"target_mm": bottom.tolist(), "direction": direction.tolist(), "depth_mm": depth}


def check_plan(data: bytes, _: Path) -> None:
    same(with_turns(plan_to_json(plan_from_text(text_of(data), "fuzz.json"))), with_turns(json.loads(text_of(data))))


def with_turns(data: Any) -> Any:
    """Matrices instead of roll, pitch and yaw, of which several are the same turn."""
    if isinstance(data, list):
        return [with_turns(each) for each in data]
    if not isinstance(data, dict):
        return data
    return {
        key: turned(value).as_matrix().tolist() if key == "rpy_deg" else with_turns(value)
        for key, value in data.items()
    }


def check_robot(data: bytes, folder: Path) -> None:
    (folder / "robot.yaml").write_bytes(data)
    found, said = read_robot("robot.yaml", folder), yaml_of(data)
    numbers = {
        key: value for key, value in said.items() if key in ("name", "manufacturer", "model", "geometry_mm", "joints")
    }
    same(robot_data(found), numbers)
    same(dict(found.sources), {one_line(key): value for key, value in said.get("sources", {}).items()})


def check_tool(data: bytes, folder: Path) -> None:
    (folder / "tool.yaml").write_bytes(data)
    T, said = read_tool("./tool.yaml", folder).T_flange_tcp, of_kuka(yaml_of(data), "tcp_mm")
    turn = turned(said["rpy_deg"]).as_matrix()
    if said.get("tool_x") == "drill":
        turn = turn @ Rotation.from_euler("y", -90, degrees=True).as_matrix()
    np.testing.assert_allclose(T[:3, 3] * 1e3, said["tcp_mm"], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(T[:3, :3], turn, atol=1e-9)


def check_table(data: bytes, folder: Path) -> None:
    (folder / "holes.csv").write_bytes(data)
    (folder / "job.yaml").write_text("robot: kuka_kr6_r700_2\ntool: thesis_drill\nholes: holes.csv\n")
    check_rows(list(zr.read_job(folder / "job.yaml").holes), data)


def check_rows(holes: list[zr.Hole], data: bytes) -> None:
    """Each hole stands in a line of its own: its id, and all of its numbers, by the module `csv` and `float` alone."""
    lines = [line for line in re.split(r"\r\n|\r|\n", data.decode(encoding_of(data))) if line.strip()]
    left = list(range(len(lines)))
    for hole in holes:
        numbers = [*hole.target * 1e3, hole.depth * 1e3]
        at = next(n for n in left if any(has(cells, hole, numbers) for cells in ways(lines[n])))
        left = left[left.index(at) + 1 :]  # in the order of the file


def encoding_of(data: bytes) -> str:
    return "utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"


def ways(line: str) -> list[list[str]]:
    """The cells of a line, by each of the three separators."""
    found = []
    for delimiter in "\t;,":
        try:
            found += [[cell.strip() for cell in row] for row in csv.reader([line], delimiter=delimiter)]
        except csv.Error:
            continue
    return found


def has(cells: list[str], hole: zr.Hole, numbers: list[float]) -> bool:
    there = []
    for cell in cells:
        try:
            there.append(float(cell.replace(",", ".").replace("\u2212", "-")))
        except ValueError:
            continue
    named = hole.id in map(one_line, cells)
    return named and all(any(math.isclose(x, y, rel_tol=1e-9, abs_tol=1e-9) for y in there) for x in numbers)


def check_sheet(data: bytes, _: Path) -> None:
    listed = read_hole_list(text_of(data), Given(header=False), AS_IN_A_JOB)
    listed = in_base_frame(listed, "base_y", read_tool("thesis_drill"), np.eye(4))
    assert all((row.hole is None) != (row.problem is None) for row in listed.rows)
    check_rows([row.hole for row in listed.rows if row.hole is not None], data)


def check_cell(data: bytes, folder: Path) -> None:
    (folder / "cell.yaml").write_bytes(data)
    cell, said = read_cell(folder / "cell.yaml"), yaml_of(data)
    for name, each in cell.ranges.items():
        assert 0 <= each.low <= each.nominal <= each.high < math.inf
        if given := (said.get("parameters") or {}).get(name):
            assert (each.nominal, each.low, each.high) == (given["nominal"], given["low"], given["high"])
    if cell.conditioning is not None:
        assert cell.conditioning.baseline.keys() == {str(key) for key in said["conditioning"]["baseline_mm"]}


def check_map(data: bytes, folder: Path) -> None:
    (folder / "map.yaml").write_bytes(data)
    task, said = read_map_file(folder / "map.yaml"), yaml_of(data)
    for axis, name in zip(task.axes, ("x_mm", "y_mm", "z_mm"), strict=True):
        given = said["targets"][name]
        if isinstance(given, dict):
            steps = math.floor((given["stop"] - given["start"]) / given["step"] + 1e-9)
            given = [given["start"] + n * given["step"] for n in (0, steps)]
            assert len(axis) == steps + 1
            axis = axis[[0, -1]]
        np.testing.assert_allclose(axis, np.array(given, dtype=float), rtol=1e-9, atol=1e-8)
    given = said["directions"]
    if isinstance(given, list):
        scaled = [each / np.abs(each).max() for each in np.array(given, dtype=float)]
        np.testing.assert_allclose(task.directions, [each / np.linalg.norm(each) for each in scaled], atol=1e-9)
    else:
        count = given["sphere"] if "sphere" in given else given["cone"]["count"]
        assert len(task.directions) == count
    assert task.question.quantity == said.get("quantity", "deepest")


def check_part(data: bytes, _: Path) -> None:
    """Every line has a checksum: what is read is what was written, as far as it goes."""
    plan = plan_to_json(plan_from_text(text_of(data), "fuzz.json.part"))
    for found, wanted in zip(plan["holes"], PART_HOLES, strict=False):
        assert found == wanted


def check_program(data: bytes, _: Path) -> None:
    program = read_krl(text_of(data), "fuzz.src")
    assert program.name.isidentifier()
    moves = [(*move.end.xyz_mm, *move.end.turn) for hole in program.holes for move in hole.moves]
    lines = re.findall(r"(?m)^[ \t]*LIN[ \t]*\{(.*?)\}", text_of(data))
    assert [tuple(map(Decimal, re.findall(r"[-+]?\d*\.?\d+", line))) for line in lines] == moves


def check_urdf(data: bytes, folder: Path) -> None:
    (folder / "robot.urdf").write_bytes(data)
    found, root = read_urdf(folder / "robot.urdf"), ET.fromstring(data)
    joints = {joint.find("child").get("link"): joint for joint in root.findall("joint")}
    assert len(found.chain) + len(found.fixed) == len(root.findall("joint"))
    for joint in found.chain:
        origin = joints[joint.child].find("origin")
        xyz = [0.0] * 3 if origin is None else [float(part) for part in origin.get("xyz", "0 0 0").split()]
        np.testing.assert_allclose(joint.pose[:3, 3], xyz, atol=1e-12)
        assert joints[joint.child].find("parent").get("link") == joint.parent


def pose_of(entry: Any) -> Any:
    origin = entry.find("origin")
    xyz, rpy = ((origin.get(key, "0 0 0") if origin is not None else "0 0 0").split() for key in ("xyz", "rpy"))
    return transform(rotation_rpy(*map(float, rpy)), np.array([float(part) for part in xyz]))


def check_arm(data: bytes, folder: Path) -> None:
    """The arm of a description moves as the file says, joint by joint."""
    (folder / "arm.urdf").write_bytes(data)
    arm, root = arm_of_urdf(folder / "arm.urdf"), ET.fromstring(data)
    joints, q = (
        {joint.find("child").get("link"): joint for joint in root.findall("joint")},
        np.array([0.3, -0.5, 0.7] * 2),
    )
    T, link, angles = np.eye(4), arm.axes.tip, list(q)
    while link in joints:
        joint = joints[link]
        turn = np.eye(4)
        if joint.get("type") != "fixed":
            given = joint.find("axis")  # which may be left out, and is x then
            axis = np.array([float(part) for part in ("1 0 0" if given is None else given.get("xyz")).split()])
            turn[:3, :3] = Rotation.from_rotvec(angles.pop() * axis / np.linalg.norm(axis)).as_matrix()
        T, link = pose_of(joint) @ turn @ T, joint.find("parent").get("link")
    np.testing.assert_allclose(arm.axes.forward(q[None])[0], T, atol=1e-9 * max(1.0, np.abs(T).max()))
    import_robot(folder / "arm.urdf", limits=dict.fromkeys(arm.axes.joint_names, (-90.0, 90.0, 9.0)))


def check_dh(data: bytes, folder: Path) -> None:
    (folder / "arm.yaml").write_bytes(data)
    axes, given = axes_of_dh(folder / "arm.yaml"), yaml_of(data)
    assert list(axes.joint_names) == [visible(row["name"]) for row in given["joints"]]
    stated = [row.get("lower_deg") for row in given["joints"]]
    np.testing.assert_allclose(np.rad2deg(axes.lower), [np.nan if each is None else each for each in stated])
    T = np.eye(4)
    assert given["convention"] in ("standard", "modified")
    for row in given["joints"]:
        a, d = row.get("a_mm", 0) / 1e3, row.get("d_mm", 0) / 1e3
        alpha, theta = np.deg2rad(row.get("alpha_deg", 0)), np.deg2rad(row.get("theta_deg", 0))
        across = transform(rotation_rpy(alpha, 0, 0), np.array([a, 0, 0]))
        along = transform(rotation_rpy(0, 0, theta), np.array([0, 0, d]))
        T = T @ (across @ along if given["convention"] == "modified" else along @ across)
    if "base" not in given and "flange" not in given:
        np.testing.assert_allclose(axes.T_root_tip, T, atol=1e-9 * max(1.0, np.abs(T).max()))
    import_robot(folder / "arm.yaml")


PART_HOLES: list[Any] = []
DH = """format: zerorev.dh/1
name: arm
convention: modified
joints:
- {name: A1, alpha_deg: 180, d_mm: -400, lower_deg: -170, upper_deg: 170, speed_deg_s: 360}
- {name: A2, a_mm: 25, alpha_deg: 90, lower_deg: -190, upper_deg: 45, speed_deg_s: 300}
- {name: A3, a_mm: 335, theta_deg: -90, lower_deg: -120, upper_deg: 156, speed_deg_s: 360}
- {name: A4, a_mm: 25, alpha_deg: 90, d_mm: -365, sign: -1, lower_deg: -185, upper_deg: 185, speed_deg_s: 450}
- {name: A5, alpha_deg: -90, lower_deg: -120, upper_deg: 120, speed_deg_s: 450}
- {name: A6, alpha_deg: 90, d_mm: -90, lower_deg: -350, upper_deg: 350, speed_deg_s: 540}
"""
ARM = '<robot name="arm"><link name="l0"/>' + "".join(
    f'<link name="l{k}"/><joint name="j{k}" type="revolute"><parent link="l{k - 1}"/><child link="l{k}"/>'
    f'<origin xyz="{place}" rpy="0 0 0"/><axis xyz="{axis}"/><limit lower="-2" upper="2" velocity="3"/></joint>'
    for k, (place, axis) in enumerate(
        [("0 0 0", "0 0 1"), ("0.1 0 0.5", "0 1 0"), ("0 0 0.6", "0 1 0"), ("0 0 0.1", "1 0 0"), ("0.6 0 0", "0 1 0"),
         ("0 0 0", "1 0 0")], start=1,
    )
) + '<link name="tool0"/><joint name="f" type="fixed"><parent link="l6"/><child link="tool0"/>' \
    '<origin xyz="0.1 0 0" rpy="0 1.5707963267948966 0"/></joint></robot>'  # fmt: skip


@pytest.fixture(scope="module")
def readers(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Reader]:
    folder = tmp_path_factory.mktemp("good")
    good_job = yaml_text(JOB).encode()
    job = job_from_text(good_job.decode(), "panel.yaml")
    quickly = replace(job, settings=replace(job.settings, weights=()))  # which are sought for long
    plan = replace(zr.plan_job(quickly), settings=job.settings)
    data = plan_to_json(plan)
    with Part(folder / "plan.json", jobs.unanswered(job, "asked"), job.holes) as part:
        for answer in plan.holes:
            part.append(answer)
        part_bytes = part.path.read_bytes()
    PART_HOLES[:] = data["holes"]
    shipped = Path(zr.__file__).parent / "files"
    as_json: Any = {"load": json.loads, "dump": lambda data: json.dumps(data)}
    as_yaml: Any = {"load": yaml_of, "dump": lambda data: yaml.safe_dump(data, sort_keys=False)}
    found = {
        "job": Reader(good_job, check_job, **as_yaml, schema=JobFile, share=250),
        "plan": Reader(json_text(data).encode(), check_plan, **as_json, schema=PlanFile, share=200),
        "robot": Reader((shipped / "robots/yaskawa_gp8.yaml").read_bytes(), check_robot, **as_yaml, schema=RobotFile),
        "tool": Reader(
            (shipped / "tools/thesis_drill.yaml").read_bytes(), check_tool, **as_yaml, schema=ToolFile, share=50
        ),
        "table": Reader(TABLE.encode(), check_table, share=75),
        "sheet": Reader(TABLE.replace(",", ";").encode(), check_sheet, share=75),
        "map": Reader(yaml_text(MAP).encode(), check_map, **as_yaml, schema=MapFile, share=100),
        "cell": Reader(CELL.encode(), check_cell, **as_yaml, schema=CellFile, share=50),
        "part": Reader(part_bytes, check_part, share=50),
        "program": Reader(export(plan).text.encode(), check_program, share=50),
        "urdf": Reader(URDF.encode(), check_urdf, share=50),
        "arm": Reader(ARM.encode(), check_arm, share=50),
        "dh": Reader(DH.encode(), check_dh, **as_yaml, schema=DhFile, share=50),
    }
    for reader in found.values():
        reader.check(reader.good, folder)
    return found


def one_input(reader: Reader, chance: random.Random) -> bytes:
    kind = chance.random()
    if reader.load is None or kind < 0.5:
        return changed_bytes(reader.good, chance)
    assert reader.dump
    if kind < 0.85 or reader.schema is None:
        return reader.dump(changed_data(reader.load(reader.good), chance)).encode("utf-8", "surrogatepass")
    return reader.dump(made_up(reader.schema.model_json_schema(), chance)).encode("utf-8", "surrogatepass")


def check_inputs(readers: dict[str, Reader], count: int, seed: int, folder: Path) -> dict[str, tuple[int, int, float]]:
    """So many inputs; returns for each reader how many were tried and accepted, and the longest time [s]."""
    before, reported = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024, dict[str, tuple[int, int, float]]()
    whole = sum(reader.share for reader in readers.values())
    for name, reader in readers.items():
        chance, accepted, longest, tried = random.Random(f"{seed} {name}"), 0, 0.0, count * reader.share // whole
        for _ in range(tried):
            data = one_input(reader, chance)
            began = time.perf_counter()
            said = outcome(name, reader, data, folder)
            longest = max(longest, time.perf_counter() - began)
            accepted += said is None
            assert said is None or said == visible(said), f"{name}: something unseen in a message"
        reported[name] = tried, accepted, longest
        assert longest < LONGEST, name
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 - before < MOST
    return reported


def outcome(name: str, reader: Reader, data: bytes, folder: Path) -> str | None:
    """Why an input is refused, or None: it is read, and as it says."""
    try:
        reader.check(data, folder)
    except (ZerorevError, UnicodeDecodeError) as error:  # the latter is this test's own, where a reader takes text
        return "not UTF-8" if isinstance(error, UnicodeDecodeError) else str(error)
    except Exception as error:
        raise AssertionError(f"{name}: {data[:2000]!r}") from error
    return None


def test_a_thousand_inputs(readers, tmp_path):
    reported = check_inputs(readers, 1_000, 0, tmp_path)
    assert all(0 < accepted < tried for tried, accepted, _ in reported.values()), reported


@pytest.mark.long
def test_twenty_thousand_inputs(readers, tmp_path, request):
    reported = check_inputs(readers, 20_000, 1, tmp_path)
    words = "; ".join(
        f"{name} {tried} tried, {kept} read, {most:.2f} s" for name, (tried, kept, most) in reported.items()
    )
    request.node.user_properties.append(("measured", words))
    assert sum(tried for tried, *_ in reported.values()) >= 19_900


@pytest.mark.soak
@pytest.mark.parametrize("seed", range(2, 12))
def test_two_hundred_thousand_inputs(readers, tmp_path, seed):
    check_inputs(readers, 20_000, seed, tmp_path)
