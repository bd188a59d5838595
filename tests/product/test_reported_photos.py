"""Photos that an app has reported are dated by their index: no clock is searched for."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.product.made_flight import (
    ONE,
    START_NS,
    UTC_AHEAD_NS,
    flight,
    times_s,
    write_photo,
    write_record,
)

from recon.model.errors import RecordError
from recon.model.units import NS_PER_S
from recon.product.flight import FlightData
from recon.product.flight_reader import read_flight
from recon.product.photos.photo import Photo, read_photo_facts
from recon.product.reported_photos import numbers_of
from recon.product.reported_shots import ReportedShots
from recon.product.timing import StatedCamera, timed_photos

CLOCK_OFF_S = 5_461.0
"""No time zone, and wrong by a time that a search would have to find."""
FIRST_FILE = 117


def shot_times_s() -> np.ndarray:
    return times_s(ONE)[:40]


def cards(folder: Path) -> list[Photo]:
    photos = []
    for number, at_s in enumerate(shot_times_s().tolist()):
        east, north, _yaw = ONE.place(at_s)
        true_ns = UTC_AHEAD_NS + START_NS + round(at_s * NS_PER_S)
        path = write_photo(
            folder / f"DJI_{FIRST_FILE + number:04d}.JPG",
            place_m=(float(east), float(north)),
            clock_ns=true_ns + round(CLOCK_OFF_S * NS_PER_S),
            camera="CAM-1",
            satellites_ns=None,
            size=(16, 12),
        )
        photos.append(read_photo_facts(path, path.name))
    return photos


def reported(missing: tuple[int, ...] = (), late_s: float = 0.0) -> FlightData:
    at_s = shot_times_s()
    kept = np.array([k for k in range(len(at_s)) if k + 1 not in missing])
    places = np.array([ONE.place(each)[:2] for each in at_s.tolist()], dtype=float)
    shots = ReportedShots(
        ONE.serial,
        kept + 1,
        START_NS + np.rint((at_s[kept] + late_s) * NS_PER_S).astype(np.int64),
        places[kept, 0],
        places[kept, 1],
    )
    return replace(flight(), reported=(shots,))


def errors_s(found: list, photos: list[Photo]) -> list[float]:  # type: ignore[type-arg]
    number = {photo.name: k for k, photo in enumerate(photos)}
    at_s = shot_times_s()
    return [
        abs((each.at_ns - START_NS) / NS_PER_S - at_s[number[each.photo.name]]) for each in found
    ]


def test_each_photo_has_the_time_of_its_report(tmp_path: Path) -> None:
    photos = cards(tmp_path)
    found = timed_photos(reported(), photos, StatedCamera())
    assert len(found.photos) == len(photos)
    assert max(errors_s(found.photos, photos)) < 1e-6
    (clock,) = found.clocks
    assert clock.is_reported
    assert clock.offset_s == pytest.approx(-CLOCK_OFF_S, abs=0.6)
    assert "each by its app's report" in str(clock)


def test_a_photo_without_a_report_is_dated_by_the_others(tmp_path: Path) -> None:
    photos = cards(tmp_path)
    found = timed_photos(reported(missing=(5, 6, 20)), photos, StatedCamera())
    assert len(found.photos) == len(photos)
    assert max(errors_s(found.photos, photos)) < 1.0


def test_cards_with_photos_deleted_are_matched_by_number(tmp_path: Path) -> None:
    photos = cards(tmp_path)[::3]
    found = timed_photos(reported(), photos, StatedCamera())
    every = {photo.name: k for k, photo in enumerate(cards(tmp_path))}
    at_s = shot_times_s()
    assert all(
        (each.at_ns - START_NS) / NS_PER_S == pytest.approx(at_s[every[each.photo.name]])
        for each in found.photos
    )
    assert len(found.photos) == len(photos)


def test_a_stated_offset_counts_more_than_reports(tmp_path: Path) -> None:
    found = timed_photos(reported(), cards(tmp_path), StatedCamera(-CLOCK_OFF_S))
    assert [each.is_reported for each in found.clocks] == [False]


def test_without_reports_the_clock_is_searched_for(tmp_path: Path) -> None:
    found = timed_photos(flight(), cards(tmp_path), StatedCamera())
    assert all(not each.is_reported for each in found.clocks)


def event(report: dict[str, Any]) -> tuple[int, dict[str, Any]]:
    at_ns = START_NS + 20 * NS_PER_S
    return at_ns, {"_": "PacketReceived", "link_id": 1, "report": report, "arrived_at_ns": None}


REPORT: dict[str, Any] = {
    "_": "PhotosReport",
    "series": 9,
    "serial": ONE.serial,
    "photos": [
        {"index": 2, "age_s": 0.0, "latitude_deg": None, "longitude_deg": None},
        {"index": 1, "age_s": 1.5, "latitude_deg": 44.0, "longitude_deg": -93.0},
    ],
}


def test_a_record_keeps_what_was_reported(tmp_path: Path) -> None:
    again = {**REPORT, "photos": [{**REPORT["photos"][0], "age_s": 3.0}]}
    path = write_record(flight(), tmp_path / "a.mcap", events=[event(REPORT), event(again)])
    (found,) = read_flight(path).reported
    assert (found.serial, found.index.tolist()) == (ONE.serial, [1, 2])
    assert ((found.at_ns - START_NS) / NS_PER_S).tolist() == [18.5, 20.0]
    assert np.isfinite(found.east_m).tolist() == [True, False]


@pytest.mark.parametrize(
    "photo", [{"index": -1}, {"age_s": float("nan")}, {"age_s": 1e300}, {"index": "a"}]
)
def test_damaged_reports_are_a_damaged_record(tmp_path: Path, photo: dict[str, Any]) -> None:
    wrong = {**REPORT, "photos": [{**REPORT["photos"][0], **photo}]}
    path = write_record(flight(), tmp_path / "a.mcap", events=[event(wrong)])
    with pytest.raises(RecordError, match="damaged"):
        read_flight(path)


@pytest.mark.parametrize(
    ("names", "numbers"),
    [
        (["DJI_0007.JPG", "DJI_0012.JPG"], [7, 12]),
        (["DJI_20240531160837_0041_D.JPG", "DJI_20240531160839_0042_D.JPG"], [41, 42]),
        (["a.jpg", "DJI_0012.JPG"], [0, 1]),
    ],
)
def test_the_number_of_a_file_is_its_last_one(names: list[str], numbers: list[int]) -> None:
    assert numbers_of(names).tolist() == numbers
