"""Licences of all that the wheel holds, and of the packages that it imports when it runs.

Inside are the crates that the extension is linked with and the npm packages of the console. Python
packages are separate: pip installs each with its own licence.

    python -m tools.licences      # the table of docs/licences.md
"""

import json
import re
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from email.message import Message
from importlib.metadata import Distribution, distribution
from pathlib import Path
from typing import Any

from packaging.requirements import Requirement

ROOT = Path(__file__).parents[1]
LINKED_FROM = "recon-wire-py"
OWN = frozenset({"recon-wire", LINKED_FROM})
PERMISSIVE = frozenset(
    {
        *("0BSD", "Apache-2.0", "BSD-2-Clause", "BSD-3-Clause", "CC0-1.0", "ISC", "MIT"),
        *("MIT-0", "MIT-CMU", "PSF-2.0", "Unicode-3.0", "Unlicense", "Zlib"),
    }
)
"""Licences that ask for no more than their notice."""
NAMES = {
    "3-Clause BSD License": "BSD-3-Clause",
    "Apache Software License": "Apache-2.0",
    "BSD": "BSD-3-Clause",
    "BSD License": "BSD-3-Clause",
    "ISC License": "ISC",
    "ISC License (ISCL)": "ISC",
    "MIT License": "MIT",
    "Mozilla Public License 2.0 (MPL 2.0)": "MPL-2.0",
}
"""Of classifiers and of older metadata, by the identifiers of SPDX."""
COPYLEFT_LIBRARIES = {
    "libgeos": "GEOS: LGPL-2.1-or-later",
    "libavcodec": "FFmpeg: LGPL-2.1-or-later",
    "libquadmath": "libquadmath: LGPL-2.1-or-later",
    "libgfortran": "libgfortran: GPL-3.0 with GCC's runtime library exception",
}
"""Shared libraries inside the packages' own wheels, by the beginning of their files' names."""
NOTICE_NAMES = re.compile(r"(licen[cs]e|copying|notice|unlicense)", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Part:
    """A crate or package, with its licence as SPDX states it and the folder of its sources."""

    name: str
    version: str
    licence: str
    purl: str
    folder: Path

    @property
    def notices(self) -> str:
        """The texts that its folder has of its licence."""
        files = sorted(f for f in self.folder.iterdir() if NOTICE_NAMES.match(f.name))
        texts = [f.read_text("utf-8", "replace").strip() for f in files if f.is_file()]
        return "\n\n".join(texts) or "(its sources have no text of the licence)"


def crates() -> list[Part]:
    """Return the crates that the extension for Linux is linked with, but our own."""
    words = ("--format-version", "1", "--locked", "--filter-platform", "x86_64-unknown-linux-gnu")
    told = subprocess.run(["cargo", "metadata", *words], cwd=ROOT, capture_output=True, check=True)
    metadata = json.loads(told.stdout)
    packages = {each["id"]: each for each in metadata["packages"]}
    needs = {each["id"]: each["deps"] for each in metadata["resolve"]["nodes"]}
    waiting = [each for each, package in packages.items() if package["name"] == LINKED_FROM]
    linked: set[str] = set()
    while waiting:
        each = waiting.pop()
        if each in linked or packages[each]["targets"][0]["kind"] == ["proc-macro"]:
            continue
        linked.add(each)
        is_normal = (
            d["pkg"] for d in needs[each] if any(k["kind"] is None for k in d["dep_kinds"])
        )
        waiting.extend(is_normal)
    return sorted(
        (_crate(packages[i]) for i in linked if packages[i]["name"] not in OWN), key=_name
    )


def _crate(package: Any) -> Part:
    name, version = package["name"], package["version"]
    licence, folder = package["license"].replace("/", " OR "), Path(package["manifest_path"]).parent
    return Part(name, version, licence, f"pkg:cargo/{name}@{version}", folder)


def npm_packages() -> list[Part]:
    """Return the packages that the console is built from, as its lock file states them."""
    lock = json.loads((ROOT / "web/package-lock.json").read_text(encoding="utf-8"))
    found = []
    for path, about in lock["packages"].items():
        if path and not about.get("dev"):
            name, version = path.rpartition("node_modules/")[2], about["version"]
            purl = f"pkg:npm/{name.replace('@', '%40')}@{version}"
            found.append(Part(name, version, about["license"], purl, ROOT / "web" / path))
    return sorted(found, key=_name)


def python_packages() -> Iterator[tuple[Distribution, str]]:
    """Yield each package that the plain install brings, with its licence."""
    waiting, seen = ["recon-gcs"], set()
    while waiting:
        name = waiting.pop()
        if name in seen:
            continue
        seen.add(name)
        package = distribution(name)
        if name != "recon-gcs":
            yield package, _licence_of(package.metadata)
        for each in map(Requirement, package.requires or ()):
            if each.marker is None or each.marker.evaluate({"extra": ""}):
                waiting.append(re.sub(r"[-_.]+", "-", each.name).lower())


def _licence_of(metadata: Message) -> str:
    # By `get`: once any package has imported importlib_metadata, what is missing raises otherwise.
    stated = metadata.get("License-Expression")
    names = [c.rpartition(" :: ")[2] for c in metadata.get_all("Classifier", [])]
    names += (metadata.get("License") or "").splitlines()[:1]
    known = sorted({NAMES[name] for name in names if name in NAMES})
    return stated or " AND ".join(known) or "; ".join(names) or "unknown"


def copyleft_libraries(package: Distribution) -> list[str]:
    """Return the copyleft libraries that a package's own wheel holds."""
    files = [file.name for file in package.files or () if ".so" in file.name]
    found = COPYLEFT_LIBRARIES.items()
    return [name for begin, name in found if any(file.startswith(begin) for file in files)]


def is_permissive(licence: str) -> bool:
    """Whether a choice of each part of an SPDX expression asks for its notice only."""
    parts = re.sub(r"[()]", "", licence).split(" AND ")
    return all(
        any(way.partition(" WITH ")[0] in PERMISSIVE for way in part.split(" OR "))
        for part in parts
    )


def notices() -> str:
    """Return the text that goes with the wheel: each part, its licence, its notices."""
    parts = "\n\n".join(
        f"{'=' * 80}\n{p.name} {p.version}: {p.licence}\n{'=' * 80}\n\n{p.notices}"
        for p in (*crates(), *npm_packages())
    )
    head = (
        "Recon is under the Apache License 2.0. Its wheel holds the parts below: crates, which\n"
        "the extension is linked with, and npm packages, which the console is built from. The\n"
        "Rust standard library (MIT OR Apache-2.0) is linked too. EGM96's heights of sea level\n"
        "are in the public domain."
    )
    return f"{head}\n\n{parts}\n"


def console_sbom() -> str:
    """Return what the console is built from, as CycloneDX; that of the crates is maturin's."""
    components = [
        {
            "type": "library",
            "bom-ref": part.purl,
            "name": part.name,
            "version": part.version,
            "licenses": [{"expression": part.licence}],
            "purl": part.purl,
        }
        for part in npm_packages()
    ]
    head = {"bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1}
    about = {"component": {"type": "application", "name": "recon-console"}}
    return json.dumps({**head, "metadata": about, "components": components}, indent=1) + "\n"


def named_table() -> str:
    """Return the table of the Python packages that are not permissive, or hold what is not."""
    rows = ["| package | licence | holds |", "|---|---|---|"]
    for package, licence in sorted(python_packages(), key=lambda each: each[0].name.lower()):
        held = copyleft_libraries(package)
        if held or not is_permissive(licence):
            rows.append(f"| {package.name} | {licence} | {'; '.join(held)} |")
    return "\n".join(rows)


def _name(part: Part) -> str:
    return part.name


if __name__ == "__main__":
    print(named_table())
