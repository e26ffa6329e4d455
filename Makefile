# All commands for developers and CI. `make help` lists them.

CARGO ?= cargo
OUT ?= out
# For `make reproduce`: a folder of meshes with the classes of the paper. Default: the built-in dataset.
DATASET ?=

.PHONY: help setup build run test test-all test-python wheels reference notebooks lint-packaging lint bench benchmarks fmt doc guide reproduce report paper measure plotly deny mutants sbom fuzz fuzz-seeds package ci clean

help: ## List these commands
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | awk -F ':.*## ' '{printf "  make %-17s %s\n", $$1, $$2}'

setup: ## Download the dependencies
	$(CARGO) fetch --locked

build: ## Build the programs
	$(CARGO) build --release --locked

run: ## Generate the built-in shapes, run figures 1 and 4, and write out/report.html
	$(CARGO) run --release --locked --bin experiments -- run figure1 figure4 --output $(OUT)

test: ## Run the tests, but for those that are slow and rare
	$(CARGO) test --workspace --locked --no-fail-fast

test-python: ## Build the Python package and run its tests, but for slow ones, in an environment of its own (needs Python 3.11 or later)
	crates/py/test.sh

wheels: ## Build the wheel and the source distribution of the Python package in out/wheels, and try both in a bare Python
	crates/py/wheels.sh $(OUT)/wheels

reference: ## Write the pages of the Python API to target/reference
	crates/py/test.sh --reference

notebooks: ## Run the notebooks of the Python package and store them with their outputs
	CANONFORM_WRITE_DOCS=1 crates/py/test.sh -m slow tests/test_notebooks.py

lint-packaging: ## Check workflows, container, citation, recipe and metadata with linters of PyPI and npm
	packaging/lint.sh

test-all: ## Run all tests with those that are slow and rare, and build the guide and the reference: attacks, exhaustive damage, full-size maps, notebooks, 200 kills of writing commands
	CANONFORM_KILLS=200 $(CARGO) test --workspace --tests --locked --no-fail-fast -- --include-ignored
	crates/py/test.sh -m ""
	$(MAKE) reference guide

lint: ## Check formatting, clippy and rustdoc; warnings are errors
	$(CARGO) fmt --all --check
	$(CARGO) clippy --workspace --all-targets --locked -- -D warnings
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --workspace --no-deps --locked

bench: ## Time the distance solvers on meshes of several sizes
	$(CARGO) bench --locked -p bench

# Sections of docs/benchmarks.md; `make bench-peers` measures the first alone.
SECTIONS = peers nmds preparation maps packages search duplicates capacity

benchmarks: $(SECTIONS:%=bench-%) ## Measure all of docs/benchmarks.md (needs Python and test meshes; takes two hours)

bench-%:
	$(CARGO) build --release --locked -p canonform-cli -p canonform -p canonform-index -p canonform-datasets --bins --examples
	test -x target/peers/bin/python || python3 -m venv target/peers
	target/peers/bin/pip install --quiet --no-binary gdist gdist numpy scipy scikit-learn potpourri3d pygeodesic meshlib pyfmaps faiss-cpu hnswlib
	target/peers/bin/python bench/$*.py

fmt: ## Format the sources
	$(CARGO) fmt --all

doc: ## Build the documentation
	$(CARGO) doc --workspace --no-deps --locked

# Of the program that builds the guide; installed into target/mdbook, so that the version is this one.
MDBOOK = 0.5.4

guide: ## Build the user guide, target/guide/index.html, with mdBook (installs it if missing)
	@target/mdbook/bin/mdbook --version 2>/dev/null | grep -qx 'mdbook v$(MDBOOK)' || \
	  $(CARGO) install --quiet --locked --debug --root target/mdbook --no-default-features --features search mdbook@$(MDBOOK)
	target/mdbook/bin/mdbook build docs

reproduce: ## Run all experiments, on DATASET=folder with the classes of the paper if given
	$(CARGO) run --release --locked -p experiments -- run all --output $(OUT) \
	  $(if $(DATASET),--dataset $(DATASET) --classes cat$(comma)centaur$(comma)david)

comma := ,

report: ## Write OUT/report.html from the results in OUT without running experiments
	$(CARGO) run --release --locked -p experiments -- report --output $(OUT)

paper: ## Write docs/paper.md from the results in OUT of `make reproduce DATASET=folder`
	$(CARGO) run --release --locked -p experiments -- report --output $(OUT) --markdown docs/paper.md

measure: ## Measure again all that docs/paper.md and docs/benchmarks.md state, on DATASET=folder (needs Python and test meshes; takes hours)
	$(MAKE) reproduce
	$(MAKE) paper benchmarks

plotly: ## Build the bundle of plotly.js that the pages embed (needs Node 20 and npm)
	node crates/report/assets/plotly/build.mjs

deny: ## Check licences and sources of dependencies with cargo-deny (installs it if missing)
	@command -v cargo-deny >/dev/null || $(CARGO) install --locked cargo-deny
	cargo-deny --all-features check licenses bans sources

# Of `make mutants`: crates, and which part of their mutants to try.
CRATES ?= retrieval nmds descriptors
SHARD ?= 0/8

mutants: ## Change expressions of CRATES one at a time and list in OUT/mutants.out what no test notices, an eighth of each crate by default (installs cargo-mutants if missing)
	@command -v cargo-mutants >/dev/null || $(CARGO) install --locked cargo-mutants
	@mkdir -p $(OUT)
	$(CARGO) mutants $(CRATES:%=--package canonform-%) --sharding round-robin --shard $(SHARD) --output $(OUT) -- --locked --tests

sbom: ## Write OUT/sbom, CycloneDX lists of the dependencies of both programs (installs cargo-cyclonedx if missing)
	@command -v cargo-cyclonedx >/dev/null || $(CARGO) install --locked cargo-cyclonedx
	@mkdir -p $(OUT)/sbom
	cargo-cyclonedx cyclonedx --quiet --format json --override-filename canonform-sbom
	mv crates/cli/canonform-sbom.json $(OUT)/sbom/canonform.json
	mv experiments/canonform-sbom.json $(OUT)/sbom/experiments.json
	@find bench crates datasets experiments tests -name canonform-sbom.json -delete

# What `cargo fuzz` passes to the compiler: counters of edges, a table of functions, and traced comparisons.
FUZZ_FLAGS = -Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
  -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
  -Cllvm-args=-sanitizer-coverage-trace-compares --cfg fuzzing
FUZZ_TARGETS ?= read repair_embed describe index_open
FUZZ_HOST = $(shell rustc -vV | sed -n 's/^host: //p')
# Seconds for each target of `make fuzz`.
SECONDS ?= 60

# The flags apply to the target platform only, so procedural macros and build scripts stay as they are.
fuzz: ## Fuzz the readers, the pipeline and the index for SECONDS=60 each; FUZZ_TARGETS chooses (needs a C++ compiler)
	cd fuzz && RUSTFLAGS="$(FUZZ_FLAGS)" $(CARGO) build --release --bins --target $(FUZZ_HOST) --target-dir target
	@set -e; mkdir -p fuzz/artifacts; for target in $(FUZZ_TARGETS); do \
	  mkdir -p fuzz/found/$$target; echo "== $$target, $(SECONDS) s"; \
	  fuzz/target/$(FUZZ_HOST)/release/$$target -max_total_time=$(SECONDS) -timeout=20 -rss_limit_mb=2048 \
	    -max_len=65536 -dict=fuzz/text.dict -artifact_prefix=fuzz/artifacts/$$target- -print_final_stats=1 \
	    fuzz/found/$$target fuzz/corpus/$$target; \
	done; echo "fuzz: no findings"

fuzz-seeds: ## Write the seed corpus in fuzz/corpus
	$(CARGO) run --locked -p canonform-datasets --example fuzz_seeds

package: ## Check that all packages can be published
	$(CARGO) package --workspace --no-verify --allow-dirty --offline --no-metadata --quiet

# Runs the program that the tests built: building it alone would compile half of its dependencies again.
ci: lint test package ## What CI runs: lint, tests, packaging, a small experiment from end to end
	$${CARGO_TARGET_DIR:-target}/debug/experiments run figure1 figure4 --families creatures:2x3 --vertices 1000 --quiet --output target/ci-out
	test -s target/ci-out/report.html
	@echo "ci: all good"

clean: ## Remove build products and results
	$(CARGO) clean
	rm -rf $(OUT)
