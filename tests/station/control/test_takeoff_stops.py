"""A stop holds a vehicle that is about to fly: what waits is withdrawn, what left is followed."""

from tests.fleet.reports import core, extended
from tests.safety.cases import STICK, mission, waypoint
from tests.station.commanded import CommandedStation, flying
from tests.station.station_world import World, from_the_ground, square_mission, world

from recon.model.command import FlyMission, Hover, LandNow, Phase, StartCamera
from recon.model.control import AuthorityHolder
from recon.model.event import AuthorityTaken, CommandSent
from recon.model.vehicle import FlightMode
from recon.sim.fleet import Airborne

GROUND = (core(flying=False, height_m=0.0), extended(mode=FlightMode.GPS_ATTI))
CLIMBING = (core(height_m=1.0, velocity=(0.0, 0.0, -1.0)), extended(mode=FlightMode.AUTO_TAKEOFF))
HOVERING = (core(height_m=1.2), extended(mode=FlightMode.GPS_ATTI))
MISSION = (core(velocity=(5.0, 0.0, 0.0)), extended(mode=FlightMode.GPS_WAYPOINT))


def parked() -> CommandedStation:
    """One vehicle on the ground."""
    return CommandedStation().opens(1, *GROUND).keeps_receiving(1, *GROUND).passes(0.5)


def grounded(*faults: str) -> World:
    """The whole station with one simulated vehicle on the ground."""
    here = world(airborne=Airborne.NONE, faults=faults)
    here.run_for(3.0)
    return here


def takes_off(here: World) -> int:
    flown = from_the_ground(here.vehicle("SIM-1"), square_mission())
    return here.order("SIM-1", FlyMission(flown), takeoff=True)


def alarms(here: World) -> set[str]:
    every = here.driver.station.alarms.alarms.values()
    return {alarm.condition.rule for alarm in every if alarm.is_active}


class TestTheWholeStation:
    def highest_m(self, here: World, seconds: float) -> float:
        highest_m = 0.0
        for _ in range(round(seconds * 10)):
            here.run_for(0.1)
            highest_m = max(highest_m, here.app("SIM-1").aircraft.motion.height_m)
        return highest_m

    def test_a_hold_a_second_after_a_takeoff_mission_stops_it(self) -> None:
        here = grounded()
        takeoff = takes_off(here)
        here.run_for(0.3)
        assert here.record(takeoff).times_sent == 1
        hold = here.order("SIM-1", Hover())
        assert here.record(hold).phase is Phase.QUEUED
        here.run_for(0.1)
        assert "stop_waits" in alarms(here)
        assert self.highest_m(here, 40.0) < 6.0
        assert here.record(takeoff).phase is Phase.SUPERSEDED
        assert here.record(hold).phase is Phase.DONE
        assert "stop_waits" not in alarms(here)

    def test_a_queued_takeoff_never_leaves_after_the_stop(self) -> None:
        here = grounded()
        here.order("SIM-1", StartCamera(1.0))  # the takeoff waits for the gap behind it
        takeoff = takes_off(here)
        assert here.record(takeoff).times_sent == 0
        hold = here.order("SIM-1", Hover())
        here.run_for(1.0)
        assert here.record(hold).phase is Phase.DONE
        assert "withdrawn before it was sent" in here.record(hold).note
        assert self.highest_m(here, 20.0) == 0.0
        assert here.record(takeoff).times_sent == 0

    def test_a_release_to_the_pilot_withdraws_what_is_queued(self) -> None:
        here = grounded()
        here.order("SIM-1", StartCamera(1.0))
        takeoff = takes_off(here)
        here.driver.handle(AuthorityTaken("SIM-1", AuthorityHolder.PILOT, "Ann"))
        assert self.highest_m(here, 20.0) == 0.0
        assert here.record(takeoff).phase is Phase.SUPERSEDED
        assert here.record(takeoff).times_sent == 0


class TestATakeoffThatWasSent:
    def test_the_stop_waits_for_the_air_and_lasts_until_it_holds(self) -> None:
        scene = parked()
        scene.order(mission(), takeoff=True)
        hold = scene.passes(1.0).order(Hover())
        scene.passes(4.0)
        assert scene.times_s(hold) == []
        assert "stop_waits" in scene.alarms()
        scene.keeps_receiving(1, *CLIMBING).passes(5.0)
        assert len(scene.times_s(hold)) == 8
        scene.keeps_receiving(1, *HOVERING).passes(2.0)
        assert scene.phase(hold) is Phase.CONFIRMED
        assert len(scene.times_s(hold)) == 8
        assert "stop_waits" not in scene.alarms()
        scene.passes(20.0)
        assert scene.phase(hold) is Phase.DONE

    def test_a_mission_that_begins_after_the_stop_is_stopped_again(self) -> None:
        scene = parked()
        scene.order(mission(), takeoff=True)
        hold = scene.passes(1.0).order(Hover())
        scene.keeps_receiving(1, *CLIMBING).passes(1.0)
        scene.keeps_receiving(1, *HOVERING).passes(3.0)
        assert scene.phase(hold) is Phase.CONFIRMED
        before = len(scene.times_s(hold))
        scene.keeps_receiving(1, *MISSION).passes(0.3)
        assert len(scene.times_s(hold)) == before + 1
        assert "stop_waits" in scene.alarms()
        assert "pilot_took_over" not in scene.passes(2.0).alarms()
        assert len(scene.times_s(hold)) == before + 4

    def test_on_the_ground_at_the_end_nothing_was_needed(self) -> None:
        scene = parked()
        scene.order(mission(), takeoff=True)
        hold = scene.passes(1.0).order(Hover())
        scene.passes(31.0)
        assert scene.times_s(hold) == []
        assert scene.phase(hold) is Phase.DONE
        assert "order_not_confirmed" not in scene.alarms()

    def test_an_aircraft_that_does_not_obey_is_an_alarm_that_stays(self) -> None:
        scene = parked()
        scene.order(mission(), takeoff=True)
        hold = scene.passes(1.0).order(Hover())
        scene.keeps_receiving(1, *MISSION).passes(31.0)
        assert scene.phase(hold) is Phase.TIMED_OUT
        assert "order_not_confirmed" in scene.alarms()

    def test_telemetry_that_is_lost_meanwhile_is_an_alarm(self) -> None:
        scene = parked()
        scene.order(mission(), takeoff=True)
        hold = scene.passes(1.0).order(Hover())
        scene.talk.clear()
        scene.passes(31.0)
        assert scene.phase(hold) is Phase.EXPIRED
        assert "order_not_confirmed" in scene.alarms()

    def test_a_landing_follows_it_too(self) -> None:
        scene = parked()
        scene.order(mission(), takeoff=True)
        land = scene.passes(1.0).order(LandNow())
        scene.passes(1.0)
        assert scene.times_s(land) == []
        scene.keeps_receiving(1, *CLIMBING).passes(0.2)
        assert len(scene.times_s(land)) == 1

    def test_a_second_stop_follows_it_as_the_first_did(self) -> None:
        scene = parked()
        scene.order(mission(), takeoff=True)
        first = scene.passes(1.0).order(Hover())
        second = scene.passes(1.0).order(Hover())
        assert scene.phase(first) is Phase.SUPERSEDED
        scene.keeps_receiving(1, *CLIMBING).passes(0.2)
        assert len(scene.times_s(second)) == 1

    def test_one_given_in_the_air_goes_out_at_once(self) -> None:
        scene = parked()
        scene.order(mission(), takeoff=True)
        scene.keeps_receiving(1, *CLIMBING).passes(1.0)
        hold = scene.order(Hover())
        assert len(scene.times_s(hold)) == 1

    def test_a_takeoff_that_telemetry_has_shown_is_under_way_no_more(self) -> None:
        scene = parked()
        scene.order(mission(), takeoff=True)
        scene.keeps_receiving(1, *CLIMBING).passes(1.0)
        scene.keeps_receiving(1, *MISSION).passes(1.0)
        hold = scene.order(Hover())
        scene.keeps_receiving(1, *HOVERING).passes(0.3)
        assert scene.phase(hold) is Phase.DONE

    def test_a_later_one_that_was_refused_hides_it_from_no_stop(self) -> None:
        scene = parked()
        scene.order(mission(), takeoff=True)
        refused = scene.passes(0.5).order(mission(waypoint(), waypoint(5_000.0)), takeoff=True)
        assert scene.phase(refused) is Phase.REFUSED_BY_STATION
        hold = scene.passes(0.5).order(Hover())
        assert scene.phase(hold) is Phase.QUEUED
        scene.keeps_receiving(1, *CLIMBING).passes(0.2)
        assert len(scene.times_s(hold)) == 1

    def test_on_the_ground_without_a_takeoff_a_hold_is_refused(self) -> None:
        scene = parked()
        assert scene.refusal_rule(scene.order(Hover())) == "flying"
        scene.order(mission(), takeoff=True)
        scene.passes(31.0)
        assert scene.refusal_rule(scene.order(Hover())) == "flying"


class TestATakeoffInAQueue:
    def test_it_ends_with_the_stop_and_the_stop_with_its_withdrawal(self) -> None:
        scene = parked()
        scene.is_stuck = True
        takeoff = scene.order(Hover(), takeoff=True)
        hold = scene.order(Hover())
        assert scene.phase(takeoff) is Phase.SUPERSEDED
        assert scene.phase(hold) is Phase.QUEUED
        scene.dropped(takeoff, Phase.SUPERSEDED).passes(0.1)
        assert scene.phase(hold) is Phase.DONE
        assert scene.alarms() == set()

    def test_one_that_left_all_the_same_is_followed(self) -> None:
        scene = parked()
        scene.is_stuck = True
        takeoff = scene.order(mission(), takeoff=True)
        hold = scene.order(Hover())
        scene.is_stuck = False
        scene.happens(CommandSent(1, takeoff)).passes(1.0)
        assert scene.phase(hold) is Phase.QUEUED
        scene.keeps_receiving(1, *CLIMBING).passes(0.2)
        assert len(scene.times_s(hold)) == 1

    def test_a_stop_ends_what_waits_even_if_it_is_refused_itself(self) -> None:
        scene = flying()
        scene.is_stuck = True
        waiting = scene.order(STICK)
        scene.keeps_receiving(1, *GROUND).passes(3.0)
        hold = scene.order(Hover())
        assert scene.phase(hold) is Phase.REFUSED_BY_STATION
        assert scene.phase(waiting) is Phase.SUPERSEDED
