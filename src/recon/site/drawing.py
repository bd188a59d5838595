"""A site's layers as drawn features: read for an editor, and staged as the files to save.

A drawing is staged in a temporary copy of the folder and loaded from there by `load_site`: what a
start would refuse is refused before anything is saved, with the same words.
"""

import json
import os
import re
import shutil
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from recon.model.airspace import SiteLayer
from recon.model.errors import SiteError
from recon.site.geojson import read_features
from recon.site.load import LARGEST_FILE_BYTES, SITE_FILE, load_site
from recon.site.reading import (
    HISTORY_FOLDER,
    MAPS_FOLDER,
    file_inside,
    read_bounded,
    read_toml,
)
from recon.site.site import Site

FENCES = frozenset(SiteLayer) - {SiteLayer.SURVEY_REGIONS}
"""The layers that the safety gate judges by."""

MOST_STAGED_FILES = 200
_FEATURE_PLACE = re.compile(
    r"(?P<file>[^:]+): feature (?P<number>\d{1,4})(?: \(.*?\))?(?:\.\w+)?: (?P<rest>.+)", re.DOTALL
)
"""How an error of a layer's file begins: `Feature.place`."""
_NOT_STAGED = frozenset({HISTORY_FOLDER, MAPS_FOLDER, "references"})


@dataclass(frozen=True, slots=True, eq=False)
class DrawnFeature:
    """A feature of a layer: GeoJSON geometry of one polygon or point, and attributes."""

    layer: SiteLayer
    geometry: Mapping[str, Any]
    properties: Mapping[str, Any]


@dataclass(frozen=True, slots=True, eq=False)
class StagedSite:
    """A drawing that a start would accept: the site it gives, and the files to write for it."""

    site: Site
    files: Mapping[str, bytes | None]
    changed: tuple[SiteLayer, ...]
    """The layers that differ from those in the folder."""


class DrawnFeatureError(SiteError):
    """What is wrong with the feature at `index` in the order in which they were given."""

    def __init__(self, index: int, problem: str) -> None:
        """Take the sentence without the file that it is about."""
        super().__init__(problem)
        self.index = index


def read_drawing(folder: Path) -> tuple[DrawnFeature, ...]:
    """Return the features of all layers of a folder. Raises `SiteError`."""
    site_file = folder / SITE_FILE
    features: list[DrawnFeature] = []
    for layer, name in _layer_files(folder).items():
        path = file_inside(site_file, name, f"layers.{layer}")
        for feature in read_features(path):
            features += _single(layer, feature.geometry, feature.properties)
    return tuple(features)


def drawing_digest(folder: Path) -> str:
    """Return SHA-256 over site.toml and the layers' files: the revision of a drawing."""
    total = sha256(read_bounded(folder / SITE_FILE, LARGEST_FILE_BYTES, "a site file"))
    for layer, name in _layer_files(folder).items():
        path = folder / name
        total.update(f"\0{layer}\0{name}\0".encode())
        total.update(path.read_bytes() if path.is_file() else b"")
    return total.hexdigest()


def stage_drawing(folder: Path, features: Sequence[DrawnFeature]) -> StagedSite:
    """Return a drawing as a site and its files.

    Raises `SiteError` as a start does, `DrawnFeatureError` where it is about one feature.
    """
    now, wanted = _texts(read_drawing(folder)), _texts(features)
    named = _layer_files(folder)
    files: dict[str, bytes | None] = {}
    for layer in SiteLayer:
        if wanted.get(layer) == now.get(layer):
            continue
        if layer in wanted:
            files[named.setdefault(layer, f"{layer}.geojson")] = wanted[layer]
        else:
            named.pop(layer, None)
    text = (folder / SITE_FILE).read_text(encoding="utf-8")
    renamed = _with_layers(folder, text, named)
    if renamed != text:
        files[SITE_FILE] = renamed.encode()
    try:
        return stage_files(folder, files)
    except SiteError as problem:
        raise _of_feature(problem, features, named) from problem


def _of_feature(
    problem: SiteError, features: Sequence[DrawnFeature], named: Mapping[SiteLayer, str]
) -> SiteError:
    """Return the error with the feature that its text names by file and number, if it does."""
    found = _FEATURE_PLACE.match(str(problem))
    if found is None:
        return problem
    layer = next((layer for layer, name in named.items() if name == found["file"]), None)
    own = [index for index, each in enumerate(features) if each.layer == layer]
    number = int(found["number"])
    if not 0 < number <= len(own):
        return problem
    sentence = found["rest"]
    return DrawnFeatureError(own[number - 1], sentence[:1].upper() + sentence[1:])


def stage_files(folder: Path, files: Mapping[str, bytes | None]) -> StagedSite:
    """Return the site that a folder would be with these files. Raises `SiteError`."""
    now = _texts(read_drawing(folder))
    with TemporaryDirectory(prefix=".recon-staged-", dir=folder) as name:
        staged = Path(name)
        for path in _staged_paths(folder):
            inner = path.relative_to(folder)
            if str(inner) not in files:
                _link(path, staged / inner)
        for inner_name, content in files.items():
            if content is not None:
                (staged / inner_name).parent.mkdir(parents=True, exist_ok=True)
                (staged / inner_name).write_bytes(content)
        try:
            site, then = load_site(staged), _texts(read_drawing(staged))
        except SiteError as problem:
            raise SiteError(str(problem).replace(f"{staged}{os.sep}", "")) from problem
    changed = tuple(layer for layer in SiteLayer if then.get(layer) != now.get(layer))
    return StagedSite(site, files, changed)


def _texts(features: Sequence[DrawnFeature]) -> dict[SiteLayer, bytes]:
    """Return the file of each layer that has a feature."""
    by_layer = {layer: [each for each in features if each.layer == layer] for layer in SiteLayer}
    return {layer: _collection(layer, some) for layer, some in by_layer.items() if some}


def _single(
    layer: SiteLayer, geometry: Mapping[str, Any], properties: Mapping[str, Any]
) -> Iterator[DrawnFeature]:
    """Yield a feature, or one for each polygon of several, as the layers' names count them."""
    coordinates = geometry.get("coordinates")
    if geometry.get("type") != "MultiPolygon" or not isinstance(coordinates, list):
        single = {"type": geometry.get("type"), "coordinates": coordinates}
        yield DrawnFeature(layer, single, properties)
        return
    for part, rings in enumerate(coordinates, start=1):
        own = dict(properties)
        if len(coordinates) > 1 and "name" in own and layer is SiteLayer.SURVEY_REGIONS:
            own["name"] = f"{own['name']}, part {part}"
        yield DrawnFeature(layer, {"type": "Polygon", "coordinates": rings}, own)


def _collection(layer: SiteLayer, features: Sequence[DrawnFeature]) -> bytes:
    """Return a layer's file; the same features give the same bytes."""
    lines = ",\n".join(
        json.dumps(
            {
                "type": "Feature",
                "properties": {k: v for k, v in each.properties.items() if v is not None},
                "geometry": dict(each.geometry),
            }
        )
        for each in features
    )
    body = f"[\n{lines}\n]" if lines else "[]"
    return (
        f'{{\n"type": "FeatureCollection",\n"name": "{layer}",\n"features": {body}\n}}\n'.encode()
    )


def _layer_files(folder: Path) -> dict[SiteLayer, str]:
    """Return the file of each layer that site.toml names."""
    table = read_toml(folder / SITE_FILE, LARGEST_FILE_BYTES, "a site file").get("layers", {})
    if not isinstance(table, dict):
        return {}
    return {layer: name for layer in SiteLayer if isinstance(name := table.get(layer), str)}


_SECTION = re.compile(r"^\s*\[layers\]\s*(#.*)?$")
_ANY_SECTION = re.compile(r"^\s*\[")


def _with_layers(folder: Path, text: str, named: Mapping[SiteLayer, str]) -> str:
    """Return the text of site.toml with these layers; everything else stays, comments too."""
    known = tomllib.loads(text).get("layers", {})
    if known == named:
        return text
    kept: list[str] = []
    missing = [f"{key} = {json.dumps(name)}" for key, name in named.items() if key not in known]
    is_inside, has_section = False, False
    for line in text.splitlines():
        if _ANY_SECTION.match(line):
            is_inside = bool(_SECTION.match(line))
        key = line.split("=", 1)[0].strip()
        if is_inside and "=" in line and key in frozenset(SiteLayer) and key not in named:
            continue
        kept.append(line)
        if _SECTION.match(line):
            has_section = True
            kept += missing
    if not has_section:
        kept += ["", "[layers]", *missing]
    changed = "\n".join(kept) + "\n"
    try:
        if tomllib.loads(changed).get("layers", {}) == named:
            return changed
    except tomllib.TOMLDecodeError:
        pass  # Layers written in another way than as a section.
    lines = ", ".join(f"{key} = {json.dumps(name)}" for key, name in named.items())
    raise SiteError(
        f"{folder / SITE_FILE}: expected a [layers] section with one key a line, got another form; "
        f"write it by hand: {lines}"
    )


def _staged_paths(folder: Path) -> Iterator[Path]:
    count = 0
    for path in sorted(folder.rglob("*")):
        parts = path.relative_to(folder).parts
        if parts[0] in _NOT_STAGED or parts[0].startswith(".") or not path.is_file():
            continue
        count += 1
        if count > MOST_STAGED_FILES:
            raise SiteError(
                f"{folder}: expected at most {MOST_STAGED_FILES} files, got more; a site's folder "
                "holds the site's files only"
            )
        yield path


def _link(path: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    try:
        os.link(path, target)
    except OSError:
        shutil.copyfile(path, target)
