#!/usr/bin/env bash
# Builds the Python package and runs its tests in an environment of its own below target/, in two processes. `--find` only
# prints the Python that would be used, `--prepare` only makes the environment, and `--reference` writes the pages of the API to
# target/reference instead. Further arguments go to pytest.
set -euo pipefail
cd "$(dirname "$0")"

find_python() {
    local name
    for name in ${PYTHON:-python3 python3.11 python3.12 python3.13 python3.14}; do
        if "$name" -c 'import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
            command -v "$name"
            return
        fi
    done
    echo "test-python: needs Python 3.11 or later with the module venv; install it, or name it with PYTHON=..." >&2
    return 1
}

python=$(find_python)
if [ "${1:-}" = --find ]; then
    echo "$python"
    exit
fi

target=$(realpath -m "${CARGO_TARGET_DIR:-../../target}")
environment=$target/python
test -x "$environment/bin/python" || "$python" -m venv "$environment"
mapfile -t packages < <("$environment/bin/python" -c '
import tomllib
with open("pyproject.toml", "rb") as file:
    project = tomllib.load(file)["project"]
    print(*project["dependencies"], *project["optional-dependencies"]["test"], sep="\n")')
"$environment/bin/pip" install --quiet --disable-pip-version-check 'maturin>=1.16,<2' "${packages[@]}"
if [ "${1:-}" = --prepare ]; then
    exit
fi

export VIRTUAL_ENV=$environment CARGO_TARGET_DIR=$target
if [ -n "${CANONFORM_PROGRAM:-}" ]; then
    # CI has built the program with the Rust tests. The package is built together with them, too: alone it has other features,
    # and all of its dependencies would be compiled again.
    PYO3_PYTHON=$environment/bin/python PYO3_BUILD_EXTENSION_MODULE=1 \
        cargo build --quiet --locked --workspace --lib --tests
    cp "$target/debug/lib_canonform.so" python/canonform/_canonform.abi3.so
    realpath python >"$("$environment/bin/python" -c 'import site; print(site.getsitepackages()[0])')/canonform.pth"
else
    cargo build --locked -p canonform-cli
    "$environment/bin/maturin" develop --quiet --locked --profile dev --features canonform/clap
fi
if [ "${1:-}" = --reference ]; then
    "$environment/bin/pip" install --quiet --disable-pip-version-check 'pdoc>=16,<17'
    exec "$environment/bin/python" -W ignore -c '
import sys, pathlib, canonform, pdoc
canonform.NystromMDS, canonform.distributed
pdoc.render.configure(docformat="google")
pdoc.pdoc("canonform", output_directory=pathlib.Path(sys.argv[1]))' "$target/reference"
fi
exec "$environment/bin/python" -m pytest --numprocesses 2 --dist loadfile "$@"
