"""The wheel in an environment with its base dependencies alone: what works there, and what names the extra it needs."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
from importlib.metadata import Distribution, distribution
from pathlib import Path

import pytest
from packaging.requirements import Requirement

import zerorev
from oracles import shown
from oracles.places import ROOT

pytestmark = pytest.mark.long

EXTRAS = ("matplotlib", "flint", "xarray", "zarr", "plotly", "distributed", "jinja2", "nicegui", "contourpy", "trimesh",
          "pymoo", "cma", "pytest")  # fmt: skip
# a command, and the extra that it names where that is missing
NEEDING = (
    ("plan plate.yaml --figures pictures", "figures"),
    ("plan plate.yaml --report page.html", "report"),
    ("check plate.json --report page.html", "report"),
    ("offset plate.yaml --figure picture.png", "figures"),
    ("place plate.yaml --z-mm=-10:10 --figures pictures", "figures"),
    ("methods plate.yaml --figure picture.png", "figures"),
    ("methods plate.yaml --methods pymoo_pso --seeds 1", "methods"),
    ("methods plate.yaml --methods cma --seeds 1", "methods"),
    ("check plate.json --certify", "certify"),
    ("check plate.json --proof", "certify"),
    ("map map.yaml -o map.zarr", "maps"),
    ("map show map.zarr", "maps"),
    ("map compare map.zarr map.zarr", "maps"),
    ("parameter-map plate.yaml", "maps"),
    ("plan plate.yaml --scheduler tcp://127.0.0.1:9", "cluster"),
    ("depth plate.yaml --scheduler tcp://127.0.0.1:9", "cluster"),
    ("place plate.yaml --z-mm=-10:10 --scheduler tcp://127.0.0.1:9", "cluster"),
    ("share plate.yaml plate.yaml --scheduler tcp://127.0.0.1:9", "cluster"),
    ("view plate.yaml", "view"),
    ("replay plate.json -o replay.html", "view"),
    ("reproduce chapter4 -o pages", "report"),
)


def _run(*arguments: str | Path, folder: Path) -> subprocess.CompletedProcess[str]:
    """A process that sees nothing of this environment."""
    kept = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "VIRTUAL_ENV", "COLUMNS"))}
    command = [os.fspath(each) for each in arguments]
    return subprocess.run(
        command, cwd=folder, env={**kept, "COLUMNS": "200"}, capture_output=True, text=True, check=False, timeout=600
    )


def _needed(name: str, known: dict[str, Distribution]) -> dict[str, Distribution]:
    """A distribution and all that it depends on without any extra."""
    if name.lower() not in known:
        known[name.lower()] = found = distribution(name)
        for text in found.requires or ():
            each = Requirement(text)
            if each.marker is None or each.marker.evaluate({"extra": ""}):
                _needed(each.name, known)
    return known


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    """Built as a release is, without the network."""
    folder = tmp_path_factory.mktemp("wheel")
    done = subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", os.fspath(folder)],
        cwd=ROOT, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    (file,) = folder.glob("*.whl")
    return file


@pytest.fixture(scope="module")
def bin_folder(wheel, tmp_path_factory) -> Path:
    """Of an environment with the wheel and, linked from here, what its base dependencies are made of, and no more."""
    home = tmp_path_factory.mktemp("base") / "env"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", os.fspath(home)], check=True)
    scripts = Path(sysconfig.get_path("scripts", "venv", {"base": os.fspath(home)}))
    subprocess.run(
        [sys.executable, "-m", "pip", "--python", os.fspath(scripts / "python"), "install", "--quiet", "--no-deps",
         "--no-index", "--disable-pip-version-check", os.fspath(wheel)],
        check=True,
    )  # fmt: skip
    site = Path(_run(scripts / "python", "-c", "import sysconfig; print(sysconfig.get_path('purelib'))", folder=home)
                .stdout.strip())  # fmt: skip
    (own,) = Distribution.discover(name="zerorev", path=[os.fspath(site)])
    base = [Requirement(text) for text in own.requires or () if "extra ==" not in text]
    known: dict[str, Distribution] = {}
    for each in base:
        _needed(each.name, known)
    for found in known.values():
        for part in {file.parts[0] for file in found.files or ()} - {"..", "__pycache__"}:
            if not (site / part).exists():
                (site / part).symlink_to(os.fspath(found.locate_file(part)))
    _take_over_compiled_kernels(Path(zerorev.__file__).parent, site / "zerorev")
    return scripts


def _take_over_compiled_kernels(there: Path, here: Path) -> None:
    """So that nothing is compiled again: the same files, of the same time, with what was made of them."""
    for name in ("kernels", "verify"):
        for file in (here / name).glob("*.py"):
            assert file.read_bytes() == (there / name / file.name).read_bytes()
            shutil.copystat(there / name / file.name, file)
        (here / name / "__pycache__").mkdir(exist_ok=True)
        for file in (there / name / "__pycache__").glob("*.nb?"):
            shutil.copy2(file, here / name / "__pycache__")


@pytest.fixture(scope="module")
def work(tmp_path_factory) -> Path:
    """A folder with the files of README and a map's."""
    folder = tmp_path_factory.mktemp("work")
    for language in ("yaml", "csv"):
        for after, text in shown.blocks(ROOT / "README.md", language):
            if name := re.search(r'title="([\w.]+)"', after):
                (folder / name[1]).write_text(text)
    shutil.copy(ROOT / "examples/maps/table5_plane.yaml", folder / "map.yaml")
    (folder / "map.zarr").mkdir()
    return folder


def test_there_is_nothing_but_the_base(bin_folder, work):
    code = (
        "import importlib.util as u, json, sys; import zerorev;"
        f"print(json.dumps([zerorev.__file__, [n for n in {EXTRAS!r} if u.find_spec(n)], sys.path]))"
    )
    done = _run(bin_folder / "python", "-c", code, folder=work)
    where, found, path = json.loads(done.stdout)
    assert found == []
    assert where.startswith(os.fspath(bin_folder.parent))
    assert [
        each for each in path if "site-packages" in each and not each.startswith(os.fspath(bin_folder.parent))
    ] == []


def test_the_python_of_readme_runs(bin_folder, work):
    ((_, code),) = shown.blocks(ROOT / "README.md", "python")
    done = _run(bin_folder / "python", "-W", "error", "-c", code, folder=work)
    assert (done.stdout, done.returncode) == ("6 -> 0 True\n", 0), done.stderr


def test_the_job_of_readme_is_planned_checked_and_exported(bin_folder, work):
    for line in (
        "plan plate.yaml -o plate.json",
        "check plate.json",
        "export plate.json --controller krl -o plate.src",
    ):
        done = _run(bin_folder / "zerorev", *line.split(), folder=work)
        assert done.returncode == 0, done.stderr
    assert [hole.score.reversals for hole in zerorev.read_plan(work / "plate.json").holes] == [0, 0]
    assert (work / "plate.src").stat().st_size > 1000


def test_every_command_that_needs_an_extra_names_it(bin_folder, work):
    code = "import json, sys, zerorev.cli as c; print(json.dumps([c.main(line.split()) for line in sys.argv[1:]]))"
    done = _run(bin_folder / "python", "-c", code, *(line for line, _ in NEEDING), folder=work)
    named = re.findall(r"pip install 'zerorev\[(\w+)\]'", re.sub(r"\s+", " ", done.stderr))
    assert named == [extra for _, extra in NEEDING], done.stderr
    assert json.loads(done.stdout) == [2] * len(NEEDING)


def test_a_plan_shows_itself_without_a_picture_and_figures_name_their_extra(bin_folder, work):
    code = (
        "import zerorev as zr; robot, tool = zr.read_robot('kuka_kr6_r700_2'), zr.read_tool('thesis_drill');"
        "html = zr.Plan(robot, tool, zr.Settings(), ())._repr_html_(); print('<table>' in html, '<img' in html);"
        "zr.figures"
    )
    done = _run(bin_folder / "python", "-c", code, folder=work)
    assert done.stdout == "True False\n"
    assert "pip install 'zerorev[figures]'" in done.stderr
