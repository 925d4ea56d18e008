"""Write src/zerorev/kernels/ahead.json: the kernels that Python calls for each question, as helpers compile them.

    python tools/kernels_ahead.py

Each question is asked of the positions of the thesis, or of its plane, in a process of its own. The kernel of the most
machine code comes first, since it takes longest; then those that are called last, to which the process that asks comes
last. `tests/kernels/test_ahead.py` asks the same and compares.
"""

from __future__ import annotations

import json
import subprocess
import sys

from zerorev.kernels._ahead import LIST

__all__ = ["ASKED", "called_for"]

ASKED = {
    f"{what} with {legs} legs": f"""
for hole in job.holes:
    zr.{function}(job.robot, job.tool, hole, replace(job.settings, legs={legs!r}))
"""
    for legs in ("straight", "free")
    for what, function in (("plan", "plan"), ("deepest stroke", "plan_deepest"))
} | {
    "map of deepest": """
with TemporaryDirectory() as folder:
    run_map(read_map_file("examples/maps/table5_plane.yaml"), Path(folder, "map.zarr"))
"""
}
ASKING = """
import json
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import zerorev as zr
from zerorev.files.map_file import read_map_file
from zerorev.kernels._ahead import kernel_of, written_type
from zerorev.kernels._compiling import called_so_far
from zerorev.maps.run import run_map

job = zr.read_job("examples/jobs/thesis_positions.yaml")
{asked}

def size(kernel, arguments):
    key = kernel._cache._key("machine code", arguments, kernel.targetctx.codegen())
    return len(kernel._cache._cache_file.load(key)[0])

print(json.dumps([
    [size(kernel_of(name), arguments), name, [written_type(each) for each in arguments]]
    for name, arguments in called_so_far
]))
"""


def called_for(question: str) -> list[list[object]]:
    """The kernels that Python calls for a question, each with the types of its arguments."""
    code = ASKING.format(asked=ASKED[question])
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    found = json.loads(done.stdout)
    greatest = found.index(max(found))
    ordered = [found[greatest], *reversed(found[:greatest] + found[greatest + 1 :])]
    return [call for _, *call in ordered]


if __name__ == "__main__":
    lines = [
        f" {json.dumps(question)}: [\n" + ",\n".join(f"  {json.dumps(each)}" for each in called_for(question)) + "\n ]"
        for question in ASKED
    ]
    LIST.write_text("{\n" + ",\n".join(lines) + "\n}\n")
