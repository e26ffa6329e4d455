#!/usr/bin/env bash
# Builds the wheel and the source distribution of the Python package into a folder, and installs the wheel in a bare Python.
# MATURIN_FLAGS replaces `--release`.
set -euo pipefail
out=$(realpath -m "${1:?wheels: name the folder to write to}")
cd "$(dirname "$0")"
python=$(./test.sh --find)
target=$(realpath -m "${CARGO_TARGET_DIR:-../../target}")
environment=$target/wheels
test -x "$environment/bin/python" || "$python" -m venv "$environment"
"$environment/bin/pip" install --quiet --disable-pip-version-check 'maturin>=1.16,<2'
export CARGO_TARGET_DIR=$target
rm -f "$out"/canonform-*
# The wheel gets the lowest manylinux tag that the libraries allow; maturin refuses one that needs others.
# shellcheck disable=SC2086
"$environment/bin/maturin" build --locked --out "$out" --interpreter "$python" ${MATURIN_FLAGS:---release}
"$environment/bin/maturin" sdist --out "$out"

bare=$(mktemp -d)
trap 'rm -rf "$bare"' EXIT
"$python" -m venv "$bare"
"$bare/bin/pip" install --quiet --disable-pip-version-check "$out"/canonform-*.whl
cd "$bare"
"$bare/bin/python" -c '
import canonform, pickle
cat = canonform.datasets.generate("cat", poses=1, n_vertices=1000)[0].surface()
assert pickle.loads(pickle.dumps(cat)).distances(0).shape == (1000,)
print("canonform", canonform.__version__, "works in a bare Python")'
