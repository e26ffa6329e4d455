"""Renders the recipe for every platform, as conda-forge would before a build."""

from pathlib import Path

from rattler_build import PlatformConfig, RenderConfig, Stage0Recipe, VariantConfig

PLATFORMS = ["linux-64", "linux-aarch64", "osx-64", "osx-arm64", "win-64"]
# Of the pinning of conda-forge.
VARIANTS = {"c_compiler": ["gcc"], "rust_compiler": ["rust"], "c_stdlib": ["sysroot"], "python": ["3.12.* *_cpython"]}

recipe = Stage0Recipe.from_yaml(Path(__file__).with_name("recipe.yaml").read_text())
for platform in PLATFORMS:
    config = RenderConfig(PlatformConfig(target_platform=platform, build_platform=platform, host_platform=platform))
    rendered = recipe.render(VariantConfig(VARIANTS), config)
    assert len(rendered) == 1, f"{platform}: {len(rendered)} builds instead of one for all versions of Python"
