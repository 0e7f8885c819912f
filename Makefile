PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
SCENE ?= flapping-full-wings

.PHONY: run test lint slow bench clean

run: $(VENV)/ready
	$(BIN)/python build_fmus.py
	$(BIN)/resilin run $(SCENE)

test: lint
	$(BIN)/pytest -n 2 -m "not slow"

lint: $(VENV)/ready
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

slow: $(VENV)/ready
	$(BIN)/pytest -n 2 -m slow

bench: $(VENV)/ready
	$(BIN)/python build_fmus.py
	$(BIN)/python benchmarks/coupling.py

$(VENV)/ready: pyproject.toml constraints.txt
	$(PYTHON) -c "import sys; sys.exit(sys.version_info < (3, 11) and 'Python 3.11 or newer is needed')"
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --constraint constraints.txt --editable ".[dev]"
	touch $@

clean:
	rm -rf $(VENV) build results *.egg-info
