"""The checklist in the station: overrides with a reason, and what the list needs to know."""

from dataclasses import replace

import pytest
from tests.fleet.reports import core, extended
from tests.safety.cases import mission
from tests.station.commanded import CommandedStation

from recon.model.command import Phase
from recon.model.event import AlarmAcknowledged, ClockRead, PreflightOverridden
from recon.model.report import MessageReport, MessageSeverity
from recon.model.vehicle import FlightMode
from recon.safety import Override, PreparedAirspace
from recon.station.control import preflight
from recon.station.kernel.virtual import EPOCH_NS
from recon.station.state.station import Clock, Station

HOVERING = (core(), extended(mode=FlightMode.GPS_ATTI))
ON_GROUND = (core(flying=False, height_m=0.0), extended(mode=FlightMode.GPS_ATTI))
S = 1_000_000_000


@pytest.fixture
def scene() -> CommandedStation:
    """A vehicle on the ground of a site without a fence."""
    scene = CommandedStation()
    scene.station = _unfenced(scene)
    return scene.opens(1, *ON_GROUND).keeps_receiving(1, *ON_GROUND).passes(0.5)


def _unfenced(scene: CommandedStation) -> Station:
    airspace = replace(scene.station.airspace.airspace, boundary=None)
    return replace(scene.station, airspace=PreparedAirspace(airspace))


def overrides(
    scene: CommandedStation, reason: str = "the fence comes tomorrow", serial: str = "A"
) -> CommandedStation:
    return scene.happens(PreflightOverridden(serial, "Ann", reason))


class TestOverride:
    def test_without_it_the_mission_is_refused_with_it_sent(self, scene: CommandedStation) -> None:
        refused = scene.order(mission(), takeoff=True)
        assert scene.phase(refused) is Phase.REFUSED_BY_STATION
        assert scene.refusal_rule(refused) == "preflight"
        assert scene.record(refused).note.startswith("A: preflight checklist not")
        assert scene.phase(overrides(scene).order(mission(), takeoff=True)) is Phase.SENT

    def test_who_when_and_why_is_kept(self, scene: CommandedStation) -> None:
        overrides(scene, "  wind in the trees \n")
        kept = scene.station.control("A").preflight_override
        assert kept == Override("Ann", "wind in the trees", scene.now_ns)

    @pytest.mark.parametrize("reason", ["", "  \n\t", "x" * 501])
    def test_it_needs_a_reason_that_can_be_read(self, scene: CommandedStation, reason: str) -> None:
        refusal = preflight.refusal(scene.station, PreflightOverridden("A", "Ann", reason))
        assert refusal is not None
        assert refusal.rule == "preflight_override"
        assert overrides(scene, reason).station.control("A").preflight_override is None

    def test_an_unknown_vehicle_has_no_checklist(self, scene: CommandedStation) -> None:
        refusal = preflight.refusal(scene.station, PreflightOverridden("X", "Ann", "why not"))
        assert refusal is not None
        assert "X is unknown" in refusal.reason
        assert "X" not in overrides(scene, serial="X").station.controls

    def test_a_reason_of_500_characters_is_one(self, scene: CommandedStation) -> None:
        given = overrides(scene, "x" * 500).station.control("A").preflight_override
        assert given is not None
        assert given.reason == "x" * 500


def is_overridden(scene: CommandedStation) -> bool:
    return scene.station.control("A").preflight_override is not None


class TestItsEnd:
    def test_it_lasts_over_the_takeoff_and_ends_with_the_landing(
        self, scene: CommandedStation
    ) -> None:
        overrides(scene).passes(1.0)
        assert is_overridden(scene)
        scene.keeps_receiving(1, *HOVERING).passes(5.0)
        assert is_overridden(scene)
        scene.lands(1, *ON_GROUND)
        assert not is_overridden(scene)

    def test_a_landing_without_telemetry_ends_it_too(self, scene: CommandedStation) -> None:
        overrides(scene).keeps_receiving(1, *HOVERING).passes(1.0)
        scene.closes(1).passes(30.0).opens(2, *ON_GROUND)
        scene.keeps_receiving(2, *ON_GROUND).passes(1.2)
        assert not is_overridden(scene)

    def test_a_reconnect_on_the_ground_does_not(self, scene: CommandedStation) -> None:
        overrides(scene).closes(1).passes(2.0).opens(2, *ON_GROUND)
        assert is_overridden(scene)

    def test_an_unknown_moment_in_flight_does_not(self, scene: CommandedStation) -> None:
        overrides(scene).keeps_receiving(1, *HOVERING).passes(1.0).receives(1, core(flying=None))
        assert is_overridden(scene)

    def test_anothers_landing_does_not(self, scene: CommandedStation) -> None:
        overrides(scene).opens(2, core(), extended("B")).receives(2, *ON_GROUND[:1])
        scene.opens(3, core()).receives(3, core(flying=False))
        assert is_overridden(scene)


class TestClock:
    def test_a_clock_change_since_the_start_is_a_fact(self, scene: CommandedStation) -> None:
        scene.station = replace(scene.station, clock=None)
        assert preflight.facts(scene.station, None).clock is None
        scene.happens(ClockRead(EPOCH_NS + scene.now_ns))
        scene.passes(10.0).happens(ClockRead(EPOCH_NS + scene.now_ns + 3 * S))
        reading = preflight.facts(scene.station, None).clock
        assert reading is not None
        assert reading.set_by_ns == 3 * S
        assert reading.wall_ns == EPOCH_NS + scene.now_ns + 3 * S
        assert scene.station.clock == Clock(reading.wall_ns, EPOCH_NS + 3 * S, EPOCH_NS)


class TestFacts:
    def test_others_are_those_connected_or_perhaps_in_the_air(
        self, scene: CommandedStation
    ) -> None:
        scene.opens(2, core(), extended("B")).opens(3, core(flying=False), extended("C"))
        scene.opens(4, core(flying=False), extended("D")).closes(4)
        scene.opens(5, core(), extended("E")).closes(5)
        vehicle = scene.station.fleet.vehicles["A"]
        others = preflight.facts(scene.station, vehicle).others
        assert [other.serial for other in others] == ["B", "C", "E"]
        others = preflight.facts(scene.station, None).others
        assert [other.serial for other in others] == ["A", "B", "C", "E"]

    def test_its_apps_warnings_are_facts_until_acknowledged(self, scene: CommandedStation) -> None:
        scene.opens(2, core(), extended("B"))
        scene.receives(2, MessageReport(MessageSeverity.ERROR, "not mine"))
        scene.receives(1, MessageReport(MessageSeverity.WARNING, "compass error"))
        vehicle = scene.station.fleet.vehicles["A"]
        warnings = preflight.facts(scene.station, vehicle).app_warnings
        assert warnings == ("A: message from its app: compass error",)
        (alarm,) = [a for a in scene.station.alarms.alarms.values() if a.condition.serial == "A"]
        scene.happens(AlarmAcknowledged(alarm.id, "Ann"))
        assert preflight.facts(scene.station, vehicle).app_warnings == ()
