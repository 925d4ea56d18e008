"""A large panel to drill: holes at random places of a gently curved sheet, each along its own normal."""

from __future__ import annotations

from pathlib import Path

import numpy as np

__all__ = ["write_panel"]

WIDTH, HEIGHT = 220.0, 180.0  # [mm]
BULGE = 900.0  # [mm] radius of the sheet's curvature
DEPTHS = 4.0, 12.0  # [mm]
JOB = """
name: panel
robot: kuka_kr6_r700_2
tool: thesis_drill
part_frame: {xyz_mm: [480, 150, 720], rpy_deg: [0, -60, 0]}
psi_reference: part_y
holes: panel.csv
"""


def write_panel(folder: Path, count: int, seed: int = 0, **settings: object) -> Path:
    """Write the job of a panel with its table of holes.

    Args:
        folder: where.
        count: of holes.
        seed: of their places and depths.
        settings: further keys of the job, and their values as YAML has them.

    Returns:
        the job file.
    """
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(-0.5, 0.5, (2, count)) * np.array([[WIDTH], [HEIGHT]])
    depth = rng.uniform(*DEPTHS, count)
    # the sheet bulges towards the robot: the top of a sphere, drilled towards its centre
    z = np.sqrt(BULGE**2 - x**2 - y**2)
    normal = -np.stack([x, y, z], axis=-1) / BULGE
    lines = [
        f"P{n:05d},{x[n]:.3f},{y[n]:.3f},{z[n] - BULGE:.3f},{i:.6f},{j:.6f},{k:.6f},{depth[n]:.2f}"
        for n, (i, j, k) in enumerate(normal)
    ]
    (folder / "panel.csv").write_text("\n".join(["id,x_mm,y_mm,z_mm,i,j,k,depth_mm", *lines]) + "\n", encoding="utf-8")
    further = "".join(f"{key}: {value}\n" for key, value in settings.items())
    job = folder / "job.yaml"
    job.write_text(JOB + further, encoding="utf-8")
    return job
