"""Settings of site.toml, and how to set them."""

from dataclasses import replace

import pytest
from tests.safety.cases import TAKEOFF, vehicle
from tests.safety.checks.checked import ATTENTION, OK, UNKNOWN, checked

from recon.model.vehicle import AltitudeReference, Failsafe
from recon.safety.checks.site_facts import altitude_reference, camera_interval, endurance, failsafe


@pytest.mark.parametrize(
    ("point", "lost", "text", "key"),
    [
        (
            altitude_reference,
            {"waypoint_altitude": AltitudeReference.UNSET},
            "takeoff",
            "waypoint_altitude = ",
        ),
        (endurance, {"endurance_s": None}, "25 min", "endurance_min = "),
        (failsafe, {"failsafe": None}, "goes home when it loses its controller", "failsafe = "),
    ],
)
class TestNeeded:
    def test_set_it_is_ok(self, point, lost, text, key) -> None:  # type: ignore[no-untyped-def]
        found = checked(point, vehicle())
        assert (found.state, found.text) == (OK, text)

    def test_not_set_it_states_what_to_write(self, point, lost, text, key) -> None:  # type: ignore[no-untyped-def]
        for profile in (replace(TAKEOFF, **lost), None):
            found = checked(point, replace(vehicle(), profile=profile))
            assert found.state is UNKNOWN
            assert found.to_do.startswith(f"write {key}")
            assert found.to_do.endswith('under [[vehicles]] serial = "A" in site.toml')


@pytest.mark.parametrize(
    ("does", "text"),
    [
        (Failsafe.HOVER, "hovers until its battery makes it land"),
        (Failsafe.LAND, "lands where it is"),
    ],
)
def test_every_failsafe_is_described(does: Failsafe, text: str) -> None:
    found = checked(failsafe, vehicle(replace(TAKEOFF, failsafe=does)))
    assert (found.state, found.text) == (OK, f"{text} when it loses its controller")


def test_the_cameras_interval_holds_nothing_back() -> None:
    assert checked(camera_interval, vehicle()).text.startswith("a photo every 2 s")
    found = checked(camera_interval, vehicle(replace(TAKEOFF, camera_interval_s=None)))
    assert found.state is ATTENTION
    assert not found.holds_back
    assert "camera_interval_s = SECONDS" in found.to_do
