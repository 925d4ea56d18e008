# `make demo` and `make test` do all of their own set-up: a virtual environment, the pinned dependencies, the install.
PYTHON ?= python3
VENV ?= .venv
OUT ?= out/demo
BIN := $(VENV)/bin
READY := $(VENV)/.ready

# what Python has compiled of a module is kept: hundreds of processes import the package while it is tested
export PYTHONDONTWRITEBYTECODE =

.PHONY: demo test long soak bench lint docs reference schemas clean

demo: $(READY)  ## plan, check and export the three positions of the thesis, with figures
	mkdir -p $(OUT)
	@echo "--- the thesis' own plans, evaluated"
	$(BIN)/zerorev plan examples/jobs/thesis_published.yaml -o $(OUT)/thesis_published.plan.json
	@echo "--- the least travel without a reversal, motion threshold off"
	$(BIN)/zerorev plan examples/jobs/thesis_least_travel.yaml -o $(OUT)/thesis_least_travel.plan.json
	@echo "--- the default: every joint keeps moving, at every point"
	$(BIN)/zerorev plan examples/jobs/thesis_positions.yaml -o $(OUT)/thesis_positions.plan.json --figures $(OUT)/figures
	$(BIN)/zerorev check $(OUT)/thesis_positions.plan.json
	$(BIN)/zerorev export $(OUT)/thesis_positions.plan.json --controller krl -o $(OUT)/thesis_positions.src

test: lint  ## what must hold; the tests marked long are left to `make long`
	@# kernels are compiled before several processes need them: two compilations of one may differ in the last bit
	$(BIN)/zerorev plan examples/jobs/thesis_positions.yaml --json >/dev/null
	$(BIN)/zerorev depth examples/jobs/thesis_positions.yaml --legs free --json >/dev/null
	NUMBA_DISABLE_JIT=1 $(BIN)/pytest -q -n auto --dist loadgroup tests/kernels tests/verify/test_compiled.py -m "not long and not soak"
	$(BIN)/pytest -q -n auto --dist loadgroup -m "not long and not soak"

long: $(READY)  ## the tests that take minutes
	$(BIN)/pytest -q -n auto --dist loadgroup -m "long and not soak"

soak: $(READY)  ## the tests that take longer than CI allows
	$(BIN)/pytest -q -m soak

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python tools/plain_english.py

docs: $(READY)  ## the documentation site, in out/site; a broken link, a missing anchor or a page outside the menu fails
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet --strict
	@echo "out/site/index.html"

reference: $(READY)  ## rewrite the page of commands from their help texts, and the tables of settings and criteria
	$(BIN)/python tools/commands_page.py
	$(BIN)/python tools/tables.py

bench: $(VENV)/.bench  ## zerorev and its peers at the same work; a part or less of it: make bench BENCH="field --quick"
	$(BIN)/python -m benchmarks.run $(BENCH)

schemas: $(READY)  ## rewrite the published JSON Schemas of job and plan files
	$(BIN)/python -c "from zerorev.files.io import write_schemas; write_schemas('docs/schemas')"

$(READY): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt hatchling editables
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --no-build-isolation --editable ".[dev]"
	touch $(READY)

$(VENV)/.bench: $(READY)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --no-build-isolation --editable ".[dev,bench]"
	touch $(VENV)/.bench

clean:
	rm -rf $(VENV) out build dist
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
