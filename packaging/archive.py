"""Packs the program that was built for a target into out/archives, named as `[package.metadata.binstall]` of crates/cli
says, and runs what was packed.

    python packaging/archive.py x86_64-unknown-linux-gnu
"""

import pathlib
import shutil
import subprocess
import sys
import tempfile
import tomllib

root = pathlib.Path(__file__).resolve().parents[1]
[target] = sys.argv[1:]
version = tomllib.loads((root / "Cargo.toml").read_text())["workspace"]["package"]["version"]
binstall = tomllib.loads((root / "crates/cli/Cargo.toml").read_text())["package"]["metadata"]["binstall"]
suffix = ".exe" if "windows" in target else ""
form = binstall["overrides"].get(target, binstall)["pkg-fmt"]


def filled(template: str) -> str:
    """A template of binstall with its names replaced."""
    names = {"version": version, "target": target, "archive-suffix": f".{form}", "bin": "canonform", "binary-ext": suffix}
    for name, value in names.items():
        template = template.replace(f"{{ {name} }}", value)
    return template


name = filled(binstall["pkg-url"]).rsplit("/", 1)[1].removesuffix(f".{form}")
program = pathlib.PurePosixPath(filled(binstall["bin-dir"]))
out = root / "out" / "archives"
out.mkdir(parents=True, exist_ok=True)
with tempfile.TemporaryDirectory() as folder:
    packed = pathlib.Path(folder) / program
    packed.parent.mkdir(parents=True)
    shutil.copy2(root / "target" / target / "release" / f"canonform{suffix}", packed)
    for page in ("README.md", "CHANGELOG.md", "LICENSE-MIT", "LICENSE-APACHE"):
        shutil.copy2(root / page, packed.parent)
    made = shutil.make_archive(str(out / name), {"tgz": "gztar", "zip": "zip"}[form], folder, packed.parts[-2])
archive = pathlib.Path(made).replace(out / f"{name}.{form}")
with tempfile.TemporaryDirectory() as folder:
    shutil.unpack_archive(archive, folder, {"tgz": "gztar", "zip": "zip"}[form])
    subprocess.run([pathlib.Path(folder) / program, "--version"], check=True)
print(f"{archive.relative_to(root)}: {archive.stat().st_size / 1e6:.1f} MB")
