"""What a flight learns is written into the site's folder, and read by the next start."""

from dataclasses import replace
from pathlib import Path

import pytest
from tests.detection.test_earlier_flights import FIRST, flown
from tests.detection.test_sunlit_reference import known_share

from recon.detection import DetectionState
from recon.model.imagery import GroundImage
from recon.model.units import seconds_to_ns
from recon.record.reference_file import FOLDER, read_references, write_reference
from recon.site import Site, demo_site_folder
from recon.station.alarms.conditions import conditions
from recon.station.api_views.imaging_views import shade_view
from recon.station.imaging.references import WRITE_EVERY_S, with_references, written
from recon.station.kernel.run import RunConfig, first_station
from recon.station.kernel.step import step
from recon.station.kernel.worker import JobRunner
from recon.station.state.imaging import Imaging
from recon.station.state.station import Station

Learned = tuple[DetectionState, GroundImage]


@pytest.fixture(scope="module")
def learned() -> Learned:
    state, _, image = flown(FIRST.moments())
    return state, image


def station_of(folder: Path, learned: Learned | None = None) -> Station:
    station = with_references(Station(imaging=Imaging(imager_serial="IMAGER")), folder)
    if learned is None:
        return station
    detection = replace(learned[0], references=station.shade.detection.references)
    return replace(station, shade=replace(station.shade, detection=detection))


def after_writing(station: Station, image: GroundImage) -> Station:
    shade, (job,) = written(station.shade, image)
    ended = JobRunner(Site(name="bare")).run(job)
    return step(replace(station, shade=shade), ended, image.captured_at_ns)[0]


def texts(station: Station) -> list[str]:
    return [each.text for each in conditions(station, 0) if each.rule == "sunlit_reference"]


def test_the_next_start_knows_the_land(tmp_path: Path, learned: Learned) -> None:
    station = after_writing(station_of(tmp_path, learned), learned[1])
    assert texts(station) == []
    again = station_of(tmp_path)
    (reference,) = again.shade.detection.references
    assert reference.serial == learned[1].serial
    first = next(replace(FIRST, sky=5, lasts_s=5.0).moments())
    state, maps, _ = flown(iter([first]), again.shade.detection)
    assert known_share(maps[0][0]) > 0.99
    shown = shade_view(replace(again, shade=replace(again.shade, detection=state)), 0)
    assert shown is not None
    assert "of an earlier flight" in shown.reference


def test_it_is_written_every_two_minutes(tmp_path: Path, learned: Learned) -> None:
    station, image = station_of(tmp_path, learned), learned[1]
    shade, jobs = written(station.shade, image)
    assert len(jobs) == 1
    due_ns = image.captured_at_ns + seconds_to_ns(WRITE_EVERY_S)
    early = replace(image, captured_at_ns=due_ns - 1)
    assert written(shade, early) == (shade, ())
    assert len(written(shade, replace(image, captured_at_ns=due_ns))[1]) == 1


def test_without_a_folder_or_an_image_nothing_is_written(learned: Learned, tmp_path: Path) -> None:
    assert written(Station().shade, learned[1])[1] == ()
    assert written(station_of(tmp_path).shade, None)[1] == ()


def test_too_little_learned_writes_no_file(tmp_path: Path, learned: Learned) -> None:
    after_writing(station_of(tmp_path), learned[1])
    assert not (tmp_path / FOLDER).exists()


def test_a_folder_that_cannot_be_written_is_an_alarm_until_it_can(
    tmp_path: Path, learned: Learned
) -> None:
    (tmp_path / FOLDER).write_text("a file in the way")
    station = after_writing(station_of(tmp_path, learned), learned[1])
    (text,) = texts(station)
    assert "cannot be written" in text
    (tmp_path / FOLDER).unlink()
    assert texts(after_writing(station, replace(learned[1], captured_at_ns=10**15))) == []


def test_a_file_that_is_not_read_is_an_alarm(tmp_path: Path, learned: Learned) -> None:
    after_writing(station_of(tmp_path, learned), learned[1])
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
    station = Station(imaging=Imaging(imager_serial="IMAGER"))
    station = replace(station, shade=replace(station.shade, detection=detection))
    (alarm,) = [each for each in conditions(station, 0) if each.rule == "exposure_lock"]
    assert "exposure changed by 30% within 20 s" in alarm.text
    assert "lock exposure and white balance" in alarm.text


def test_a_start_reads_its_site_but_keeps_nothing_in_the_demonstrations(
    tmp_path: Path, learned: Learned
) -> None:
    after_writing(station_of(tmp_path, learned), learned[1])
    site = Site(name="bare")
    begun = first_station(RunConfig(site, site_folder=tmp_path))
    assert len(begun.shade.detection.references) == 1
    assert begun.shade.references is not None
    for folder in (None, demo_site_folder()):
        assert first_station(RunConfig(site, site_folder=folder)).shade.references is None
