"""Files of surveyed regions: what was kept is read back, and nothing else is."""

import base64
import json
import zlib
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon.model.airspace import Region
from recon.model.flown_before import KeptLattice
from recon.model.flown_region import FlownRegion
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.survey import Survey, SurveyBudget, SurveyCamera
from recon.record.files.flown_region_file import (
    FORMAT,
    MOST_FILES,
    decode_region,
    encode_region,
    read_regions,
    write_region,
)

FLOWN_S = 1_777_600_000
HOLE_M = np.array([(10.0, 10.0), (20.0, 10.0), (20.0, 20.5)])
HOLE = Region(HOLE_M)


def flown(name: str = "north", seed: int = 0) -> FlownRegion:
    rng = np.random.default_rng(seed)
    rows, cols = (int(each) for each in rng.integers(1, 40, 2))
    outline_m = rng.uniform(-500.0, 500.0, (5, 2))
    survey = Survey(
        id=0,
        name=name,
        region=Region(outline_m, (HOLE_M,)),
        height_above_takeoff_m=float(rng.uniform(20.0, 100.0)),
        speed_mps=5.1,
        camera=SurveyCamera(70.1, 50.3, 2.5, 5280),
        row_bearing_deg=None,
        planner="sunlit_first",
        budget=SurveyBudget(3, 600.0, None),
        region_name=name,
    )
    frame = LocalFrame(GeoPoint(44.99, -93.2, float(rng.uniform(0.0, 300.0))))
    shape = rows, cols
    imaged_s = (FLOWN_S + rng.integers(0, 100, shape)) * rng.integers(0, 2, shape)
    return FlownRegion(
        survey=survey,
        lattice=KeptLattice(*rng.uniform(0.0, 100.0, 3).tolist(), 7, float(rng.normal())),
        grid=GroundGrid(frame, -40.0, 80.0, survey.cell_m, rows, cols),
        is_reached=rng.random(shape) < 0.9,
        is_light_known=rng.random(shape) < 0.5,
        imaged_s=imaged_s.astype(np.uint32),
        in_sun_s=(imaged_s * rng.integers(0, 2, shape)).astype(np.uint32),
        begun_s=FLOWN_S,
        started_s=FLOWN_S + 5,
        is_simulated=False,
    )


def changed(**changes: Any) -> bytes:
    """The payload of a file with some values of its own."""
    payload = json.loads(encode_region(flown()).split(b"\n", 1)[1])
    for path, value in changes.items():
        *outer, last = path.split("__")
        place = payload
        for key in outer:
            place = place[key]
        place[last] = value
    return json.dumps(payload).encode()


@given(st.integers(0, 999))
def test_what_was_written_is_read_to_the_bit(seed: int) -> None:
    kept = flown(seed=seed)
    read = decode_region(encode_region(kept).split(b"\n", 1)[1])
    for name in ("is_reached", "is_light_known", "imaged_s", "in_sun_s"):
        assert np.array_equal(getattr(read, name), getattr(kept, name))
        assert getattr(read, name).dtype == getattr(kept, name).dtype
    assert (read.lattice, read.grid, read.key) == (kept.lattice, kept.grid, kept.key)
    assert (read.begun_s, read.started_s) == (kept.begun_s, kept.started_s)
    for one, other in zip(rings(read), rings(kept), strict=True):
        assert np.array_equal(one, other)
    # Arrays do not compare: the rest of the survey by its text.
    assert str(replace(read.survey, region=HOLE)) == str(replace(kept.survey, region=HOLE))


def rings(region: FlownRegion) -> list[Any]:
    area = region.survey.region
    return [area.outline_m, *area.holes_m]


def test_a_folder_has_one_file_a_region_and_way(tmp_path: Path) -> None:
    north, south = flown("north"), flown("south/../west")
    for each in (north, south, replace(north, started_s=FLOWN_S + 9)):
        write_region(tmp_path / "flown", each)
    found, troubles = read_regions(tmp_path / "flown")
    assert troubles == ()
    assert {each.survey.region_name: each.started_s for each in found} == {
        "north": FLOWN_S + 9,
        "south/../west": FLOWN_S + 5,
    }
    assert read_regions(tmp_path / "none") == ((), ())


@pytest.mark.parametrize(
    ("payload", "words"),
    [
        (b"{", "truncated"),
        (changed(rows=4_000_000, cols=4_000_000), "expected up to 4000000 cells"),
        (changed(imaged_s="AAAA"), "an array of cells is damaged"),
        (changed(rows=1, cols=1), "got another length"),
        (changed(lattice__spacing_m=1e-9), "0.1"),
        (changed(survey__cell_m=0.0), "0.5"),
        (changed(survey__planner="<b>"), "expected the name of a planner"),
        (changed(survey__outline_m=[[0, 0]] * 2), "length >= 3"),
        (changed(latitude_deg=1e308), "90"),
        (changed(survey__region_name="other"), "its name is not that of its content"),
    ],
)
def test_what_is_out_of_range_is_a_sentence(tmp_path: Path, payload: bytes, words: str) -> None:
    path = tmp_path / f"{flown().key}.json"
    path.write_bytes(FORMAT.encode(payload))
    found, (trouble,) = read_regions(tmp_path)
    assert found == ()
    assert words in trouble
    assert str(path) in trouble


def test_an_array_that_inflates_without_end_is_not_inflated() -> None:
    bomb = base64.b64encode(zlib.compress(bytes(50_000_000))).decode()
    with pytest.raises(ValueError, match="another length"):
        decode_region(changed(in_sun_s=bomb))


@given(st.integers(0, 2**31), st.integers(1, 255))
def test_a_damaged_byte_of_the_payload_is_noticed(place: int, flips: int) -> None:
    content = bytearray(encode_region(flown()))
    begins = content.index(b"\n") + 1
    content[begins + place % (len(content) - begins)] ^= flips
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"{flown().key}.json"
        path.write_bytes(content)
        found, (trouble,) = read_regions(Path(folder))
    assert found == ()
    assert "checksum" in trouble


def test_only_the_newest_files_are_read(tmp_path: Path) -> None:
    content = encode_region(flown())
    for number in range(MOST_FILES + 3):
        (tmp_path / f"{number:016}.json").write_bytes(content)
    _, troubles = read_regions(tmp_path)
    assert f"the newest {MOST_FILES} are used" in troubles[0]
    assert len(troubles) == 1 + MOST_FILES
