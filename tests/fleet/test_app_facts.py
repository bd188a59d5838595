"""Facts and photos of an app, folded into its vehicle's state."""

from tests.fleet.reports import S, Story, core, extended

from recon.model.app_report import AppFacts, PhotosReport, PhotoTally, ReportedPhoto


def known() -> Story:
    return Story().opens(1).receives(1, core(), extended())


def photos(*indices: int, series: int = 1, serial: str | None = None) -> PhotosReport:
    taken = tuple(ReportedPhoto(index, 0.5) for index in indices)
    return PhotosReport(series, taken, serial)


def test_facts_have_their_age_and_are_taken_whole() -> None:
    story = known().at(2.0).receives(1, AppFacts(go_home_height_m=60.0, failsafe="hover"))
    story = story.at(3.0).receives(1, AppFacts(go_home_height_m=50.0))
    facts = story.vehicle().app_facts
    assert facts.value == AppFacts(go_home_height_m=50.0)
    assert facts.age_s(5 * S) == 2.0


def test_facts_withheld_on_a_link_do_not_replace_newer_ones() -> None:
    story = known().at(3.0).receives(1, AppFacts(failsafe="land"))
    state = story.vehicle()
    assert state.app_facts.received_at_ns == 3 * S


def test_photos_are_counted_once_and_missing_ones_are_known() -> None:
    story = known().at(10.0).receives(1, photos(3, 4), photos(4, 6), photos(2))
    assert story.vehicle().photo_tally == PhotoTally(1, 6, 5, round(9.5 * S))
    assert story.vehicle().photo_tally.missing == 1  # type: ignore[union-attr]


def test_another_series_begins_anew() -> None:
    story = known().at(10.0).receives(1, photos(7), photos(1, series=2))
    assert story.vehicle().photo_tally == PhotoTally(2, 1, 1, round(9.5 * S))


def test_photos_of_another_aircraft_do_not_count() -> None:
    assert known().receives(1, photos(1, serial="other")).vehicle().photo_tally is None
