# Recon. `make` alone lists the targets.
SHELL := /bin/sh
.DEFAULT_GOAL := help
MAKEFLAGS += --no-print-directory
# Tests start the command some two hundred times: without compiled modules each start takes twice as long.
unexport PYTHONDONTWRITEBYTECODE
# As `recon` does for itself.
export OPENBLAS_NUM_THREADS := 1

# A distribution's own Python is built with profile-guided optimisation; one compiled by hand often is not, and
# takes a quarter longer. Where that is too old, uv looks for another.
SYSTEM_PYTHON := $(shell /usr/bin/python3 -c 'import sys; sys.version_info >= (3, 11) and print(sys.executable)' 2>/dev/null)
ifneq ($(SYSTEM_PYTHON),)
export UV_PYTHON ?= $(SYSTEM_PYTHON)
endif

UV_VERSION := 0.13.9
UV := $(shell command -v uv 2>/dev/null || echo .tools/bin/uv)
RUN := $(UV) run --locked --quiet
FUZZ_SECONDS ?= 60
# CI leaves it out where nothing that it tests has changed lately.
RUST ?= test-rust
WEB_SOURCES := $(shell find web/src web/public -type f ! -name schema.d.ts 2>/dev/null) web/index.html web/package.json web/vite.config.ts

.PHONY: help setup demo run wheel test-install test-install-short image test test-all test-rust test-python flights test-web test-e2e test-dissector android-core android test-android study-android fuzz-android coverage coverage-safety check check-rust check-python check-web format bench fuzz fuzz-readers study soak mutants docs web clean

help: ## List the targets
	@awk -F ':.*## ' '/^[a-z0-9-]+:.*## / { printf "  make %-14s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

demo: setup web ## Run a survey under broken cloud: station, simulated drones, console at http://127.0.0.1:8080
	$(RUN) recon demo

# Browser tests wait most of their time: what runs beside them fills it, and lets them go first.
test: setup web ## Set everything up and pass all tests but the long flights
	@$(MAKE) -j3 test-e2e test-python $(RUST) test-web $(ALSO)

test-all: setup web ## All tests with the long flights, as before a release
	@$(MAKE) test CHOSEN=

# In parts, so that `make -j2 check` of CI fills two cores: each part is mostly one process.
check: check-rust check-python check-web ## Formats, lint, types, import rules, stub and generated files

check-rust:
	@tools/require.sh cargo
	cargo fmt --all --check
	cargo clippy --workspace --all-targets --quiet -- -D warnings

check-python: setup
	$(RUN) ruff format --check .
	$(RUN) ruff check .
	$(RUN) mypy
	$(RUN) lint-imports
	$(RUN) python -m mypy.stubtest recon.wire._native --mypy-config-file pyproject.toml
	$(RUN) recon openapi | cmp - web/openapi.json || { echo "web/openapi.json is old: make docs"; exit 1; }

check-web: web/node_modules/.stamp
	npm --prefix web run check

setup: .venv/.stamp ## Install uv, build the Python package with its Rust part

.venv/.stamp: pyproject.toml uv.lock Cargo.toml Cargo.lock $(shell find crates -name '*.rs' -o -name Cargo.toml) | $(filter .tools/%,$(UV))
	@tools/require.sh python3 cargo
	$(UV) sync --locked --quiet
	@touch $@

.tools/bin/uv:
	@tools/require.sh python3
	python3 -m venv .tools
	.tools/bin/pip install --quiet uv==$(UV_VERSION)

web: web/dist/index.html ## Build the console

web/dist/index.html: web/node_modules/.stamp $(WEB_SOURCES)
	npm --prefix web run build --silent
	@touch $@

web/node_modules/.stamp: web/package.json web/package-lock.json
	@tools/require.sh node npm
	npm --prefix web ci --silent --no-audit --no-fund
	@touch $@

wheel: setup web ## Build the wheel for other computers (Linux, x86-64): with the console, nothing to compile
	$(RUN) --group wheel python -m tools.wheel

# The scripts call uv by its name.
WITH_UV := PATH="$(abspath $(dir $(UV))):$$PATH"

test-install: wheel .tools/bin/uv ## Install the wheel in a fresh Debian, fly there, remove it (10 minutes, as root; SUITE=bookworm, sid)
	$(WITH_UV) tools/test_install.sh $(SUITE)

test-install-short: setup web ## The same in an environment outside the checkout, to the first page
	@$(WITH_UV) tools/test_install_short.sh

CONTAINER := $(shell command -v podman || command -v docker || echo podman)
# Only this format of podman's has health checks.
FORMAT := $(if $(findstring podman,$(CONTAINER)),--format docker)

image: wheel .tools/bin/uv ## Build a container image of the station, `recon`, by podman or docker
	$(WITH_UV) $(RUN) python -m tools.packages_at_hand 3.13 build/packages-3.13
	$(CONTAINER) build $(FORMAT) --tag recon --file Containerfile .

test-rust: setup ## Tests of the wire crate
	cargo test -p recon-wire --quiet

CORES := $(shell nproc 2>/dev/null || getconf _NPROCESSORS_ONLN)
# One more than cores: some of them always wait for stations and commands that they have started.
PROCESSES := $(shell expr $(CORES) + 1)
# A file stays in one process, which makes what its tests share once. Files that fly come first, as tests/conftest.py
# sorts them, so that no process ends long after the others.
PYTEST := nice -n 5 $(RUN) python -m pytest -n $(PROCESSES) --dist loadfile --no-loadscope-reorder
CHOSEN := -m "not flight"

# Tests of the gate and the watchdogs run once, with their branches counted where that is asked for.
test-python: setup ## Tests in Python, one of each family that flies
	$(PYTEST) --ignore=tests/android $(if $(filter coverage-safety,$(ALSO)),--ignore=tests/safety) $(CHOSEN)

flights: setup ## The other flights: tests over 2 s of processor time
	$(PYTEST) --ignore=tests/android -m flight

# Counting lines doubles processor time, which says nothing then.
COVERED := $(PYTEST) -p no:processor_time -m "not flight" --cov-branch

coverage-safety: setup ## Tests of the gate and the watchdogs: every branch must be taken
	$(COVERED) tests/safety --cov=recon.safety --cov-report=term-missing:skip-covered --cov-fail-under=100

coverage: coverage-safety ## The same, then coverage of every room by the tests in Python
	$(COVERED) --ignore=tests/android --cov=recon --cov-report=term

MAVEN := mvn --batch-mode --quiet --file android/pom.xml
COMPANION_JAR := $(CURDIR)/android/companion/target/recon-companion.jar
ANDROID_TESTS := RECON_COMPANION_JAR=$(COMPANION_JAR) $(PYTEST) -p no:processor_time tests/android

test-web: web/node_modules/.stamp ## Tests of the console
	npm --prefix web test --silent

test-e2e: setup web ## Console tests in a headless browser with a running station
	@tools/chromium.sh
	RECON_E2E_DIST=dist npm --prefix web run e2e --silent

android-core: ## Build the companion app's core, its runnable jar and the adapter, with their tests (needs a JDK 17 and Maven)
	@tools/require.sh java mvn
	$(MAVEN) verify

android: ## The same, and the app with its APK where the tools for it are
	@tools/require.sh java mvn
	$(MAVEN) $$(tools/android.sh) verify

test-android: setup android ## The companion app's tests, its jar against the real station, and its APK
	$(ANDROID_TESTS)

study-android: setup android fuzz-android ## Long runs of the same: a survey of eight, every bad link, ten minutes without a loss
	RECON_THOROUGH=1 $(ANDROID_TESTS) -s

fuzz-android: ## A million hostile inputs for the companion app's codec, as many for its session; 5,000 schedules of its adapter
	@tools/require.sh java mvn
	$(MAVEN) test -pl core,msdk5 -Dtest='*FuzzTest,SchedulesTest' -Dsurefire.failIfNoSpecifiedTests=false -Dfuzz.inputs=1000000 -Dfuzz.schedules=5000

bench: setup web ## Measurements, each beside a baseline of the same run
	cargo bench -p recon-wire-bench
	$(RUN) python -m pytest benches -p no:cacheprovider
	$(RUN) python -m benches.safety.bench_watchdogs
	$(RUN) python -m benches.fleet.bench_trust
	$(RUN) python -m benches.station.bench_load
	$(RUN) python -m benches.station.bench_stick_jitter
	$(RUN) python -m benches.station.bench_all_stop
	$(RUN) python -m benches.station.bench_guard
	$(RUN) python -m benches.record.bench_record
	$(RUN) python -m benches.record.bench_replay_seek
	$(RUN) python -m benches.product.bench_tag
	$(RUN) python -m benches.fields.bench_import
	$(RUN) python -m benches.gateway.bench_mavlink
	$(RUN) python -m benches.gateway.bench_foxglove
	$(RUN) python -m benches.cli.bench_startup
	$(RUN) python -m benches.cli.bench_first_page
	$(RUN) python -m benches.console.bench_console

test-dissector: setup web/node_modules/.stamp ## The descriptions of the protocol for Wireshark and Kaitai, each by its own program
	@tools/tshark.sh
	$(RUN) python -m pytest tests/protocol

# FUZZ_RUNS=1000000 asks for a number of inputs instead of a time.
fuzz: ## Fuzz the deframer and the packet decoder for a minute each, FUZZ_SECONDS or FUZZ_RUNS (needs a nightly Rust)
	@cargo fuzz --version >/dev/null 2>&1 || cargo install cargo-fuzz --locked --quiet
	for target in deframer packet; do \
		mkdir -p fuzz/work/$$target && \
		cargo +nightly fuzz run $$target fuzz/work/$$target fuzz/corpus/$$target \
			-- $(if $(FUZZ_RUNS),-runs=$(FUZZ_RUNS),-max_total_time=$(FUZZ_SECONDS)) -max_len=4096 -print_final_stats=1 || exit 1; \
	done

READER_RUNS ?= 100000
fuzz-readers: setup ## Fuzz what reads files and bytes of others, READER_RUNS inputs each (READERS="photo record", else all; Linux)
	$(RUN) --group fuzz python -m studies.fuzz_readers $(READERS) --runs $(READER_RUNS)

study: setup ## Long runs: the sky against measurements, random fences, fleets and closed loops, 100,000 simulated seconds, mutants (an hour)
	$(RUN) python -m studies.sky_statistics
	$(RUN) --group study python -m studies.real_shade
	$(RUN) --group study python -m studies.real_sky
	$(RUN) python -m studies.registration
	$(RUN) python -m studies.tagging
	$(RUN) python -m studies.mosaic
	$(RUN) python -m studies.fences --scenes 10000
	$(RUN) python -m studies.fleets --scenes 10000
	$(RUN) python -m studies.app_texts
	$(RUN) python -m studies.session --seconds 100000
	$(RUN) python -m studies.closed_loop --runs 100 --first-seed 1000 --jobs 2
	$(RUN) python -m studies.same_again --seconds 600
	$(RUN) python -m studies.guidance --seeds 3 --only wide
	RECON_THOROUGH=1 $(PYTEST) -p no:processor_time -m "hypothesis or drawn"
	@$(MAKE) mutants

soak: setup ## An hour of 32 vehicles in real time, each process killed, 24 simulated hours (on a quiet machine, half a day)
	$(RUN) python -m studies.soak --minutes 60 --vehicles 32
	$(RUN) python -m studies.soak --kill --vehicles 8
	$(RUN) python -m studies.soak --virtual-hours 24 --vehicles 8

mutants: setup ## Mutate gate, watchdogs, trust layer and guard: a test must fail for each mutant (hours)
	$(RUN) --group study python -m studies.mutants

docs: setup ## Regenerate the API's and the protocol's descriptions, and the table of flights
	$(RUN) recon openapi > web/openapi.json
	$(RUN) python -m tools.flight_table_page > docs/flight-table.md
	$(RUN) python -m tools.protocol_descriptions

format: setup web/node_modules/.stamp ## Format all sources
	cargo fmt --all
	$(RUN) ruff format .
	$(RUN) ruff check --fix .

clean: ## Remove build output
	rm -rf .venv build target android/target android/*/target web/dist web/node_modules .tools
