"""Every finding of the checklist, whole: its point, state, text and what to do about it."""

from collections.abc import Callable
from dataclasses import replace

import pytest
from tests.safety.cases import AIRSPACE, FACTS, TAKEOFF, S, situation, vehicle
from tests.safety.checks.test_go_home import other, zone
from tests.safety.checks.test_place import hilly, pad_at

from recon.model.airspace import FlightLimits
from recon.model.vehicle import (
    BatteryWarning,
    Failsafe,
    FlightMode,
    VehicleProfile,
    VehicleState,
)
from recon.safety import OPEN_AIRSPACE, PreparedAirspace
from recon.safety.check import Check, CheckState
from recon.safety.checks import aircraft, place, site_facts
from recon.safety.situation import NO_FACTS, ClockReading, Situation

OK, ATTENTION = CheckState.OK, CheckState.ATTENTION
UNKNOWN, FAILS = CheckState.UNKNOWN, CheckState.FAILS
READY = vehicle()
UNSET = vehicle(VehicleProfile("A"))
IN_SITE = 'under [[vehicles]] serial = "A" in site.toml'
OTHER_HEIGHT = "set another one in the aircraft and in site.toml"
STRICT = PreparedAirspace(
    replace(AIRSPACE.airspace, limits=FlightLimits(battery_reserve_fraction=0.4))
)
LOW_CEILING = PreparedAirspace(replace(AIRSPACE.airspace, limits=FlightLimits(50.0)))

TWO_WOODS = PreparedAirspace(
    replace(zone(80.0).airspace, zones=(*zone(80.0).airspace.zones, *zone(70.0).airspace.zones))
)

LINK = [
    (aircraft.link, READY, {}, OK, "telemetry is 0.1 s old", ""),
    (
        aircraft.link,
        replace(READY, rival_link_ids=(2,)),
        {},
        FAILS,
        "two connections claim this serial",
        "close the one that is not this aircraft's",
    ),
    (
        aircraft.link,
        replace(READY, core_received_at_ns=None),
        {},
        UNKNOWN,
        "no telemetry received yet",
        "check the app",
    ),
    (
        aircraft.link,
        vehicle(age_s=4.0),
        {},
        FAILS,
        "telemetry is 4.0 s old",
        "bring the app's connection back",
    ),
]
BATTERY = [
    (aircraft.battery, READY, {}, OK, "90%", ""),
    (
        aircraft.battery,
        vehicle(battery_warning=BatteryWarning.LOW),
        {},
        FAILS,
        "the aircraft warns of a low battery",
        "change the battery",
    ),
    (
        aircraft.battery,
        vehicle(battery_fraction=None),
        {},
        UNKNOWN,
        "battery charge unknown",
        "check the app",
    ),
    (
        aircraft.battery,
        vehicle(battery_fraction=0.4),
        {"airspace": STRICT},
        FAILS,
        "40%, all of it reserve (40%)",
        "change the battery",
    ),
    (
        aircraft.battery,
        vehicle(battery_fraction=0.45),
        {"airspace": STRICT},
        ATTENTION,
        "45%",
        "expect a short flight, or change the battery",
    ),
]
AIR = [
    (aircraft.gnss, READY, {}, OK, "14 satellites, signal level 4", ""),
    (
        aircraft.gnss,
        vehicle(flight_mode=FlightMode.ATTI),
        {},
        FAILS,
        "flies in ATTI, without GNSS; the pilot must steer it",
        "wait for a better fix, or move to open sky",
    ),
    (aircraft.wind, vehicle(wind_level=None), {}, OK, "the app reports no wind", ""),
    (aircraft.wind, vehicle(wind_level=1), {}, OK, "warning level 1", ""),
    (
        aircraft.wind,
        vehicle(wind_level=2),
        {},
        ATTENTION,
        "the aircraft warns of strong wind",
        "land, or fly low and near; battery goes faster",
    ),
    (aircraft.app, READY, {}, OK, "no unacknowledged warnings", ""),
    (
        aircraft.app,
        READY,
        {"facts": replace(FACTS, app_warnings=("compass error", "storage full"))},
        ATTENTION,
        "compass error; storage full",
        "read it, and acknowledge the alarm",
    ),
]
PLACE = [
    (place.fence, READY, {}, OK, "the boundary and 0 zones are loaded", ""),
    (
        place.fence,
        READY,
        {"airspace": OPEN_AIRSPACE},
        FAILS,
        "no boundary is loaded",
        "name one in site.toml under [layers]",
    ),
    (place.ground, READY, {"airspace": hilly()}, OK, "by the elevation model", ""),
    (
        place.ground,
        READY,
        {},
        ATTENTION,
        "flat ground assumed: no elevation model is loaded",
        "mind slopes and mounds, or name an elevation model in site.toml",
    ),
    (place.home_place, READY, {}, OK, "where it takes off", ""),
    (
        place.home_place,
        vehicle(takeoff_point=None),
        {},
        UNKNOWN,
        "home unknown: takeoff not observed, and no pad",
        "write its pad into site.toml, or let its pilot land it and take off again",
    ),
    (
        place.home_place,
        vehicle(pad_at(), takeoff_point=None),
        {},
        ATTENTION,
        "assumed at its pad: takeoff not observed",
        "confirm the home point with the pilot",
    ),
    (
        place.home_place,
        vehicle(pad_at(50.0)),
        {},
        ATTENTION,
        "50 m from its pad",
        "it comes back to where it takes off: is that free?",
    ),
    (
        place.pad_altitude,
        READY,
        {},
        OK,
        "no pad: heights count from the ground at takeoff",
        "",
    ),
    (
        place.pad_altitude,
        vehicle(pad_at()),
        {},
        ATTENTION,
        "not compared with the ground: no elevation model is loaded",
        "compare the pad's altitude in site.toml with a map's, ellipsoidal both",
    ),
    (
        place.pad_altitude,
        vehicle(pad_at(80.0, -80.0)),
        {"airspace": hilly()},
        ATTENTION,
        "the elevation model has no ground at the pad",
        "check its extent",
    ),
    (
        place.pad_altitude,
        vehicle(pad_at(altitude_m=250.0)),
        {"airspace": hilly()},
        FAILS,
        "the pad is -22.0 m from the elevation model's ground",
        "correct the pad's altitude, or the model's datum, in site.toml",
    ),
    (
        place.pad_altitude,
        vehicle(pad_at(altitude_m=273.0)),
        {"airspace": hilly()},
        OK,
        "+1.0 m from the elevation model's ground",
        "",
    ),
]
CLOCK = [
    (place.clock, READY, {}, OK, "2026-05-28 20:26 UTC", ""),
    (
        place.clock,
        READY,
        {"facts": NO_FACTS},
        UNKNOWN,
        "the computer's clock has not been read",
        "wait a second",
    ),
    (
        place.clock,
        READY,
        {"facts": replace(FACTS, clock=ClockReading(119 * S))},
        FAILS,
        "the computer's clock shows 1970-01-01 00:01",
        "set it, and start the station anew",
    ),
    (
        place.clock,
        READY,
        {"facts": replace(FACTS, clock=ClockReading(1_780_000_000 * S, -3 * S))},
        ATTENTION,
        "the computer's clock was set by -3.0 s since the start",
        "times in the record count from before: start the station anew between flights",
    ),
]
PROFILE = [
    (site_facts.altitude_reference, READY, {}, OK, "takeoff", ""),
    (
        site_facts.altitude_reference,
        UNSET,
        {},
        UNKNOWN,
        "altitude reference not set",
        f'write waypoint_altitude = "takeoff" or "wgs84" {IN_SITE}',
    ),
    (site_facts.endurance, READY, {}, OK, "25 min", ""),
    (
        site_facts.endurance,
        vehicle(replace(TAKEOFF, endurance_s=3_600.0)),
        {},
        OK,
        "60 min",
        "",
    ),
    (
        site_facts.endurance,
        UNSET,
        {},
        UNKNOWN,
        "endurance not set",
        f"write endurance_min = MINUTES {IN_SITE}",
    ),
    (
        site_facts.failsafe,
        vehicle(replace(TAKEOFF, failsafe=Failsafe.HOVER)),
        {},
        OK,
        "hovers until its battery makes it land when it loses its controller",
        "",
    ),
    (
        site_facts.failsafe,
        UNSET,
        {},
        UNKNOWN,
        "failsafe for a lost controller not set",
        f'write failsafe = "go_home", "hover" or "land", as it is set in the aircraft {IN_SITE}',
    ),
    (
        site_facts.camera_interval,
        READY,
        {},
        OK,
        "a photo every 2 s, once the pilot has started the timer",
        "",
    ),
    (
        site_facts.camera_interval,
        UNSET,
        {},
        ATTENTION,
        "camera interval not set",
        f"write camera_interval_s = SECONDS {IN_SITE}, if it takes survey photos",
    ),
]
GO_HOME = [
    (site_facts.go_home_height, READY, {}, OK, "60 m above takeoff", ""),
    (
        site_facts.go_home_height,
        UNSET,
        {},
        UNKNOWN,
        "go-home height not set",
        "read it from the aircraft's settings and write go_home_height_m = METRES under "
        '[[vehicles]] serial = "A" in site.toml',
    ),
    (
        site_facts.go_home_height,
        vehicle(replace(TAKEOFF, go_home_height_m=10.5)),
        {},
        FAILS,
        "must be 20 to 500 m; got 10.5 m",
        OTHER_HEIGHT,
    ),
    (
        site_facts.go_home_height,
        READY,
        {"airspace": LOW_CEILING},
        FAILS,
        "must be at most 50 m; got 60 m",
        OTHER_HEIGHT,
    ),
    (
        site_facts.go_home_height,
        READY,
        {"facts": replace(FACTS, others=(other(62.0, serial="C"),))},
        FAILS,
        "must be 7.5 m from that of C; got 2.0 m at 60 m",
        OTHER_HEIGHT,
    ),
    (
        site_facts.go_home_height,
        READY,
        {"airspace": TWO_WOODS},
        ATTENTION,
        "60 m does not clear 'wood', 'wood'",
        "orders whose way home crosses it are refused; set a greater height to clear it",
    ),
]
NAMES = {
    aircraft.link: ("link", "Link"),
    aircraft.battery: ("battery", "Battery"),
    aircraft.gnss: ("gnss", "GNSS"),
    aircraft.wind: ("wind", "Wind"),
    aircraft.app: ("app", "App's warnings"),
    place.fence: ("fence", "Fence"),
    place.ground: ("ground", "Ground"),
    place.home_place: ("home", "Home"),
    place.pad_altitude: ("pad", "Pad's altitude"),
    place.clock: ("clock", "Clock"),
    site_facts.altitude_reference: ("altitude_reference", "Altitude reference"),
    site_facts.endurance: ("endurance", "Endurance"),
    site_facts.failsafe: ("failsafe", "Failsafe"),
    site_facts.camera_interval: ("camera_interval", "Camera interval"),
    site_facts.go_home_height: ("go_home_height", "Go-home height"),
}


@pytest.mark.parametrize(
    ("point", "state", "now", "stands", "text", "to_do"),
    [*LINK, *BATTERY, *AIR, *PLACE, *CLOCK, *PROFILE, *GO_HOME],
)
def test_it_is_stated_whole(
    point: Callable[[VehicleState, Situation], Check],
    state: VehicleState,
    now: dict[str, object],
    stands: CheckState,
    text: str,
    to_do: str,
) -> None:
    found = point(state, replace(situation(state), **now))  # type: ignore[arg-type]
    assert found == Check(*NAMES[point], stands, text, to_do)
