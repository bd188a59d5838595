"""150 drawn files of many kinds against shapely's truth: areas and names, nothing lost."""

from collections.abc import Callable, Sequence
from pathlib import Path
from random import Random

import numpy as np
import pytest
import shapely
from tests.fields import written
from tests.fields.written import Field

from recon.fields.archive import unpacked
from recon.fields.field_file import read_import
from recon.fields.process import read_documents

Write = Callable[[Sequence[Field], Random], bytes]
WRITERS: dict[str, tuple[Write, str, bool]] = {
    "kml": (written.kml, ".xml", True),
    "geojson": (written.geojson, ".json", True),
    "isoxml": (written.isoxml, ".xml", True),
    "gpx": (written.gpx, ".xml", False),
    "qgc_plan": (written.qgc_plan, ".json", False),
}
"""By format: what writes it, how the process knows it, and whether it has holes."""
NAMES = ("North 40", " Hof \n Süd ", "Untitled Polygon", "A & B <2>", "x" * 90, "=1+1")
SYSTEMS = ("EPSG:4326", "EPSG:3857", "EPSG:32633", "EPSG:25833")
AREA_WITHIN = 1e-4


def fields(random: Random, *, holes: bool) -> list[Field]:
    count = random.randint(1, 6)
    return [
        (random.choice(NAMES), written.drawn(random, random.randint(0, 3) if holes else 0))
        for _ in range(count)
    ]


def assert_same(answer: Sequence[tuple[str, object]], truth: Sequence[Field]) -> None:
    names = [name for name, _ in answer]
    assert len(set(names)) == len(names) == len(truth)
    assert all(len(name) <= 64 and name == " ".join(name.split()) for name in names)
    for (_, geometry), (_, shape) in zip(answer, truth, strict=True):
        assert isinstance(geometry, dict)
        outline, *holes = geometry["coordinates"]
        read = shapely.Polygon(outline, holes)
        assert len(holes) == len(shape.interiors)
        assert abs(read.area / shape.area - 1.0) < AREA_WITHIN
        assert np.hypot(read.centroid.x - shape.centroid.x, read.centroid.y - shape.centroid.y) < (
            1e-7
        )


@pytest.mark.parametrize("kind", WRITERS)
def test_drawn_files_of_each_format_are_read_whole(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    write, suffix, has_holes = WRITERS[kind]
    for seed in range(26):
        random = Random(f"{kind} {seed}")
        truth = fields(random, holes=has_holes)
        (tmp_path / f"0{suffix}").write_bytes(write(truth, random))
        answer = read_documents({f"0{suffix}": ""}, close_paths=False)
        assert answer["excluded"] == []
        assert_same([(each["name"], each["geometry"]) for each in answer["features"]], truth)


@pytest.mark.parametrize("seed", range(2))
def test_shapefiles_of_several_systems_in_one_zip(seed: int) -> None:
    random = Random(seed)
    truth = [
        (f"field {number}", written.drawn(random, number % 3)) for number in range(len(SYSTEMS) * 3)
    ]
    # In the zone of the systems' maps.
    truth = [
        (name, shapely.affinity.translate(s, 15.0 - s.centroid.x, 48.0 - s.centroid.y))
        for name, s in truth
    ]
    found = read_import("farm.zip", written.shapefiles(truth, SYSTEMS * 3))
    assert found.excluded == ()
    order = {name: number for number, (name, _) in enumerate(truth)}
    answer = sorted(((f.name, f.geometry) for f in found.features), key=lambda f: order[f[0]])
    assert_same(answer, truth)


def test_archives_of_each_kind_give_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    random = Random(7)
    truth = fields(random, holes=True)
    kml, iso = written.kml(truth, random), written.isoxml(truth, random)
    archives = [
        {"doc.kml": kml, "files/picture.png": b"x"},
        {"__MACOSX/._doc.kml": b"\0" * 80, "Farm.KML": kml, ".DS_Store": b""},
        {"TASKDATA/TASKDATA.XML": iso, "TASKDATA/GRD00001.BIN": b"x"},
        {"a\\taskdata.xml": b"<ISO11783_TaskData/>", "a\\PFD00001.XML": _linked(iso)},
        {"wpmz/template.kml": kml, "wpmz/waylines.wpml": b"<kml/>"},
    ]
    for number, files in enumerate(archives):
        folder = tmp_path / str(number)
        folder.mkdir()
        monkeypatch.chdir(folder)
        answer = read_documents(unpacked(written.zipped(files), folder), close_paths=False)
        assert_same([(each["name"], each["geometry"]) for each in answer["features"]], truth)


def _linked(isoxml: bytes) -> bytes:
    text = isoxml.decode().replace('<ISO11783_TaskData VersionMajor="4">', "<XFC>")
    return text.replace("</ISO11783_TaskData>", "</XFC>").encode()
