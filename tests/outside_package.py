"""A package with entry points, installed into a folder as an installer would lay it out."""

import tomllib
from collections.abc import Mapping
from pathlib import Path


def install(folder: Path, name: str, points: Mapping[str, Mapping[str, str]]) -> None:
    """Write a distribution's metadata; `points` are its entry points by group."""
    about = folder / f"{name.replace('-', '_')}-0.1.0.dist-info"
    about.mkdir(parents=True)
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 0.1.0\n")
    lines = [
        line
        for group, by_name in points.items()
        for line in (f"[{group}]", *(f"{name} = {target}" for name, target in by_name.items()))
    ]
    (about / "entry_points.txt").write_text("\n".join(lines) + "\n")


def install_example(source: Path, folder: Path) -> None:
    """Install a package of single modules by its pyproject.toml, without a network."""
    project = tomllib.loads((source / "pyproject.toml").read_text(encoding="utf-8"))
    about = project["project"]
    install(folder, about["name"], about["entry-points"])
    for module in project["tool"]["setuptools"]["py-modules"]:
        (folder / f"{module}.py").write_bytes((source / f"{module}.py").read_bytes())
