PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SCENARIO ?= $(or $(SCENE),flapping-full-wings)

COFMPY := $(VENV)/cofmpy

# byte code is made where a module is first used, not of all that is installed
INSTALL := $(BIN)/python -m pip install --quiet --no-compile --constraint constraints.txt

# tests and studies start hundreds of processes: each would compile the package again
export PYTHONDONTWRITEBYTECODE :=

.PHONY: run test lint slow bench docs clean

run: $(VENV)/core
	$(BIN)/python build_fmus.py
	$(BIN)/resilin run $(SCENARIO)
	@echo "resilin in this shell: . $(BIN)/activate"

test: lint $(COFMPY)/ready
	$(BIN)/pytest -n 3 -m "not slow"

lint: $(VENV)/ready
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

slow: $(VENV)/ready $(COFMPY)/ready
	$(BIN)/pytest -n 2 -m slow -o timeout=7200

bench: $(VENV)/ready
	$(BIN)/python build_fmus.py
	$(BIN)/python benchmarks/coupling.py

docs: $(VENV)/docs
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet
	@echo "site/index.html opens offline"

$(VENV)/docs: $(VENV)/ready
	$(INSTALL) --editable ".[docs]"
	touch $@

$(VENV)/core: pyproject.toml constraints.txt
	$(PYTHON) -c "import sys; sys.exit(sys.version_info < (3, 11) and 'Python 3.11 or newer is needed')"
	$(PYTHON) -m venv $(VENV)
	$(INSTALL) --editable .
	touch $@

$(VENV)/ready: $(VENV)/core
	$(INSTALL) --editable ".[dev]"
	touch $@

# a tool that needs another fmpy: its own environment, which looks into ours for all the rest
$(COFMPY)/ready: $(VENV)/ready docs/recipes/cofmpy.txt
	$(PYTHON) -m venv --clear $(COFMPY)
	$(BIN)/python -c "import sysconfig; print(sysconfig.get_path('purelib'))" > $(COFMPY)/ours.pth
	mv $(COFMPY)/ours.pth $$($(COFMPY)/bin/python -c "import sysconfig; print(sysconfig.get_path('purelib'))")
	$(COFMPY)/bin/python -m pip install --quiet --no-deps --requirement docs/recipes/cofmpy.txt
	touch $@

clean:
	rm -rf $(VENV) build results site *.egg-info
