"""Downloads the wheels that a plain install of Recon needs, in the versions of the lock file.

python -m tools.packages_at_hand 3.13 build/packages-3.13      # for that Python on Linux, x86-64
"""

import subprocess
import sys
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).parents[1]
EXPORT = ("--locked", "--quiet", "--no-dev", "--no-emit-project", "--no-hashes", "--no-annotate")
PLATFORMS = ("manylinux2014_x86_64", *(f"manylinux_2_{n}_x86_64" for n in range(5, 29)))


def main() -> None:
    """Download what is missing in the folder."""
    python, folder = sys.argv[1:]
    words = ("uv", "export", *EXPORT, "--no-header")
    listed = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    platforms = [word for each in PLATFORMS for word in ("--platform", each)]
    subprocess.run(
        (
            *(ROOT / ".tools/bin/pip", "download", "--quiet", "--no-deps", "--dest", folder),
            *("--only-binary", ":all:", "--python-version", python, *platforms),
            *chosen(listed.splitlines(), python),
        ),
        check=True,
    )


def chosen(lines: list[str], python: str) -> list[str]:
    """Return the requirements whose markers a version of Python fulfils."""
    environment = {"python_version": python, "python_full_version": f"{python}.0"}
    found = [Requirement(line) for line in lines]
    return [
        f"{each.name}{each.specifier}"
        for each in found
        if each.marker is None or each.marker.evaluate(environment)
    ]


if __name__ == "__main__":
    main()
