# make demo    runs the whole chain on a bundled gear set and writes gearmath-demo/
# make test    runs every check, every test and every notebook; what no test reaches is listed in build/coverage.txt
# make quick   the fast tests only
# make lint    ruff, mypy, the layers, stripped notebooks
# make notebooks  runs every notebook; every warning is an error
# make docs    the site, into build/site; takes the notebooks as `make notebooks` ran them
# make bench   speed, as ratios within one run
# make golden  rewrites tests/golden after an intended change of the generated C
# make clean   removes what these have written, apart from .venv
#
# Each builds .venv by itself. Another Python: make demo PYTHON=/path/to/python3.12 - other processes: make test JOBS=4

VENV := .venv
BIN := $(VENV)/bin
JOBS ?= 2
INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check --editable
NOTEBOOKS := $(wildcard notebooks/*.ipynb)

RECENT := import sys; sys.exit(sys.version_info < (3, 11))
ifndef PYTHON
PYTHON := $(shell for p in python3 python3.14 python3.13 python3.12 python3.11 python; do \
	$$p -c '$(RECENT)' 2>/dev/null && echo $$p && break; done)
endif

.PHONY: help demo test quick lint notebooks docs bench golden clean compiler
.DEFAULT_GOAL := help
.DELETE_ON_ERROR:

help:
	@sed -n 's/^# make/make/p' $(firstword $(MAKEFILE_LIST))

demo: $(VENV)/.run compiler
	$(BIN)/gearmath demo

test: $(VENV)/.test compiler lint
	@mkdir -p build
	$(BIN)/python -W 'ignore:Unable to activate pytest branch' -m slipcover --out build/coverage.txt -m pytest \
		-n $(JOBS) --dist loadscope --no-loadscope-reorder --benchmark-disable --durations 10 tests
	@awk 'END { printf "The tests reach %.1f %% of the lines and %.1f %% of the branches; build/coverage.txt lists the others.\n", \
		100 - 100 * $$3 / $$2, 100 - 100 * $$5 / $$4 }' build/coverage.txt
	$(MAKE) --no-print-directory notebooks

quick: $(VENV)/.test compiler
	$(BIN)/pytest -n $(JOBS) --dist loadscope --no-loadscope-reorder --benchmark-disable -m 'not slow' -q tests

lint: $(VENV)/.test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(if $(NOTEBOOKS),$(BIN)/nbstripout --verify $(NOTEBOOKS))

# filterwarnings is emptied for pytest itself; in the notebooks every warning is an error
notebooks: $(VENV)/.test
	$(if $(NOTEBOOKS),PYTHONWARNINGS=error MPLBACKEND=agg $(BIN)/pytest -p nbval.plugin -o filterwarnings= --nbval-lax --nbval-current-env \
		--nbval-cell-timeout 60 -n $(JOBS) --dist loadscope --durations 5 notebooks)

# every warning is an error: a link that leads nowhere, a reference without a target
docs: $(VENV)/.docs
	$(BIN)/sphinx-build -q -W --keep-going -b html -d build/doctrees docs build/site
	@echo "build/site/index.html"

bench: $(VENV)/.test compiler
	$(BIN)/pytest -p no:xdist --benchmark-only --benchmark-group-by group --capture no tests/benchmarks

golden: $(VENV)/.test
	$(BIN)/pytest -p no:xdist --update-golden tests/gearmath/export
	git status --short tests/golden

clean:
	rm -rf build dist docs/notebooks docs/mathematics docs/_static/mathjax gearmath-demo .benchmarks .hypothesis .import_linter_cache .mypy_cache .pytest_cache .ruff_cache
	find derivations gearmath tests notebooks -name __pycache__ -type d -prune -exec rm -rf {} +

$(VENV)/.made:
	@test -n "$(PYTHON)" && $(PYTHON) -c '$(RECENT)' || { echo "gearmath needs Python 3.11 or newer: install it\
	 (Debian, Ubuntu: apt install python3 python3-venv), or name one with PYTHON=/path/to/python3."; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || { echo "$(PYTHON) lacks the venv module: install it\
	 (Debian, Ubuntu: apt install python3-venv)."; exit 1; }
	$(PYTHON) -m venv $(VENV)
	@touch $@

$(VENV)/.run: pyproject.toml | $(VENV)/.made
	@echo "Installing gearmath and what it needs to run into $(VENV), once; this takes about a minute."
	@$(INSTALL) .
	@touch $@

$(VENV)/.test: pyproject.toml | $(VENV)/.made
	@echo "Installing gearmath and what its tests need into $(VENV), once; this takes a minute or two."
	@$(INSTALL) '.[test]'
	@touch $(VENV)/.run $@

$(VENV)/.docs: pyproject.toml | $(VENV)/.made
	@echo "Installing gearmath and what its site is built with into $(VENV), once; this takes a minute or two."
	@$(INSTALL) '.[test,docs]'
	@touch $(VENV)/.run $(VENV)/.test $@

# asked every time: a compiler may have come or gone
compiler: | $(VENV)/.made
	@command -v cc >/dev/null || command -v gcc >/dev/null || { \
		echo "No C compiler (cc, gcc) was found, so the one in the zig wheel is taken instead."; \
		$(BIN)/python -c 'import ziglang' 2>/dev/null || $(INSTALL) '.[zig]'; }
