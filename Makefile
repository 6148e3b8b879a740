# Everything a fresh Debian or Ubuntu machine needs is done by these targets.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PEERS := .venv-peers
# Tests side by side; one of the workers has all that need the one simulated camera. 0: one by one.
WORKERS ?= 2
# Options and rows of the benchmarks, e.g. make bench BENCH="--quick sums fit"
BENCH ?=
# Writing a compiled loop once per machine, not once per process.
export NUMBA_CACHE_DIR ?= $(CURDIR)/.numba-cache

# How much of the proof, e.g. make proof PROOF="--size full --out proof-full"
PROOF ?= --size part

.PHONY: setup demo test check bench soak proof serve lock format clean

setup: $(VENV)/ready

$(VENV)/ready: requirements.lock tests/sample-data.lock pyproject.toml docker/install-system.sh
	docker/install-system.sh service tests
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --upgrade pip
	$(BIN)/pip install --quiet --require-hashes -r requirements.lock
	$(BIN)/pip install --quiet --require-hashes --no-deps -r tests/sample-data.lock
	$(BIN)/pip install --quiet --no-deps --editable .
	touch $@

demo: setup
	$(BIN)/darkflat demo --out demo

# No core is left for the threads that OpenBLAS would start in each worker: they would only spin.
test: setup
	OPENBLAS_NUM_THREADS=1 $(BIN)/pytest -n $(WORKERS)

check: setup
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: setup $(PEERS)/ready
	$(BIN)/python -m benchmarks --peers $(PEERS)/bin/python $(BENCH)

# What is compared with has an environment of its own: one peer needs an older NumPy.
$(PEERS)/ready: benchmarks/peers.lock
	$(PYTHON) -m venv $(PEERS)
	$(PEERS)/bin/pip install --quiet --require-hashes -r benchmarks/peers.lock
	touch $@

soak: setup
	$(BIN)/pytest -m soak --timeout 7200

# Recordings whose secret the diagnosis does not know: how well it finds it. Resumed where it ended.
proof: setup
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m tests.concealed $(PROOF)

serve: setup
	$(BIN)/darkflat serve

format: setup
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

# What pip is told of its sources on this machine stays out of the lock files.
COMPILE := .lock-venv/bin/pip-compile --quiet --generate-hashes --strip-extras --no-header --output-file -
lock:
	$(PYTHON) -m venv .lock-venv
	.lock-venv/bin/pip install --quiet pip-tools
	{ echo '# Written by `make lock`: every package by version and hash, no host by name.'; \
	  $(COMPILE) --extra aravis --extra bluesky --extra dev pyproject.toml | grep -v '^--'; } > requirements.lock.new
	mv requirements.lock.new requirements.lock
	{ echo '# Written by `make lock`, from peers.in: every package by version and hash, no host by name.'; \
	  $(COMPILE) benchmarks/peers.in | grep -v '^--'; } > benchmarks/peers.lock.new
	mv benchmarks/peers.lock.new benchmarks/peers.lock
	.lock-venv/bin/pip install --quiet --dry-run --ignore-installed --no-deps \
	  --report .lock-venv/sample-data.json -r tests/sample-data.in
	{ echo '# Written by `make lock`, from sample-data.in: every package by version and hash, no host by name.'; \
	  .lock-venv/bin/python -c 'import json, sys; \
	    [print("{}=={} --hash=sha256:{}".format(i["metadata"]["name"], i["metadata"]["version"], \
	      i["download_info"]["archive_info"]["hashes"]["sha256"])) for i in json.load(sys.stdin)["install"]]' \
	    < .lock-venv/sample-data.json; } > tests/sample-data.lock.new
	mv tests/sample-data.lock.new tests/sample-data.lock
	rm -rf .lock-venv

clean:
	rm -rf $(VENV) $(PEERS) .numba-cache demo proof
