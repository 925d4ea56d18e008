"""Time and memory of the largest input that each reader accepts, each in a process of its own.

    python -m benchmarks.readers_study

The table stands in docs/security.md.
"""

from __future__ import annotations

import gzip
import json
import multiprocessing
import re
import struct
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import zerorev as zr
from zerorev.cell.recordings.channels import column_name
from zerorev.cell.recordings.krc4_write import write_krc4
from zerorev.cell.recordings.read import read_recording
from zerorev.cell.recordings.rsi import MAX_DOCUMENTS
from zerorev.cell.recordings.table import MAX_ROWS as MOST_RECORDED
from zerorev.files.hole_list import MOST_PASTED, in_base_frame, read_hole_list
from zerorev.files.hole_meaning import AS_IN_A_JOB
from zerorev.files.io import plan_to_json, read_plan
from zerorev.files.map_file import read_map_file
from zerorev.files.table_layout import Given
from zerorev.files.text import MAX_BYTES, MAX_ROWS
from zerorev.files.text import MAX_VALUES as JSON_VALUES
from zerorev.files.urdf import MOST_PARTS, read_urdf
from zerorev.files.values import MOST_HOLES
from zerorev.files.yaml_text import MAX_VALUES
from zerorev.model.recording import JOINT_ARRAYS, Recording
from zerorev.program.dialects import MOST_BYTES, read_program
from zerorev.program.export import export
from zerorev.report.scene.urdf_meshes import MOST_MESH, _loaded

HEAD = "robot: kuka_kr6_r700_2\ntool: thesis_drill\n"
VALUES_OF_A_HOLE = 12
COLUMNS = "id,x_mm,y_mm,z_mm,i,j,k,depth_mm"


@dataclass(frozen=True)
class Worst:
    """The largest input of a reader.

    Attributes:
        what: in words.
        write: makes it in a folder; returns its path.
        read: reads it.
    """

    what: str
    write: Callable[[Path], Path]
    read: Callable[[Path], object]


def _job(folder: Path) -> Path:
    line = "  - {{id: h{}, target_mm: [500.25, 300, 800], direction: [1, 0, 0], depth_mm: 20}}\n"
    holes = "".join(map(line.format, range(MAX_VALUES // VALUES_OF_A_HOLE - 2)))
    return _written(folder / "job.yaml", f"{HEAD}holes:\n{holes}")


def _table(count: int) -> str:
    return f"{COLUMNS}\n" + "".join(f"h{n},500.25,300.5,800,1,0,0,20\n" for n in range(count))


def _csv(folder: Path) -> Path:
    _written(folder / "holes.csv", _table(MOST_HOLES))
    return _written(folder / "job.yaml", f"{HEAD}holes: holes.csv\n")


def _points(folder: Path) -> Path:
    _written(folder / "p.csv", "id,x_mm,y_mm,z_mm\n" + "".join(f"p{n},500.25,{n},800\n" for n in range(MAX_ROWS)))
    return _written(folder / "map.yaml", f"{HEAD}points: p.csv\ndirections: [[1, 0, 0]]\n")


def _grid(folder: Path) -> Path:
    ends = {"x": 1000, "y": 1000, "z": 100}
    axes = "".join(f"  {name}_mm: {{start: 1, stop: {end}, step: 1}}\n" for name, end in ends.items())
    return _written(folder / "map.yaml", f"{HEAD}directions: [[1, 0, 0]]\ntargets:\n{axes}")


def _planned() -> Any:
    hole = zr.Hole("h", [0.5, 0.3, 0.8], [1, 0, 0], 0.02)
    settings = zr.Settings(min_rate=0.0, proof_boxes=0)
    return zr.plan_job(zr.Job(zr.read_robot("kuka_kr6_r700_2"), zr.read_tool("thesis_drill"), (hole,), settings))


def _plan(folder: Path) -> Path:
    data = plan_to_json(_planned())
    (hole,) = data["holes"]
    text = json.dumps(hole)
    count = min(MAX_BYTES // (len(text) + 10), (JSON_VALUES - 1000) // (1 + sum(map(text.count, ",[{"))))
    data["holes"] = [hole | {"id": f"h{n}"} for n in range(count)]
    return _written(folder / "plan.json", json.dumps(data))


def _program(folder: Path) -> Path:
    text = export(_planned()).text
    begins = text.index("; hole") if "; hole" in text else text.index("PTP {")
    head, hole, end = text[:begins], text[begins : text.rindex("END")], text[text.rindex("END") :]
    count = (MOST_BYTES - len(text)) // len(hole.encode()) - 1
    return _written(folder / "p.src", head + hole * count + end)


def _urdf(folder: Path) -> Path:
    joint = (
        '<link name="l{0}"/><joint name="j{0}" type="{1}"><parent link="{2}"/><child link="l{0}"/>'
        '<origin xyz="0.1 0 0" rpy="0 0 0"/><axis xyz="0 0 1"/></joint>'
    )
    kinds = ["revolute"] * 6 + ["fixed"] * (MOST_PARTS - 7)
    parts = (joint.format(n, kind, f"l{n - 1}" if n else "base") for n, kind in enumerate(kinds))
    blank = "<!--" + "x" * (19 * 2**20) + "-->"
    return _written(folder / "r.urdf", f'<robot name="r">{blank}<link name="base"/>{"".join(parts)}</robot>')


def _mesh(folder: Path) -> Path:
    triangle = struct.pack("<12fH", *([0.0] * 3), 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)
    count = MOST_MESH // len(triangle) - 2
    path = folder / "m.stl"
    path.write_bytes(b"\0" * 80 + struct.pack("<I", count) + triangle * count)
    return path


def _pasted(folder: Path) -> Path:
    return _written(folder / "t.csv", _table(MOST_PASTED))


def _sheet(path: Path) -> object:
    listed = read_hole_list(path.read_text(), Given(), AS_IN_A_JOB, most=MOST_PASTED)
    return in_base_frame(listed, "base_y", zr.read_tool("thesis_drill"), np.eye(4))


def _recorded_table(folder: Path) -> Path:
    names = ",".join(column_name(member, n) for member in JOINT_ARRAYS for n in range(6))
    row = "," + ",".join(["1.5"] * 24)
    count = min(MOST_RECORDED, (MAX_BYTES - 1000) // (len(row) + 8))
    with (folder / "run.csv").open("w") as stream:
        stream.write(f"t_s,{names}\n")
        stream.writelines(f"{n}{row}\n" for n in range(count))
    return folder / "run.csv"


def _capture(folder: Path) -> Path:
    axes = " ".join(f'A{n}="{n}.123456"' for n in range(1, 7))
    tip = 'X="1.5" Y="2.5" Z="3.5" A="0" B="90" C="0"'
    body = f"<RIst {tip}/><RSol {tip}/><AIPos {axes}/><ASPos {axes}/>"
    with gzip.open(folder / "run.xml.gz", "wb", compresslevel=1) as stream:
        for n in range(MAX_DOCUMENTS):
            stream.write(f'<Rob Type="KUKA">{body}<IPOC>{4 * n}</IPOC></Rob>\n'.encode())
    return folder / "run.xml.gz"


def _trace(folder: Path) -> Path:
    """Six files of four channels, a gibibyte together; empty but for their headers."""
    time_of_it = np.arange(8.0)
    write_krc4(Recording(time_of_it, *np.zeros((3, 8, 6)), torque_commanded=np.ones((8, 6))), folder / "run")
    rows = 2**30 // 6 // 32
    for header in folder.glob("*.dat"):
        text = header.read_text(encoding="cp1252").replace("220,8", f"220,{rows}")
        header.write_text(re.sub(r"25[01],.*\n", "", text), encoding="cp1252")
        with header.with_suffix(".r64").open("r+b") as stream:
            stream.truncate(rows * 32)
    return folder / "run"


def _written(path: Path, text: str) -> Path:
    path.write_text(text)
    return path


WORST = (
    Worst(f"job (YAML), {MAX_VALUES:,} values", _job, zr.read_job),
    Worst(f"job, holes in a CSV file, {MOST_HOLES:,}", _csv, zr.read_job),
    Worst(f"plan (JSON), {JSON_VALUES:,} values", _plan, read_plan),
    Worst("map (YAML), 100,000,000 cells", _grid, read_map_file),
    Worst(f"map, points in a CSV file, {MAX_ROWS:,}", _points, read_map_file),
    Worst(f"pasted table, {MOST_PASTED:,} rows", _pasted, _sheet),
    Worst("program (KRL), 16 MiB", _program, read_program),
    Worst("robot description (URDF), 20 MiB", _urdf, read_urdf),
    Worst("mesh (STL), 24 MiB", _mesh, _loaded),
    Worst(f"recorded table (CSV), {MOST_RECORDED:,} rows or 64 MiB", _recorded_table, read_recording),
    Worst(f"capture of RSI (XML in gzip), {MAX_DOCUMENTS:,} documents", _capture, read_recording),
    Worst("trace (KRC4), 1 GiB", _trace, read_recording),
)


def _measured(number: int, path: Path, answer: Any) -> None:
    began, worst = time.perf_counter(), WORST[number]
    try:
        worst.read(path)
        said = "read"
    except zr.ZerorevError as error:
        said = str(error)[:100]
    status = Path("/proc/self/status").read_text(encoding="ascii")
    peak = re.search(r"VmHWM:\s*(\d+)", status)
    assert peak
    answer.put((time.perf_counter() - began, int(peak[1]) / 1024, said))


def main() -> None:
    """Print the table; of some readers alone, by their numbers on the command line."""
    chosen = [int(number) for number in sys.argv[1:]] or range(len(WORST))
    context = multiprocessing.get_context("spawn")
    print("| input | file | time | memory |\n|---|---|---|---|")
    for number in chosen:
        worst = WORST[number]
        with tempfile.TemporaryDirectory() as folder:
            path, answer = worst.write(Path(folder)), context.Queue()
            process = context.Process(target=_measured, args=(number, path, answer))
            process.start()
            seconds, megabytes, said = answer.get()
            process.join()
            size = sum(file.stat().st_size for file in Path(folder).iterdir()) / 2**20
            note = "" if said == "read" else f" ({said})"
            print(f"| {worst.what}{note} | {size:.1f} MiB | {seconds:.1f} s | {megabytes:.0f} MiB |", flush=True)


if __name__ == "__main__":
    main()
