# All commands for developers and CI. `make help` lists them.

CARGO ?= cargo
OUT ?= out
# For `make reproduce`: a folder of meshes with the classes of the paper. Default: the built-in dataset.
DATASET ?=

.PHONY: help setup build run test lint bench bench-peers bench-nmds bench-search bench-eigsh fmt doc reproduce report plotly deny package ci clean

help: ## List these commands
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | awk -F ':.*## ' '{printf "  make %-12s %s\n", $$1, $$2}'

setup: ## Download the dependencies
	$(CARGO) fetch --locked

build: ## Build the programs
	$(CARGO) build --release --locked

run: ## Generate the built-in shapes, run figures 1 and 4, and write out/report.html
	$(CARGO) run --release --locked -p experiments -- run figure1 figure4 --output $(OUT)

test: ## Run all tests
	$(CARGO) test --workspace --locked

lint: ## Check formatting, clippy and rustdoc; warnings are errors
	$(CARGO) fmt --all --check
	$(CARGO) clippy --workspace --all-targets --locked -- -D warnings
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --workspace --no-deps --locked

bench: ## Time the distance solvers on meshes of several sizes
	$(CARGO) bench --locked -p bench

bench-peers: build ## Compare distance solvers with other programs and write docs/benchmarks.md (needs Python and test meshes)
	test -x target/peers/bin/python || python3 -m venv target/peers
	target/peers/bin/pip install --quiet numpy scipy potpourri3d pygeodesic meshlib
	target/peers/bin/python bench/peers.py

bench-nmds: build ## Compare canonical forms with potpourri3d and NumPy and write docs/nmds.md (needs Python and test meshes)
	$(CARGO) build --release --locked -p canonform --example forms
	test -x target/peers/bin/python || python3 -m venv target/peers
	target/peers/bin/pip install --quiet numpy potpourri3d
	target/peers/bin/python bench/nmds.py

bench-eigsh: ## Compare eigenpairs with SciPy and write docs/eigenpairs.md (needs Python and test meshes)
	$(CARGO) build --release --locked -p canonform-descriptors --example eigenpairs
	test -x target/peers/bin/python || python3 -m venv target/peers
	target/peers/bin/pip install --quiet numpy scipy
	target/peers/bin/python bench/eigsh.py

bench-search: ## Compare search among a million vectors with hnswlib and faiss and write docs/search.md (needs Python; takes half an hour)
	$(CARGO) build --release --locked -p canonform-index --example vectors
	test -x target/peers/bin/python || python3 -m venv target/peers
	target/peers/bin/pip install --quiet numpy hnswlib faiss-cpu
	target/peers/bin/python bench/search.py

fmt: ## Format the sources
	$(CARGO) fmt --all

doc: ## Build the documentation
	$(CARGO) doc --workspace --no-deps --locked

reproduce: ## Run all experiments, on DATASET=folder with the classes of the paper if given
	$(CARGO) run --release --locked -p experiments -- run all --output $(OUT) \
	  $(if $(DATASET),--dataset $(DATASET) --classes cat$(comma)centaur$(comma)david)

comma := ,

report: ## Write OUT/report.html from the results in OUT without running experiments
	$(CARGO) run --release --locked -p experiments -- report --output $(OUT)

plotly: ## Build the bundle of plotly.js that the pages embed (needs Node 20 and npm)
	node crates/view/assets/plotly/build.mjs

deny: ## Check licences and sources of dependencies with cargo-deny (installs it if missing)
	@command -v cargo-deny >/dev/null || $(CARGO) install --locked cargo-deny
	cargo-deny --all-features check licenses bans sources

package: ## Check that all packages can be published
	$(CARGO) package --workspace --no-verify --allow-dirty --offline --no-metadata --quiet

# Runs the program that the tests built: building it alone would compile half of its dependencies again.
ci: lint test package ## What CI runs: lint, tests, packaging, a small experiment from end to end
	$${CARGO_TARGET_DIR:-target}/debug/experiments run figure1 figure4 --vertices 1000 --quiet --output target/ci-out
	test -s target/ci-out/report.html
	@echo "ci: all good"

clean: ## Remove build products and results
	$(CARGO) clean
	rm -rf $(OUT)
