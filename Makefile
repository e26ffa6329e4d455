# Every command that a person or CI runs. `make help` lists them.

CARGO ?= cargo
OUT ?= out
# A folder of meshes with the paper's classes, for `make reproduce`; the built-in dataset without it.
DATASET ?=

.PHONY: help setup build run test lint bench bench-peers bench-nmds bench-search bench-eigsh fmt doc reproduce report plotly deny ci clean

help: ## List these commands
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | awk -F ':.*## ' '{printf "  make %-12s %s\n", $$1, $$2}'

setup: ## Fetch what the build needs from the package registry
	$(CARGO) fetch --locked

build: ## Build the programs
	$(CARGO) build --release --locked

run: ## Generate the built-in shapes, run figures 1 and 4, write out/report.html
	$(CARGO) run --release --locked -p experiments -- run figure1 figure4 --output $(OUT)

test: ## Run all tests
	$(CARGO) test --workspace --locked

lint: ## Format, clippy and rustdoc, warnings denied
	$(CARGO) fmt --all --check
	$(CARGO) clippy --workspace --all-targets --locked -- -D warnings
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc --workspace --no-deps --locked

bench: ## Time the solvers over sizes
	$(CARGO) bench --locked -p canonform-geodesics

bench-peers: build ## Measure other programs beside this one and write docs/benchmarks.md (needs Python and test meshes)
	test -x target/peers/bin/python || python3 -m venv target/peers
	target/peers/bin/pip install --quiet numpy scipy potpourri3d pygeodesic meshlib
	target/peers/bin/python bench/peers.py

bench-nmds: build ## Measure whole canonical forms beside potpourri3d and NumPy and write docs/nmds.md (needs Python and test meshes)
	$(CARGO) build --release --locked -p canonform --example forms
	test -x target/peers/bin/python || python3 -m venv target/peers
	target/peers/bin/pip install --quiet numpy potpourri3d
	target/peers/bin/python bench/nmds.py

bench-eigsh: ## Measure eigenpairs beside SciPy and write docs/eigenpairs.md (needs Python and test meshes)
	$(CARGO) build --release --locked -p canonform-descriptors --example eigenpairs
	test -x target/peers/bin/python || python3 -m venv target/peers
	target/peers/bin/pip install --quiet numpy scipy
	target/peers/bin/python bench/eigsh.py

bench-search: ## Search a million signatures beside hnswlib and faiss and write docs/search.md (needs Python, half an hour)
	$(CARGO) build --release --locked -p canonform-index --example vectors
	test -x target/peers/bin/python || python3 -m venv target/peers
	target/peers/bin/pip install --quiet numpy hnswlib faiss-cpu
	target/peers/bin/python bench/search.py

fmt: ## Format the sources
	$(CARGO) fmt --all

doc: ## Build the documentation
	$(CARGO) doc --workspace --no-deps --locked

reproduce: ## Run every experiment, on DATASET=folder with the paper's classes if given
	$(CARGO) run --release --locked -p experiments -- run all --output $(OUT) \
	  $(if $(DATASET),--dataset $(DATASET) --classes cat$(comma)centaur$(comma)david)

comma := ,

report: ## Make the interactive page OUT/report.html again from the results in OUT, without running anything
	$(CARGO) run --release --locked -p experiments -- report --output $(OUT)

plotly: ## Build the bundle of plotly.js that the pages embed (needs Node 20 and npm)
	node crates/view/assets/plotly/build.mjs

deny: ## Check licences, sources and duplicate versions with cargo-deny (installs it if missing)
	@command -v cargo-deny >/dev/null || $(CARGO) install --locked cargo-deny
	cargo-deny --all-features check licenses bans sources

# The program is the one that the tests were run with: built for itself alone, half of what it depends on differs.
ci: lint test ## What CI runs: lint, tests, a small experiment from end to end
	$${CARGO_TARGET_DIR:-target}/debug/experiments run figure1 figure4 --vertices 1000 --quiet --output target/ci-out
	test -s target/ci-out/report.html
	@echo "ci: all good"

clean: ## Remove what was built and written
	$(CARGO) clean
	rm -rf $(OUT)
