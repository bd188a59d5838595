"""Sunlit references come back from their files as they were written; a bad file is one sentence."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from recon.model.errors import RecordError
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.model.shade import SunlitReference
from recon.record.raster.reference_file import (
    FOLDER,
    read_reference,
    read_references,
    write_reference,
)

GRID = GroundGrid(LocalFrame(GeoPoint(41.9, -93.6, 270.0)), -12.0, 16.0, 4.0, 8, 6)
LIGHT = np.array([[0.5, -1.25, np.nan], [0.0, 3.5, -2.0]], dtype=np.float32)
REFERENCE = SunlitReference(
    serial="SIM-IMAGER",
    grid=GRID,
    toward_sun_enu=(0.36, -0.48, 0.8),
    camera_enu_m=(3.0, -2.5, 120.0),
    light=LIGHT,
    colour=LIGHT / 2.0,
    light_contrast=1.1,
    colour_contrast=0.7,
    sun_colour=-0.4,
    is_exposure_locked=True,
)


def same(one: SunlitReference, other: SunlitReference) -> bool:
    def rest(each: SunlitReference) -> tuple[object, ...]:
        return (
            each.serial,
            each.grid,
            each.toward_sun_enu,
            each.camera_enu_m,
            each.light_contrast,
            each.colour_contrast,
            each.sun_colour,
            each.is_exposure_locked,
        )

    return (
        rest(one) == rest(other)
        and np.array_equal(one.light, other.light, equal_nan=True)
        and np.array_equal(one.colour, other.colour, equal_nan=True)
    )


def changed(path: Path, **fields: object) -> Path:
    """The file with other values in its header."""
    header, _, payload = path.read_bytes().partition(b"\n")
    path.write_bytes(json.dumps(json.loads(header) | fields).encode() + b"\n" + payload)
    return path


def test_what_was_written_is_read(tmp_path: Path) -> None:
    path = write_reference(tmp_path, REFERENCE)
    assert path.name == "SIM-IMAGER-sun-140-50.reference"
    assert same(read_reference(path), REFERENCE)
    found, troubles = read_references(tmp_path)
    assert len(found) == 1
    assert same(found[0], REFERENCE)
    assert troubles == ()


def test_a_later_flight_replaces_the_one_with_the_sun_in_the_same_direction(
    tmp_path: Path,
) -> None:
    write_reference(tmp_path, REFERENCE)
    write_reference(tmp_path, replace(REFERENCE, sun_colour=0.1))
    write_reference(tmp_path, replace(REFERENCE, toward_sun_enu=(0.0, -0.6, 0.8)))
    found, _ = read_references(tmp_path)
    assert sorted(each.sun_colour for each in found) == [-0.4, 0.1]


def test_a_folder_without_references_has_none(tmp_path: Path) -> None:
    assert read_references(tmp_path) == ((), ())
    (tmp_path / FOLDER).mkdir()
    (tmp_path / FOLDER / "notes.txt").write_text("mown on Monday")
    assert read_references(tmp_path) == ((), ())


@pytest.mark.parametrize("serial", ["../../etc/passwd", "A/B", "..", "\\x", "\n"])
def test_no_serial_leads_out_of_the_folder(tmp_path: Path, serial: str) -> None:
    path = write_reference(tmp_path, replace(REFERENCE, serial=serial))
    assert path.parent == tmp_path / FOLDER
    assert read_reference(path).serial == serial


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"version": 2}, "expected format version 1, got 2"),
        ({"format": "recon-snapshot"}, "expected a file of format recon-sunlit-reference"),
        ({"bytes": 47}, "expected 47 bytes after its header, got more"),
        ({"bytes": 49}, "expected 49 bytes after its header, got 48"),
        ({"sha256": "0" * 64}, "checksum does not match"),
        ({"rows": 3}, "expected two maps of 3 x 3 cells"),
        ({"rows": 0}, "header is damaged"),
        ({"cols": 10**9}, "header is damaged"),
        ({"origin_deg_m": [95.0, 0.0, 0.0]}, "origin on the globe"),
        ({"serial": 7}, "header is damaged"),
        ({"light_contrast": 1e9}, "header is damaged"),
    ],
)
def test_a_header_that_is_wrong(tmp_path: Path, fields: dict[str, object], said: str) -> None:
    path = changed(write_reference(tmp_path, REFERENCE), **fields)
    with pytest.raises(RecordError, match=said) as refused:
        read_reference(path)
    assert str(path) in str(refused.value)
    assert "delete it" in str(refused.value)


@pytest.mark.parametrize(
    ("light", "colour", "said"),
    [
        (LIGHT, np.zeros_like(LIGHT), "the same cells"),
        (np.full_like(LIGHT, np.nan), np.full_like(LIGHT, np.nan), "the same cells"),
        (np.where(LIGHT > 3.0, np.float32(21.0), LIGHT), LIGHT, "within 20"),
    ],
)
def test_maps_that_cannot_be(
    tmp_path: Path, light: np.ndarray, colour: np.ndarray, said: str
) -> None:
    path = write_reference(tmp_path, replace(REFERENCE, light=light, colour=colour))
    with pytest.raises(RecordError, match=said):
        read_reference(path)


def test_a_bad_file_keeps_the_good_ones(tmp_path: Path) -> None:
    path = write_reference(tmp_path, REFERENCE)
    (path.parent / "broken.reference").write_bytes(b"\xff\x00{")
    found, troubles = read_references(tmp_path)
    assert len(found) == 1
    assert len(troubles) == 1
    assert "broken.reference is not used: its header is damaged" in troubles[0]


@given(st.integers(0, 10_000), st.integers(0, 255))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_one_byte_changed_is_noticed_or_harmless(
    tmp_path: Path, place: int, value: int
) -> None:
    path = write_reference(tmp_path, REFERENCE)
    data = bytearray(path.read_bytes())
    data[place % len(data)] = value
    path.write_bytes(data)
    found, troubles = read_references(tmp_path)
    assert len(found) + len(troubles) == 1
    assert all(str(path) in trouble for trouble in troubles)
    assert all(each.light.shape == LIGHT.shape for each in found)


def test_a_folder_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / FOLDER).write_text("a file in the way")
    with pytest.raises(RecordError, match="cannot be written"):
        write_reference(tmp_path, REFERENCE)
    assert read_references(tmp_path) == ((), ())
