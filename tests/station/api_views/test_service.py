"""The station as the API sees it: orders to many, all stop, and a view of everything."""

import json
from dataclasses import replace

import httpx
import pytest
from tests.api.client import Client
from tests.link.approved import core, extended
from tests.persons import ANN, BOB
from tests.ready import ready_profile, ready_site
from tests.safety.cases import mission, waypoint

from recon import wire
from recon.api.schema import ActionResponse, OrderResult, StationState
from recon.api.security import Access, AccessCheck
from recon.model.command import Body, Hover, LandNow
from recon.model.errors import ReconError
from recon.model.event import LinkClosed, LinkOpened, PacketReceived
from recon.model.geo import GeoPoint
from recon.model.units import NS_PER_S
from recon.site import Site, demo_site_folder, load_site
from recon.station.api_views.app import create_app
from recon.station.api_views.order_service import order_of
from recon.station.api_views.service import Service
from recon.station.imaging.frames import PROJECT_FRAME
from recon.station.kernel.build import first_state
from recon.station.kernel.driver import AsyncioDriver
from recon.vehicles.reports import to_report


class Bench:
    """A service whose clock and events are given by hand."""

    def __init__(self) -> None:
        home = GeoPoint(42.0, -93.6, 270.0)
        site = replace(ready_site(home, [ready_profile("A", home, name="Anna")]), name="here")
        self.now_ns = NS_PER_S
        self.driver = AsyncioDriver(first_state(site), lambda: self.now_ns)
        self.service = Service.around(self.driver, site, "/captures")

    def hear(self, link_id: int, *packets: bytes) -> None:
        for packet in packets:
            self.driver.handle(PacketReceived(link_id, to_report(wire.decode(packet))))

    def open(self, link_id: int, *packets: bytes) -> None:
        self.driver.handle(LinkOpened(link_id, f"10.0.0.{link_id}:5"))
        self.hear(link_id, *packets)

    def state(self) -> StationState:
        return self.service.state()

    def order(
        self, serials: list[str], body: Body, given_at_ns: int | None = None
    ) -> list[OrderResult]:
        return self.service.orders.give(
            serials, order_of(body, ANN, given_at_ns=given_at_ns)
        ).results

    def post(self, path: str, body: object = None) -> httpx.Response:
        app = create_app(self.service, None, "test")
        return Client(AccessCheck(app, Access(local=BOB))).post(path, json=body)

    def is_released(self, serials: list[str] | None) -> bool:
        answer = self.post("/api/all-stop/release", {"serials": serials})
        return ActionResponse.model_validate_json(answer.text).accepted


@pytest.fixture
def bench() -> Bench:
    return Bench()


class TestAllStop:
    def test_it_reaches_every_flying_link_and_tells_of_the_others(self, bench: Bench) -> None:
        bench.open(1, extended(b"A"), core())
        bench.open(2, extended(b"B"), core(is_flying=0))
        bench.open(3, core())
        bench.open(4, core(is_flying=0))
        bench.open(5, extended(b"00000"), core())
        results = bench.service.orders.all_stop(ANN).results
        accepted = {(r.serial, r.link_id): r.accepted for r in results}
        assert accepted == {("A", None): True, ("B", None): False, (None, 3): True, (None, 5): True}
        refused = next(r for r in results if r.serial == "B")
        assert refused.rule == "flying"

    def test_no_vehicle_is_ordered_twice(self, bench: Bench) -> None:
        bench.open(1, extended(b"A"), core())
        bench.open(2, extended(b"A"), core())
        results = bench.service.orders.all_stop(ANN).results
        assert [r.serial for r in results] == ["A"]

    def test_a_vehicle_that_flew_when_its_link_closed_is_stopped_when_it_is_back(
        self, bench: Bench
    ) -> None:
        bench.open(1, extended(b"A"), core())
        bench.driver.handle(LinkClosed(1, "gone"))
        (result,) = bench.service.orders.all_stop(ANN).results
        assert result.accepted
        assert "waits for telemetry" in (result.reason or "")

    def test_it_stays_in_force_until_a_person_releases_it(self, bench: Bench) -> None:
        bench.open(1, extended(b"A"), core())
        bench.service.orders.all_stop(ANN)
        bench.now_ns += 3 * NS_PER_S
        bench.open(2, extended(b"B"), core())
        latch = bench.state().stop_latch
        assert latch is not None
        assert (latch.by, latch.age_s, latch.released) == ("Ann", 3.0, [])
        assert [v.is_stopped for v in bench.state().vehicles] == [True, True]
        (refused,) = bench.order(["B"], mission())
        assert refused.rule == "stop_latch"
        assert bench.is_released(["A"])
        assert [v.is_stopped for v in bench.state().vehicles] == [False, True]
        assert bench.is_released(None)
        assert bench.state().stop_latch is None
        assert not bench.is_released(None)


class TestOrders:
    def test_results_carry_names_and_numbers(self, bench: Bench) -> None:
        bench.open(1, extended(b"A"), core())
        results = bench.order(["A", "Z"], LandNow())
        assert [(r.serial, r.accepted, r.vehicle_name) for r in results] == [
            ("A", True, "Anna"),
            ("Z", False, "Z"),
        ]
        assert results[1].rule == "reachable"
        assert results[0].rule is None

    def test_repairs_and_parts_of_a_mission_are_in_the_answer_refused_or_not(
        self, bench: Bench
    ) -> None:
        bench.open(1, extended(b"A"), core())
        body = mission(*(waypoint(10.0 * n, speed_mps=20.0) for n in range(120)))
        (result,) = bench.order(["A"], body)
        assert (result.accepted, result.parts) == (False, 2)
        assert [text.split(": ")[0] for text in result.repairs] == [
            "waypoints 1 to 120",
            "flown in 2 parts (waypoints 1 to 99, 99 to 120)",
        ]
        (landed,) = bench.order(["A"], LandNow())
        assert (landed.repairs, landed.parts) == ([], 0)

    def test_one_to_move_that_was_given_long_ago_is_refused_and_a_stop_is_not(
        self, bench: Bench
    ) -> None:
        bench.open(1, extended(b"A"), core())
        bench.now_ns += 30 * NS_PER_S
        bench.hear(1, extended(b"A"), core())
        given_ns = bench.now_ns - 25 * NS_PER_S
        for body, rule in ((mission(), "not_expired"), (Hover(), None)):
            (result,) = bench.order(["A"], body, given_ns)
            assert result.rule == rule

    def test_numbers_are_never_given_twice(self, bench: Bench) -> None:
        ids = [r.command_id for _ in range(20) for r in bench.order(["A", "B"], Hover())]
        assert len(set(ids)) == 40


class TestView:
    def test_values_carry_their_age(self, bench: Bench) -> None:
        bench.open(1, extended(b"A"), core(yaw_deg=90.0))
        bench.now_ns += 2 * NS_PER_S
        (vehicle,) = bench.state().vehicles
        assert (vehicle.name, vehicle.serial, vehicle.link_id) == ("Anna", "A", 1)
        assert vehicle.attitude.yaw_deg == 90.0
        assert vehicle.attitude.age_s == 2.0
        assert vehicle.staleness == "late"
        assert vehicle.is_flying.value is True
        assert vehicle.flight_mode.value == "gps_atti"
        assert vehicle.waypoint_altitude == "takeoff"
        assert vehicle.flies_missions is True

    def test_what_is_unknown_is_null(self, bench: Bench) -> None:
        bench.open(1, core(latitude_deg=0.0, longitude_deg=0.0, altitude_m=float("nan")))
        (vehicle,) = bench.state().vehicles
        assert vehicle.serial is None
        assert vehicle.name == "unidentified link 1"
        assert vehicle.position.latitude_deg is None
        assert vehicle.reported_altitude_m.value is None
        assert vehicle.battery_fraction.value is None
        assert vehicle.battery_fraction.age_s is None

    def test_a_link_without_a_word_is_no_vehicle(self, bench: Bench) -> None:
        bench.open(1)
        assert bench.state().vehicles == []
        (link,) = bench.state().links
        assert link.status == "unidentified"

    def test_conflicts_and_ends_are_seen_on_the_links(self, bench: Bench) -> None:
        bench.open(1, extended(b"A"), core())
        bench.open(2, extended(b"A"), core())
        assert [link.status for link in bench.state().links] == ["conflict", "conflict"]
        assert bench.state().vehicles[0].conflict_link_ids == [2]
        bench.driver.handle(LinkClosed(2, "8388609 bytes without one valid packet"))
        first, second = bench.state().links
        assert (first.status, second.status) == ("identified", "closed")
        assert second.closed_reason == "8388609 bytes without one valid packet"

    def test_numbers_stay_when_a_vehicle_is_gone(self, bench: Bench) -> None:
        bench.open(1, extended(b"A"), core())
        bench.open(2, extended(b"B"), core())
        bench.driver.handle(LinkClosed(1, "gone"))
        bench.open(3, extended(b"C"), core())
        numbers = {v.serial: v.number for v in bench.state().vehicles}
        assert numbers == {"A": 1, "B": 2, "C": 3}

    @pytest.mark.parametrize("value", [1.7e308, -1.7e308, float("inf"), float("nan")])
    def test_absurd_telemetry_is_still_json(self, bench: Bench, value: float) -> None:
        absurd = dict.fromkeys(("altitude_m", "height_above_takeoff_m", "yaw_deg"), value)
        bench.open(1, extended(b"A"), core(**absurd), core(altitude_m=-value))
        text = bench.state().model_dump_json()
        json.loads(text, parse_constant=lambda word: pytest.fail(f"{word} is no JSON"))

    def test_commands_are_shown_newest_first_with_their_life(self, bench: Bench) -> None:
        bench.open(1, extended(b"A"), core())
        for _ in range(60):
            bench.order(["A"], Hover())
        commands = bench.state().commands
        assert len(commands) == 50
        assert [c.id for c in commands] == sorted((c.id for c in commands), reverse=True)
        assert commands[0].phase == "queued"
        assert commands[1].phase == "superseded"
        assert commands[1].history[-1].note == f"Replaced by order {commands[0].id}"

    def test_the_station_speaks_of_itself(self, bench: Bench) -> None:
        bench.now_ns += 5 * NS_PER_S
        state = bench.state()
        assert state.station.uptime_s == 5.0
        assert state.station.capture_folder == "/captures"
        assert state.site is not None
        assert state.site.name == "here"

    def test_an_alarm_is_acknowledged_once_it_is_there(self, bench: Bench) -> None:
        warning = wire.encode(wire.MessageString(type=2, text=b"motor <b>hot</b>\x1b[31m"))
        bench.open(1, extended(b"A"), core(), warning)
        (alarm,) = bench.state().alarms
        assert "\x1b" not in alarm.text
        assert bench.post(f"/api/alarms/{alarm.id + 1}/acknowledge").status_code == 404
        assert bench.post(f"/api/alarms/{alarm.id}/acknowledge").status_code == 204
        assert all(a.is_acknowledged for a in bench.state().alarms)


class TestBuild:
    def test_the_demonstration_site_becomes_a_station(self) -> None:
        site = load_site(demo_site_folder())
        station = first_state(site)
        assert list(station.imaging.imagers) == ["SIM-IMAGER"]
        driver = AsyncioDriver(station, lambda: 0)
        site_view = Service.around(driver, site, None).state().site
        assert site_view is not None
        assert site_view.pose_rms_px is not None

    def test_without_an_imaging_drone_no_frame_is_projected(self) -> None:
        with pytest.raises(ReconError, match="no imaging drone"):
            PROJECT_FRAME.prepare(Site(name="bare"))
