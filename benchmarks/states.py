"""Two states of zerorev at the same work, in turns: each plans in a process of its own that imports one checkout.

An older state is a git worktree of an older commit (`git worktree add PATH COMMIT`), given to the benchmark as
`--old PATH`. Both processes run this very file, so all but the package is the same.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

__all__ = ["NEW", "OLD", "ROOT", "Planner", "environment", "planners"]

ROOT = Path(__file__).parents[1]
NEW, OLD = "now", "before"


class Planner:
    """A process that plans one hole after the other by the package of one checkout."""

    def __init__(self, checkout: Path) -> None:
        command = [sys.executable, str(Path(__file__).resolve())]
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=environment(checkout)
        )

    def __call__(self, job: dict[str, Any]) -> dict[str, Any]:
        """Plan the first hole of a job.

        Args:
            job: keys and values of a job file; keys that the checkout does not know are left out.

        Returns:
            `seconds` of the processor, `reversals`, `depth_mm` of the deepest stroke, and `passed` of the check.

        Raises:
            RuntimeError: the process ended.
        """
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        with suppress(BrokenPipeError):
            self._process.stdin.write(json.dumps(job) + "\n")
            self._process.stdin.flush()
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError("a process that plans ended before its time")
        answer: dict[str, Any] = json.loads(line)
        return answer

    def close(self) -> None:
        """End the process."""
        with suppress(BrokenPipeError):
            self._process.communicate()


@contextmanager
def planners(old: Path | None) -> Iterator[dict[str, Planner]]:
    """A planner of this checkout, and one of an older checkout where there is one."""
    with ExitStack() as stack:
        found = {}
        for name, checkout in ((NEW, ROOT), (OLD, old)):
            if checkout is not None:
                found[name] = Planner(checkout)
                stack.callback(found[name].close)
        yield found


def environment(checkout: Path) -> dict[str, str]:
    """The environment of a process that imports the package of a checkout."""
    return os.environ | {"PYTHONPATH": str(checkout.resolve() / "src")}


def _serve() -> None:
    """Answer jobs, one per line, until there are no more."""
    import zerorev
    from zerorev.files.io import job_from_dict
    from zerorev.files.schema import JobFile

    for line in sys.stdin:
        asked = {key: value for key, value in json.loads(line).items() if key in JobFile.model_fields}
        job = job_from_dict(asked)
        began = time.process_time()
        answer = zerorev.plan(job.robot, job.tool, job.holes[0], job.settings)
        found = {
            "seconds": time.process_time() - began,
            "reversals": None if answer.score is None else answer.score.reversals,
            "depth_mm": None if answer.deepest is None else answer.deepest * 1e3,
            "passed": answer.verified is not None and answer.verified.passed,
        }
        print(json.dumps(found), flush=True)


if __name__ == "__main__":
    _serve()
