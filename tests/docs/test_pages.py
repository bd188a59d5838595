"""The pages say what is true: links lead somewhere, commands and targets exist, examples run."""

import asyncio
import json
import re
import runpy
import sys
import tomllib
from itertools import takewhile
from pathlib import Path

import pytest
import typer
import typer.core
from tests.patient_loop import run_patiently

from recon.cli.commands import COMMANDS, app
from recon.site import load_site
from recon.site.app_list import read_app_list

ROOT = Path(__file__).parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("findings/*.md")])
OF_THE_CODE = {"ARCHITECTURE": 60, "SAFETY": 20}
"""Pages that name folders of the code, and how many paths they name at least."""
ANCHOR = re.compile(r"\]\((?!https?://)([^)#\s]*)#([^)\s]+)\)")
LINK = re.compile(r"(?:\]\(|src(?:set)?=\")(?!https?://|#|mailto:)([^)#\s\"]+)")
FENCE = re.compile(r"```(\w*)\n(.*?)```", re.DOTALL)
SITE_HEAD = """name = "x"
[origin]
latitude_deg = 45.0
longitude_deg = -93.0
ground_altitude_m = 280.0
"""
PATH = re.compile(r"`((?:[a-z_0-9]+/)+(?:[a-z_0-9]+\.(?:py|ts|tsx|rs))?)`")
MAKE_TARGET = re.compile(r"`make ([a-z0-9-]+)`|^make ([a-z0-9-]+)", re.MULTILINE)


def page_id(page: Path) -> str:
    return str(page.relative_to(ROOT))


@pytest.mark.parametrize("page", PAGES, ids=page_id)
def test_links_lead_to_files(page: Path) -> None:
    for target in LINK.findall(page.read_text(encoding="utf-8")):
        assert (page.parent / target).exists(), f"{page_id(page)} links to {target}"


def anchors(page: Path) -> set[str]:
    """Anchors of a page's headings, as GitHub makes them."""
    text = FENCE.sub("", page.read_text(encoding="utf-8"))
    titles = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


@pytest.mark.parametrize("page", PAGES, ids=page_id)
def test_links_into_pages_lead_to_headings(page: Path) -> None:
    for target, anchor in ANCHOR.findall(page.read_text(encoding="utf-8")):
        assert anchor in anchors(page.parent / target if target else page), f"{target}#{anchor}"


@pytest.mark.parametrize("page", PAGES, ids=page_id)
def test_named_paths_exist(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    created = set(re.findall(r"^Create `(.+)`:$", text, re.MULTILINE))
    named = [path for path in PATH.findall(text) if path not in created]
    assert len(named) > OF_THE_CODE.get(page.stem, -1)
    if page.stem not in OF_THE_CODE and page.parent.name not in ("safety", "lives"):
        # Elsewhere folders may be those of a site.
        named = [path for path in named if not path.endswith("/")]
    folders = [ROOT, ROOT / "web", *(ROOT / "src/recon" / room for room in ("", "station", "sim"))]
    assert [path for path in named if not any((f / path).exists() for f in folders)] == []


@pytest.mark.parametrize("page", PAGES, ids=page_id)
def test_make_targets_exist(page: Path) -> None:
    targets = set(re.findall(r"^([a-z0-9-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    named = {a or b for a, b in MAKE_TARGET.findall(page.read_text(encoding="utf-8"))}
    assert named <= targets


@pytest.mark.parametrize("page", PAGES, ids=page_id)
def test_commands_and_options_exist(page: Path) -> None:
    group = typer.main.get_group(app)
    for _language, block in FENCE.findall(page.read_text(encoding="utf-8")):
        for line in re.findall(r"^(?:uv run (?:--locked )?)?recon (.+)$", block, re.MULTILINE):
            name, *words = line.split("#")[0].split()
            assert name in COMMANDS, f"{page_id(page)}: recon {name}"
            command = group.get_command(typer.Context(group), name)
            assert command is not None
            is_alone = getattr(command, "invoke_without_command", False)
            is_alone = is_alone and (not words or words[0].startswith("--"))
            if isinstance(command, typer.core.TyperGroup) and not is_alone:
                assert words[0] in command.commands, f"{page_id(page)}: recon {line}"
                command = command.commands[words[0]]
            known = {o for p in command.params for o in (*p.opts, *p.secondary_opts)}
            options = takewhile(lambda word: word != "--", words)
            named = {word.split("=")[0] for word in options if word.startswith("--")}
            assert named <= known, f"{page_id(page)}: recon {line}"


def test_the_guides_entries_are_valid(tmp_path: Path) -> None:
    text = (ROOT / "docs/how-to/connect-an-app.md").read_text(encoding="utf-8")
    blocks = [block for language, block in FENCE.findall(text) if language == "toml"]
    listing = [block for block in blocks if "[[apps]]" in block]
    assert len(blocks) > len(listing) == 1
    (tmp_path / "apps.toml").write_text(listing[0], encoding="utf-8")
    assert len(read_app_list(tmp_path / "apps.toml")) == 2
    for block in blocks:
        if block in listing:
            continue
        (tmp_path / "site.toml").write_text(SITE_HEAD + block, encoding="utf-8")
        serials = [entry["serial"] for entry in tomllib.loads(block)["vehicles"]]
        assert list(load_site(tmp_path).profiles) == serials


@pytest.mark.parametrize("example", sorted((ROOT / "examples").glob("*.py")), ids=page_id)
def test_examples_run(
    example: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "argv", [str(example)])
    monkeypatch.setattr(asyncio, "run", run_patiently)
    runpy.run_path(str(example), run_name="__main__")
    printed = capsys.readouterr().out
    expected = {
        "01": "EmergencyCommand",
        "02": "confirmed",
        "03": "of the grid covered",
        "04": "landing: confirmed",
        "05": "arrived",
        "06": "SIM-6: wave 2, 40 m, landed",
        "07": "intersection over union: 0.8",
        "08": "Brier score 0.0",
        "09": "SIM-2: 1 flights",
        "10": "half_persistence ",
        "11": "Imager: 44 positions",
    }
    assert expected[example.name[:2]] in printed


def test_the_requests_of_the_apis_page_exist() -> None:
    paths = json.loads((ROOT / "web/openapi.json").read_text(encoding="utf-8"))["paths"]
    text = (ROOT / "docs/api.md").read_text(encoding="utf-8")
    named = re.findall(r"`(GET|POST) (/api/[^`]*)`", text)
    assert len(named) > 30
    assert [
        f"{method} {path}"
        for method, path in named
        if path not in paths or method.lower() not in paths[path]
    ] == []
