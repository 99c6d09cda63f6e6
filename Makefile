# make demo   set everything up and make a crowd        make view   watch it in the browser
# make test   every test                                make lint   every linter
# make bench  our figures beside the reference          make fmt    format everything
# make fuzz   every parser against broken files (FUZZ_SECS=30 each)
#
# Every step is keyed on a file it makes, so that nothing is built twice: the virtual environment on a stamp inside
# it, the compiled extension on itself, the studio on its built page, the demo on its report.

SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
MAKEFLAGS += --no-builtin-rules
.DEFAULT_GOAL := help

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
DEMO := out/demo
export VIRTUAL_ENV := $(CURDIR)/$(VENV)
export PIP_DISABLE_PIP_VERSION_CHECK := 1

VENV_MADE := $(VENV)/made
EXTENSION := python/crowdquilt/_core.abi3.so
NODE_MODULES := studio/node_modules/.package-lock.json
PAGE := studio/dist/index.html
STUDIO := python/crowdquilt/studio_dist/index.html
CLIENTS := tests/clients/node_modules/.package-lock.json

RUST_SOURCES := $(shell find src python/src -name '*.rs') Cargo.toml Cargo.lock python/Cargo.toml
PYTHON_SOURCES := $(shell find python/crowdquilt -name '*.py')
STUDIO_SOURCES := $(shell find studio/src studio/public -type f 2>/dev/null) \
	$(wildcard studio/index.html studio/*.json studio/*.ts)
LINTED := python/crowdquilt python/tests examples tests/clients

.NOTPARALLEL:
.PHONY: help demo view bench setup studio test test-rust test-python test-studio test-browser fuzz lint fmt clean

help:
	@sed -n 's/^# \(make.*\)/\1/p' Makefile

# --- setting up -------------------------------------------------------------------------------------------------------

$(VENV_MADE):
	@echo "== virtual environment"
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Crowdquilt needs Python 3.11 or newer")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet 'maturin>=1.8,<2'
	touch $@

$(EXTENSION): $(VENV_MADE) $(RUST_SOURCES) python/pyproject.toml
	@echo "== Rust core and Python package"
	PIP_QUIET=1 $(BIN)/maturin develop --quiet --release --extras dev --manifest-path python/Cargo.toml
	touch $@

$(NODE_MODULES): studio/package-lock.json
	@echo "== packages of the studio"
	npm --prefix studio ci --no-audit --no-fund --loglevel=error
	touch $@

$(PAGE): $(NODE_MODULES) $(STUDIO_SOURCES)
	@echo "== studio"
	npm --prefix studio run --silent build
	touch $@

# The package carries the built studio.
$(STUDIO): $(PAGE)
	rm -rf $(@D) && cp -R $(<D) $(@D)
	touch $@

$(CLIENTS): tests/clients/package.json
	@echo "== other people's readers, for the tests of exports"
	npm --prefix tests/clients install --no-audit --no-fund --loglevel=error
	touch $@

setup: $(EXTENSION) $(STUDIO)

studio: $(STUDIO)

# --- using ------------------------------------------------------------------------------------------------------------

$(DEMO)/report.json: $(EXTENSION) $(PYTHON_SOURCES)
	$(BIN)/crowdquilt demo -o $(DEMO)
	@touch $(VENV)/demo-is-new

demo: setup $(DEMO)/report.json
	@if [ -e $(VENV)/demo-is-new ]; then rm $(VENV)/demo-is-new; \
	else echo "Nothing has changed since $(DEMO) was made."; $(BIN)/crowdquilt demo -o $(DEMO) --show; fi

view: setup $(DEMO)/report.json
	$(BIN)/crowdquilt view $(DEMO)/crowd.crowd

bench: setup
	$(BIN)/crowdquilt bench

# --- testing ----------------------------------------------------------------------------------------------------------

test: test-rust test-python test-studio test-browser
	@echo "== all tests passed; what was skipped is named above"

# The profile of the extension: its dependencies are compiled once for both.
test-rust:
	@echo "== Rust tests"
	cargo test --release --quiet -p crowdquilt -p crowdquilt-capi

test-python: setup $(CLIENTS)
	@echo "== Python tests"
	$(BIN)/python -m pytest -q -c python/pyproject.toml python/tests tests/clients

test-studio: $(NODE_MODULES)
	@echo "== studio tests"
	npm --prefix studio run --silent test

test-browser: setup
	@echo "== browser tests"
	npm --prefix studio run --silent e2e

# ufbx is C: compiled like the rest, so that its faults and comparisons are seen too.
FUZZ_SECS ?= 30
FUZZ_TARGETS := $(basename $(notdir $(wildcard fuzz/fuzz_targets/*.rs)))
fuzz:
	@if ! cargo +nightly fuzz --version > /dev/null 2>&1; then \
		echo "skipped: fuzzing needs a nightly compiler and cargo-fuzz (rustup toolchain install nightly; cargo install cargo-fuzz)"; \
		exit 0; \
	fi; \
	cargo run --quiet --release --example fuzz_seeds -- fuzz/corpus; \
	export CFLAGS="-fsanitize=address -fsanitize-coverage=trace-cmp"; \
	cargo +nightly fuzz build; \
	for target in $(FUZZ_TARGETS); do \
		echo "== fuzz $$target for $(FUZZ_SECS) s"; \
		cargo +nightly fuzz run $$target -- -max_total_time=$(FUZZ_SECS) -timeout=10 -rss_limit_mb=2048 \
			-max_len=65536 -seed=1 -verbosity=0 -print_final_stats=1; \
	done

lint: setup $(NODE_MODULES)
	@echo "== Rust"
	cargo fmt --all --check
	cargo clippy --quiet --workspace --all-targets -- -D warnings
	RUSTDOCFLAGS='-D warnings' cargo doc --quiet --no-deps
	@echo "== Python"
	$(BIN)/ruff check --quiet --config python/pyproject.toml $(LINTED)
	$(BIN)/ruff format --quiet --check --config python/pyproject.toml $(LINTED)
	cd python && ../$(BIN)/mypy
	@echo "== TypeScript"
	npm --prefix studio run --silent check

fmt: setup $(NODE_MODULES)
	cargo fmt --all
	$(BIN)/ruff check --quiet --fix --config python/pyproject.toml $(LINTED)
	$(BIN)/ruff format --quiet --config python/pyproject.toml $(LINTED)
	npm --prefix studio run --silent format

clean:
	rm -rf target out $(VENV) $(EXTENSION) $(dir $(STUDIO)) studio/dist studio/node_modules tests/clients/node_modules
