"""What a fetch puts into a site's folder, checked as a start checks it."""

import tomllib
from pathlib import Path
from typing import Any

from recon.model.errors import SiteError
from recon.site import toml_lines
from recon.site.drawing import StagedSite, stage_files
from recon.site.elevation import Datum
from recon.site.load import LARGEST_FILE_BYTES, SITE_FILE
from recon.site.reading import read_bounded

ELEVATION_FILE = "elevation-fetched.tif"
SECTION = "elevation"
KEYS = ("file", "datum", "geoid_height_m")


def stage_elevation(
    folder: Path, geotiff: bytes, datum: Datum, geoid_height_m: float, *, replaces: bool
) -> StagedSite:
    """Return the site with fetched heights as its elevation model. Raises `SiteError`.

    A model of the user's own stays, unless `replaces`.
    """
    path = folder / SITE_FILE
    text = read_bounded(path, LARGEST_FILE_BYTES, "a site file").decode("utf-8")
    own = tomllib.loads(text).get(SECTION, {}).get("file", ELEVATION_FILE)
    if own != ELEVATION_FILE and not replaces:
        raise SiteError(
            f"{path}: expected no elevation.file of your own, got {own!a}; --replace takes the "
            "fetched heights instead"
        )
    values: dict[str, Any] = {"file": ELEVATION_FILE, "datum": datum}
    if datum == "geoid":
        values["geoid_height_m"] = geoid_height_m
    files = {ELEVATION_FILE: geotiff, SITE_FILE: _with_elevation(path, text, values).encode()}
    return stage_files(folder, files)


def _with_elevation(path: Path, text: str, values: dict[str, Any]) -> str:
    """Return the text of site.toml with the table; everything else stays, comments too."""
    lines: list[str] = []
    is_there = False
    for block in toml_lines.blocks(text, SECTION):
        if toml_lines.is_section(block, SECTION):
            block, is_there = toml_lines.with_keys(block, SECTION, KEYS, values), True
        lines += block
    if not is_there:
        keys = [toml_lines.key_line(key, value) for key, value in values.items()]
        lines += ["" if text.endswith("\n") else "\n", "\n", f"[{SECTION}]\n", *keys]
    changed = "".join(lines)
    if not toml_lines.is_read_as(changed, {**tomllib.loads(text), SECTION: values}):
        shown = "".join(toml_lines.key_line(key, value) for key, value in values.items())
        raise SiteError(
            f"{path}: expected an [{SECTION}] section with one key a line, got another form; "
            f"write it by hand: {', '.join(shown.splitlines())}"
        )
    return changed
