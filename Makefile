# Everything a fresh Debian or Ubuntu machine needs is done by these targets.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# Writing a compiled loop once per machine, not once per process.
export NUMBA_CACHE_DIR ?= $(CURDIR)/.numba-cache

.PHONY: setup demo test check bench soak serve lock format clean

setup: $(VENV)/ready

$(VENV)/ready: requirements.lock pyproject.toml docker/install-system.sh
	docker/install-system.sh
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --upgrade pip
	$(BIN)/pip install --quiet --require-hashes -r requirements.lock
	$(BIN)/pip install --quiet --no-deps --editable .
	touch $@

demo: setup
	$(BIN)/darkflat demo --out demo

test: setup
	$(BIN)/pytest

check: setup
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: setup
	$(BIN)/python -m benchmarks

soak: setup
	$(BIN)/pytest -m soak --timeout 7200

serve: setup
	$(BIN)/darkflat serve

format: setup
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

lock:
	$(PYTHON) -m venv .lock-venv
	.lock-venv/bin/pip install --quiet pip-tools
	.lock-venv/bin/pip-compile --quiet --generate-hashes --extra aravis --extra dev --no-emit-index-url \
	    --no-emit-find-links --strip-extras --output-file requirements.lock pyproject.toml
	rm -rf .lock-venv

clean:
	rm -rf $(VENV) .numba-cache demo
