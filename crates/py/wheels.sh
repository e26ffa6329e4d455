#!/usr/bin/env bash
# Builds the wheel and the source distribution of the Python package into a folder, checks which systems the wheel runs on,
# installs each of them in a bare Python, and writes the recipe for conda-forge. On Linux, zig links for glibc 2.17, which
# every system since 2014 has. MATURIN_FLAGS replaces `--release --strip`.
set -euo pipefail
out=$(realpath -m "${1:?wheels: name the folder to write to}")
cd "$(dirname "$0")"
root=$(realpath ../..)
python=$(./test.sh --find)
target=$(realpath -m "${CARGO_TARGET_DIR:-../../target}")
environment=$target/wheels
test -x "$environment/bin/python" || "$python" -m venv "$environment"
export PATH=$environment/bin:$PATH CARGO_TARGET_DIR=$target PIP_DISABLE_PIP_VERSION_CHECK=1
pip install --quiet 'maturin>=1.16,<2' twine
read -ra flags <<< "${MATURIN_FLAGS:---release --strip}"
if [ "$(uname)" = Linux ]; then
    pip install --quiet auditwheel cargo-zigbuild ziglang
    flags+=(--zig --compatibility manylinux_2_17)
fi
rm -f "$out"/canonform-*
maturin build --locked --out "$out" --interpreter "$python" "${flags[@]}"
maturin sdist --out "$out"
twine check --strict "$out"/canonform-*
if [ "$(uname)" = Linux ]; then
    auditwheel show "$out"/canonform-*.whl
fi

# Installs a file in a Python that has nothing else, far from the sources, and tries it.
try() {
    local bare start
    bare=$(mktemp -d)
    "$python" -m venv "$bare/python"
    start=$SECONDS
    (cd "$bare" && python/bin/pip install --quiet "$1" && python/bin/python "$root/packaging/try.py")
    echo "$(basename "$1"): $(du -h "$1" | cut -f1), installed and tried in $((SECONDS - start)) s"
    rm -rf "$bare"
}
try "$out"/canonform-*.whl
try "$out"/canonform-*.tar.gz

sum=$(sha256sum "$out"/canonform-*.tar.gz | cut -d' ' -f1)
sed "s/\(sha256: \).*/\1\"$sum\"/" "$root/packaging/conda-forge/recipe.yaml" > "$out/recipe.yaml"
