"""What a flight learns is written into the site's folder, and read by the next start."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.detection.test_earlier_flights import FIRST, flown
from tests.detection.test_sunlit_reference import known_share
from tests.station.imagers import imager_of, with_imagers

from recon.detection import DetectionState
from recon.model.imagery import GroundImage
from recon.model.shade import ShadeMap, SunlitReference
from recon.model.units import seconds_to_ns
from recon.record.raster.reference_file import FOLDER, read_references, write_reference
from recon.site import Site, demo_site_folder
from recon.station.alarms.conditions import conditions
from recon.station.api_views.imaging_views import shade_view
from recon.station.host.run import first_station
from recon.station.host.run_config import RunConfig
from recon.station.imaging.references import WRITE_EVERY_S, with_references, written
from recon.station.kernel.step import step
from recon.station.kernel.worker import JobRunner
from recon.station.state.station import Station

Learned = tuple[DetectionState, GroundImage]


@pytest.fixture(scope="module")
def learned() -> Learned:
    state, _, image = flown(FIRST.moments())
    return state, image


def station_of(folder: Path, learned: Learned | None = None) -> Station:
    station = with_references(with_imagers(Station(), "IMAGER"), folder)
    if learned is None:
        return station
    detection, image = learned
    detection = replace(detection, references=found_in(station))
    imager = replace(imager_of(station), ground_image=image)
    imaging = replace(station.imaging, imagers={"IMAGER": imager})
    shade = replace(station.shade, detections={"IMAGER": detection}, shade=shade_at(image))
    return replace(station, imaging=imaging, shade=shade)


def shade_at(image: GroundImage) -> ShadeMap:
    """A map of which only the time counts."""
    known = np.ones((image.grid.rows, image.grid.cols), np.bool_)
    values = known.astype(np.float32)
    return ShadeMap(image.grid, image.captured_at_ns, ("IMAGER",), values, known, values, values)


def found_in(station: Station) -> tuple[SunlitReference, ...]:
    """The references of earlier flights."""
    assert station.shade.references is not None
    return station.shade.references.found


def after_writing(station: Station, at_ns: int = 0) -> Station:
    shade, (job,) = written(due(station, at_ns).shade, station.imaging)
    ended = JobRunner(Site(name="bare")).run(job)
    return step(replace(station, shade=shade), ended, 0)[0]


def due(station: Station, at_ns: int) -> Station:
    """The station with its shade map captured at a time, or as it is."""
    shade = station.shade.shade
    if shade is None or at_ns == 0:
        return station
    later = replace(station.shade, shade=replace(shade, captured_at_ns=at_ns))
    return replace(station, shade=later)


def texts(station: Station) -> list[str]:
    return [each.text for each in conditions(station, 0) if each.rule == "sunlit_reference"]


def test_the_next_start_knows_the_land(tmp_path: Path, learned: Learned) -> None:
    station = after_writing(station_of(tmp_path, learned))
    assert texts(station) == []
    again = station_of(tmp_path)
    (reference,) = found_in(again)
    assert reference.serial == learned[1].serial
    first = next(replace(FIRST, sky=5, lasts_s=5.0).moments())
    state, maps, _ = flown(iter([first]), DetectionState(references=found_in(again)))
    assert known_share(maps[0][0]) > 0.99
    shown = shade_view(replace(again, shade=replace(again.shade, detections={"IMAGER": state})), 0)
    assert shown is not None
    assert "of an earlier flight" in shown.reference


def test_it_is_written_every_two_minutes(tmp_path: Path, learned: Learned) -> None:
    station, image = station_of(tmp_path, learned), learned[1]
    shade, jobs = written(station.shade, station.imaging)
    assert len(jobs) == 1
    station = replace(station, shade=shade)
    due_ns = image.captured_at_ns + seconds_to_ns(WRITE_EVERY_S)
    early = due(station, due_ns - 1).shade
    assert written(early, station.imaging) == (early, ())
    assert len(written(due(station, due_ns).shade, station.imaging)[1]) == 1


def test_without_a_folder_or_a_map_nothing_is_written(learned: Learned, tmp_path: Path) -> None:
    station = station_of(tmp_path, learned)
    homeless = replace(station.shade, references=None)
    assert written(homeless, station.imaging)[1] == ()
    assert written(station_of(tmp_path).shade, station.imaging)[1] == ()


def test_too_little_learned_writes_no_file(tmp_path: Path, learned: Learned) -> None:
    station = station_of(tmp_path, learned)
    nothing = replace(station.shade, detections={"IMAGER": DetectionState()})
    after_writing(replace(station, shade=nothing))
    assert not (tmp_path / FOLDER).exists()


def test_a_folder_that_cannot_be_written_is_an_alarm_until_it_can(
    tmp_path: Path, learned: Learned
) -> None:
    (tmp_path / FOLDER).write_text("a file in the way")
    station = after_writing(station_of(tmp_path, learned))
    (text,) = texts(station)
    assert "cannot be written" in text
    (tmp_path / FOLDER).unlink()
    assert texts(after_writing(station, 10**15)) == []


def test_a_file_that_is_not_read_is_an_alarm(tmp_path: Path, learned: Learned) -> None:
    after_writing(station_of(tmp_path, learned))
    (reference,), _ = read_references(tmp_path)
    path = write_reference(tmp_path, reference)
    path.write_bytes(path.read_bytes()[:-1])
    (text,) = texts(station_of(tmp_path))
    assert f"{path} is not used" in text


def test_a_camera_that_is_not_locked_is_an_alarm(learned: Learned) -> None:
    memory = learned[0].sunlit
    assert memory is not None
    changed = replace(memory, lock_problem="exposure changed by 30% within 20 s")
    detection = replace(learned[0], sunlit=changed)
    station = with_imagers(Station(), "IMAGER")
    shade = replace(station.shade, detections={"IMAGER": detection})
    station = replace(station, shade=shade)
    (alarm,) = [each for each in conditions(station, 0) if each.rule == "exposure_lock"]
    assert "exposure changed by 30% within 20 s" in alarm.text
    assert "lock exposure and white balance" in alarm.text


def test_a_start_reads_its_site_but_keeps_nothing_in_the_demonstrations(
    tmp_path: Path, learned: Learned
) -> None:
    after_writing(station_of(tmp_path, learned))
    site = Site(name="bare")
    begun = first_station(RunConfig(site, site_folder=tmp_path))
    assert len(found_in(begun)) == 1
    for folder in (None, demo_site_folder()):
        assert first_station(RunConfig(site, site_folder=folder)).shade.references is None
