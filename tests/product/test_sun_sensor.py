"""The sun sensor of a camera against shade maps of a made flight, whose sun is known everywhere."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.product.made_flight import (
    HEIGHT_M,
    ONE,
    START_NS,
    UTC_AHEAD_NS,
    flight,
    sun,
    times_s,
    write_photo,
    write_record,
)
from tests.product.photos.packets import packet
from typer.testing import CliRunner

from recon.cli.commands import app
from recon.model.units import NS_PER_S
from recon.product.footprint import Aim, PhotoView
from recon.product.photos.band import PhotoBand
from recon.product.photos.photo import Photo
from recon.product.shot_files import ShotFiles
from recon.product.sun_at import SunHistory
from recon.product.sun_sensor import (
    agreement,
    agreement_lines,
    agreement_of,
    lit_by_sensor,
    map_and_sensor,
    shaded_place_m,
    shown_by_sensor,
    sun_by_sensor,
)
from recon.product.tag import PhotoTag, Shown
from recon.product.timing import TimedPhoto

FLIGHT = flight()
HISTORY = SunHistory(FLIGHT.grid, FLIGHT.maps)
SCALE = {"Green": 1_000.0, "NIR": 0.37}
DIFFUSE = 0.25
PHOTO = Photo(
    Path("x"), "x", 640, 480, 1, ("DJI", "M3M", "1"), 0, 1.0, 41.9, -93.6, None, 66.0, None, 60.0
)


def timed(at_s: float) -> TimedPhoto:
    east, north, yaw = (float(each) for each in ONE.place(at_s))
    view = PhotoView(Aim(east, north, HEIGHT_M, yaw), 66.0, 640, 480)
    at_ns = START_NS + round(at_s * NS_PER_S)
    return TimedPhoto(PHOTO, ONE.serial, at_ns, 0.1, view, HEIGHT_M)


def files(late_s: float = 0.0, noise: float = 0.0, of_sun: float = 1.0) -> tuple[ShotFiles, dict]:
    """Two bands a shot, and each shot's true direct sun at the aircraft, `late_s` before."""
    found, truth, random = ShotFiles(), {}, np.random.default_rng(5)
    for number, at_s in enumerate(times_s(ONE).tolist()):
        each, lead = timed(at_s), f"{number:03d}_Green.TIF"
        east_m, north_m = shaded_place_m(FLIGHT, each)
        truth[lead] = float(sun(east_m, north_m, at_s - late_s))
        direct = (truth[lead] - 0.2) / 0.8 * of_sun
        for band, scale in SCALE.items():
            value = scale * (DIFFUSE + (1.0 - DIFFUSE) * direct) * (1.0 + noise * random.normal())
            photo = replace(
                PHOTO, name=f"{number:03d}_{band}.TIF", band=PhotoBand(band), irradiance=value
            )
            found.photos.append(replace(each, photo=photo))
            found.shot[photo.name] = lead
    return found, truth


def leads(found: ShotFiles) -> list[TimedPhoto]:
    return [each for each in found.photos if found.leads(each)]


def test_the_sensor_is_in_the_shadow_that_falls_beside_the_aircraft() -> None:
    """With the sun in the east at half past nine local sun time the shadow falls to the west."""
    each = timed(60.0)
    shift = shaded_place_m(FLIGHT, each) - (each.view.aim.east_m, each.view.aim.north_m)
    assert shift[0] < -20.0
    assert np.hypot(*shift) == pytest.approx(HEIGHT_M / np.tan(np.deg2rad(49.2)), rel=0.15)


@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_direct_sun_is_known_whatever_the_unit_of_a_band(noise: float) -> None:
    found, truth = files(noise=noise)
    sensor = sun_by_sensor(found)
    assert sensor.keys() == truth.keys()
    wrong = [name for name, share in sensor.items() if (share >= 0.5) != (truth[name] >= 0.5)]
    assert wrong == []


def test_a_sensor_that_saw_only_sun_or_only_shade_tells_nothing() -> None:
    assert sun_by_sensor(files(noise=0.08, of_sun=0.0)[0]) == {}
    assert sun_by_sensor(ShotFiles()) == {}


@pytest.mark.parametrize("late_s", [0.0, 4.0, -3.0])
def test_agreement_and_lag_are_those_of_the_construction(late_s: float) -> None:
    found, _truth = files(late_s, noise=0.03)
    how = agreement(FLIGHT, leads(found), sun_by_sensor(found), HISTORY)
    assert how is not None
    assert how.photos > 50
    assert how.lag_s == pytest.approx(late_s, abs=1.0)
    assert how.correlation > 0.8
    if late_s == 0.0:
        assert how.correlation > 0.97
        assert str(how).endswith(" with the shade maps, lag +0 s")
        counted = agreement_of(
            map_and_sensor(FLIGHT, leads(found), sun_by_sensor(found), HISTORY).values()
        )
        assert counted.right > 0.95 * counted.known


def test_a_sensor_that_shows_another_sky_does_not_agree() -> None:
    found, _truth = files()
    values = sun_by_sensor(found)
    shuffled = dict(
        zip(values, np.random.default_rng(3).permutation([*values.values()]), strict=True)
    )
    how = agreement(FLIGHT, leads(found), shuffled, HISTORY)
    assert how is not None
    assert how.correlation < 0.5
    counted = agreement_of(map_and_sensor(FLIGHT, leads(found), shuffled, HISTORY).values())
    assert counted.right < 0.8 * counted.known


def test_how_often_the_maps_were_right_is_stated_for_sun_and_for_shade() -> None:
    """Every fourth photo's sensor shows the opposite of the truth: the maps seem wrong there."""
    found, truth = files()
    told = sun_by_sensor(found)
    turned = {n: 1.0 - s if k % 4 == 0 else s for k, (n, s) in enumerate(told.items())}
    both = map_and_sensor(FLIGHT, leads(found), turned, HISTORY)
    in_sun = [name for name, share in turned.items() if share >= 0.5]
    right = 100.0 * np.mean([truth[name] >= 0.5 for name in in_sun])
    first, second = agreement_lines(agreement_of(both.values()))
    assert first.startswith(f"Of {len(in_sun)} photos in sun by their own sun sensor, the maps")
    assert float(first.split(" sun in ")[-1].split()[0]) == pytest.approx(right, abs=5.0)
    assert second.startswith(f"Of {len(turned) - len(in_sun)} photos in shade by their own")


def test_photos_where_the_maps_know_nothing_are_counted_apart() -> None:
    pairs = [(1.0, 0.9), (0.2, 0.9), (float("nan"), 0.9)]
    assert [*agreement_lines(agreement_of(pairs))] == [
        "Of 2 photos in sun by their own sun sensor, the maps said sun in 50 %; 1 more were where "
        "the maps know nothing"
    ]
    assert [*agreement_lines(agreement_of([]))] == []


def test_maps_that_know_nothing_are_not_compared() -> None:
    found, _truth = files()
    nothing = SunHistory(FLIGHT.grid, ())
    assert agreement(FLIGHT, leads(found), sun_by_sensor(found), nothing) is None


def test_the_sensor_counts_only_where_the_maps_know_too_little() -> None:
    known = PhotoTag("a", 0.2, 0.8, 0.9)
    assert lit_by_sensor(known, 1.0) == known
    unknown = PhotoTag("a", float("nan"), 0.0, 0.1)
    assert lit_by_sensor(unknown, None).state(0.9) == "unknown"
    assert lit_by_sensor(unknown, 0.8).state(0.9) == "sunlit"
    assert lit_by_sensor(unknown, 0.3).state(0.9) == "shaded"
    shown = Shown(np.arange(3), np.array([True, False, False]), np.array([False, False, True]))
    assert shown_by_sensor(shown, None) is shown
    assert shown_by_sensor(shown, 0.9).is_lit.tolist() == [True, False, True]
    assert shown_by_sensor(shown, 0.1).is_lit.tolist() == [True, False, False]
    assert not shown_by_sensor(shown, 0.1).is_unknown.any()


@pytest.mark.parametrize("share", [3, None], ids=["a third of the maps", "no maps"])
def test_the_command_takes_the_sensor_where_there_are_no_maps(
    tmp_path: Path, share: int | None
) -> None:
    """Photos that no shade map reaches are told by the sensor."""
    made = replace(FLIGHT, maps=FLIGHT.maps[: len(FLIGHT.maps) // share] if share else ())
    record = write_record(made, tmp_path / "flight.mcap")
    truth = {}
    (tmp_path / "card").mkdir()
    for number, at_s in enumerate(times_s(ONE)[::3].tolist()):
        each, name = timed(at_s), f"{number:03d}.JPG"
        east_m, north_m = shaded_place_m(made, each)
        direct = (float(sun(east_m, north_m, at_s)) - 0.2) / 0.8
        truth[name] = "sunlit" if direct > 0.5 else "shaded"
        value = f"{700.0 * (DIFFUSE + (1.0 - DIFFUSE) * direct):.2f}"
        write_photo(
            tmp_path / "card" / name,
            place_m=(each.view.aim.east_m, each.view.aim.north_m),
            clock_ns=UTC_AHEAD_NS + START_NS + round(at_s * NS_PER_S),
            size=(64, 48),
            xmp=packet({"Camera:Irradiance": value}),
        )
    words = ["tag", str(tmp_path / "card"), "--flight", str(record), "--out", str(tmp_path / "out")]
    plain = CliRunner().invoke(app, words)
    if share is None:
        assert "expected a flight with shade maps" in plain.stderr
    else:
        assert " unknown" in plain.output
        stated = [line for line in plain.output.splitlines() if "by their own sun sensor" in line]
        page = tmp_path / "report.html"
        words_of_report = ["report", str(record), "--tagged", str(tmp_path / "out")]
        assert CliRunner().invoke(app, [*words_of_report, "--out", str(page)]).exit_code == 0
        assert len(stated) == 2
        assert all(f"<p>{line}.</p>" in page.read_text(encoding="utf-8") for line in stated)
        assert "with the shade maps, lag" in plain.output
    helped = CliRunner().invoke(app, [*words, "--sun-sensor"])
    assert helped.exit_code == 0, helped.output
    assert " unknown" not in helped.output
    with (tmp_path / "out" / "tags.csv").open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["light_by"] == "sun sensor"]
    assert len(rows) > 20
    assert all(row["state"] == truth[row["name"]] for row in rows)
