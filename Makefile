# make demo, make check, make test, make thorough, make lint, make javascript, make kernels, make mechanics, make schema, make answers, make picture, make lock, make clean
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
RUNTIME := $(VENV)/.installed-runtime
DEV := $(VENV)/.installed-dev
COMPILE := $(BIN)/uv pip compile pyproject.toml --universal --python-version 3.11 --generate-hashes \
	--no-emit-index-url --no-annotate --custom-compile-command "make lock" --quiet

# What systems do differently: its types are checked for each of them, a second for one.
DIFFERENT := synth/system/operating_system.py

.PHONY: demo check test thorough lint javascript kernels mechanics schema answers picture gallery lists screens lock clean

demo: $(RUNTIME)
	$(BIN)/clutchsynth run examples/hoist_multi_plate.yaml -o out/

# Tests start many processes; without compiled bytecode each of them would read all sources again.
unexport PYTHONDONTWRITEBYTECODE
# Files go to processes as a whole, in the order of tests/conftest.py.
TESTS := $(BIN)/python -m pytest -n auto --dist loadscope --no-loadscope-reorder

# All but the tests that are slow; `test` is everything, as the build runs it.
check: lint
	$(TESTS) -m "not slow"

test: lint
	$(TESTS)

# Random tests many times, for changes of what claims rest on.
thorough: lint
	$(TESTS) --thorough

lint: $(DEV)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/mypy --platform win32 --cache-dir .mypy_cache/win32 --follow-imports skip $(DIFFERENT)
	$(BIN)/mypy --platform darwin --cache-dir .mypy_cache/darwin --follow-imports skip $(DIFFERENT)
	@$(MAKE) --no-print-directory javascript

# JavaScript: types, rules, tests. Where Node is missing or older, or no package comes from npm, one line says that
# nothing was checked; a lock that does not fit package.json (EUSAGE) is a fault.
NODE_MODULES := node_modules/.installed
NPM_TOLD := build/npm_ci.txt
FITTING_NODE := node -e 'const [a, b] = process.versions.node.split(".").map(Number); process.exit(a > 20 || (a === 20 && b >= 19) ? 0 : 1)'
javascript:
	@if ! command -v npm > /dev/null || ! $(FITTING_NODE) 2> /dev/null; then \
		echo "JavaScript was not checked: that needs Node 20.19 or newer, with npm"; \
	elif ! $(MAKE) --silent $(NODE_MODULES) 2> /dev/null; then \
		if grep -q EUSAGE $(NPM_TOLD); then head -5 $(NPM_TOLD) >&2; exit 1; fi; \
		echo "JavaScript was not checked: npm ci could not install the packages ($(NPM_TOLD) tells why)"; \
	else \
		node_modules/.bin/tsc && node_modules/.bin/eslint . && node --test --test-reporter=dot tests/ui/*.test.mjs; \
	fi

$(NODE_MODULES): package.json package-lock.json
	@mkdir -p $(dir $(NPM_TOLD))
	@npm ci --no-audit --no-fund --fetch-retries=1 --fetch-retry-mintimeout=1000 --fetch-timeout=30000 > $(NPM_TOLD) 2>&1
	@touch $@

# Headers of what Python and the C kernels must agree on; a test compares them.
kernels: $(DEV)
	$(BIN)/python -m tests.kernels.headers

# The page of the formulas, from their docstrings; a test compares it.
mechanics: $(DEV)
	$(BIN)/python -m tests.docs.mechanics_page

# The JSON schema of front.json; a test compares it.
schema: $(DEV)
	$(BIN)/python -m tests.results.front_schema

# Types of the service's answers, for the JavaScript of its pages; a test compares them.
answers: $(DEV)
	$(BIN)/python -m tests.service.answers

# The picture on the first screen of the README, as the program draws it; a test compares it.
picture: $(RUNTIME)
	$(BIN)/clutchsynth run examples/hoist_multi_plate.yaml --plot -o out/ --quiet
	cp out/front.svg docs/pictures/front.svg

# Lists of families in README, docs and examples, from the registry and the families' pages; a test compares them.
lists: $(DEV)
	$(BIN)/python -m tests.docs.lists

# Screens and results on the pages, by running their commands; tests compare structure and marked figures.
screens: $(DEV)
	$(BIN)/python -m tests.docs.redraw

# The gallery of drawings: the first design of an example of each family; a test compares one of them.
gallery: $(DEV)
	for pair in $$($(BIN)/python -m tests.docs.lists gallery); do \
		$(BIN)/clutchsynth run examples/$${pair%=*}.yaml -o out/ --quiet && \
		$(BIN)/clutchsynth report out/ -o out/drawn/ --drawing --quiet && \
		cp out/drawn/design_01_drawing.svg docs/pictures/drawing_$${pair#*=}.svg || exit 1; \
	done

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "clutchsynth needs Python 3.11 or newer; name one with: make PYTHON=python3.12" >&2; exit 1; }
	$(PYTHON) -m venv $(VENV)

# The stamps keep make from installing again what has not changed. The package itself is installed so that edits to
# its files take effect at once; only new entry points or files named in pyproject.toml need it again.
$(RUNTIME): requirements.lock pyproject.toml | $(BIN)/python
	$(BIN)/python -m pip install --quiet --require-hashes -r requirements.lock
	$(BIN)/python -m pip install --quiet --no-deps --no-build-isolation --editable .
	@touch $@

$(DEV): requirements-dev.lock pyproject.toml | $(BIN)/python
	$(BIN)/python -m pip install --quiet --require-hashes -r requirements-dev.lock
	$(BIN)/python -m pip install --quiet --no-deps --no-build-isolation --editable .
	@touch $@ $(RUNTIME)

lock: $(DEV)
	$(BIN)/python -m pip install --quiet uv
	$(COMPILE) --output-file requirements.lock
	$(COMPILE) --extra service --extra postgres --extra excel --extra pdf --extra dxf --output-file requirements-service.lock
	$(COMPILE) --extra dev --output-file requirements-dev.lock

clean:
	rm -rf $(VENV) node_modules out build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
