# `make` lists the targets. Each one sets up what it needs: nothing but Python >= 3.11 is assumed. Where there is no C
# compiler, one comes from pip.

PYTHON ?= python3
BIN := .venv/bin
PIP = $(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt
RUN := .venv/.installed-to-run
DEV := .venv/.installed-to-develop
DOCS := .venv/.installed-to-document
COMPILER ?= $(shell command -v cc || command -v gcc || command -v clang)
COMMA := ,
PARTS = page,verify,control$(if $(COMPILER),,$(COMMA)compiler)

WORKERS ?= 2
CHECKED = $(shell grep -rlwE --include='test_*.py' 'pytest\.mark\.(unit|contract)' tests)
PYTEST = $(BIN)/python -m pytest -n $(WORKERS) --dist loadgroup

.DEFAULT_GOAL := help
.PHONY: help setup demo docs check test test-all style lint format bench clean

help:  ## list the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## ?/  make \1\t/' | expand -t 18

setup: $(DEV)  ## own virtual environment with everything in it

$(RUN): pyproject.toml constraints.txt
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(PIP) pip
	$(PIP) --editable ".[$(PARTS)]"
	$(BIN)/python -m compileall -q src
	touch $@

$(DEV): $(RUN)
	$(PIP) --group dev
	touch $@

$(DOCS): $(RUN)
	$(PIP) --group docs
	touch $@

demo: $(RUN)  ## the paper's whole study: figures, data and report in build/demo
	rm -rf build/demo
	$(BIN)/flexapod replicate --out build/demo

docs: $(DOCS)  ## the documentation as a site: build/site/index.html
	$(BIN)/python -m docs.site

check: style  ## style, types, import layers, tests of functions and contracts: within 90 s
	$(PYTEST) -m "not whole" $(CHECKED) tests/meta/test_types.py

test: style  ## the same and all kinds of tests, one case of each family: within 6 minutes
	$(PYTEST) -m "not whole"

test-all: style  ## all tests: within 12 minutes
	$(PYTEST)

lint: style  ## style, types and import layers, no tests
	$(BIN)/pyright src

style: $(DEV)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports

format: $(DEV)  ## rewrite the code in the project's style
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

bench: $(RUN)  ## measured speed, printed; OTHER=folder of a checkout: whole calls beside its own
	$(BIN)/python -m benchmarks
	$(if $(OTHER),$(BIN)/python -m benchmarks.whole_calls $(OTHER))

clean:  ## remove what the targets made
	rm -rf build .venv .hypothesis .import_linter_cache .pytest_cache .ruff_cache
