"""CAD files read in the process of the tests: a process of its own for each takes a second."""

from __future__ import annotations

import pytest

from zerorev.files.cad import dxf, step


class Here:
    """As `zerorev.apart.Apart`, without another process."""

    def __init__(self, task):
        self.task = task

    def results(self, given):
        return iter(self.task(iter(given)))


@pytest.fixture
def here(monkeypatch):
    for module in (step, dxf):
        monkeypatch.setattr(module, "Apart", Here)
