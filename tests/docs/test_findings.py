"""findings/ holds scripts in the form of its README, and no product code."""

import os
import re
from pathlib import Path

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "findings"
HEAD = re.compile(r"#!/bin/sh\n# Guess: .+\n# True: .+\n# Why: .+\n# Matters: .+\n")


def test_each_finding_is_a_script_with_its_head() -> None:
    for file in sorted(FOLDER.iterdir()):
        if file.name == "README.md":
            continue
        assert file.suffix == ".sh", f"{file.name} is no script"
        assert HEAD.match(file.read_text(encoding="utf-8")), f"{file.name} has no head"
        assert os.access(file, os.X_OK), f"{file.name} is not executable"


def test_no_finding_uses_the_product() -> None:
    for file in FOLDER.glob("*.sh"):
        text = file.read_text(encoding="utf-8")
        assert not re.search(r"\b(?:import recon|from recon|recon [a-z])", text), file.name
