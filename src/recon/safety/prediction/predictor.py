"""The trajectory of a vehicle that follows its intent, the last commanded motion."""

from math import hypot

from recon.fleet.airborne import LANDING_MODES
from recon.model.control import Commanded, Intent
from recon.model.geo import LatLon
from recon.model.mission import Mission
from recon.safety.go_home import is_off_track
from recon.safety.prediction.legs import (
    LEAST_M,
    STANDING_MPS,
    Leg,
    corner_bulge_m,
    eased_rise_s,
    fly,
    rise_s,
    stop,
    stopping_distance_m,
)
from recon.safety.prediction.motion import VehicleMotion
from recon.safety.prediction.trajectory import (
    ALL_HEIGHTS_M,
    FOREVER_S,
    FlightPart,
    TrajectoryWriter,
)
from recon.safety.prediction_settings import PredictionSettings

UNDER_WAY_MPS = 2.0
"""A returning vehicle this fast towards its home is under way, at whatever height."""

UNHOMED_RADIUS_M = 150.0
"""Radius for a vehicle returning to an unknown or wrong home: as large as hazard areas grow."""


class Predictor:
    """Writes one vehicle's trajectory; `until_s` ends the work early when no more is asked.

    `exactly` writes phases of gaining and losing speed, for looking a few seconds ahead.
    """

    def __init__(
        self,
        motion: VehicleMotion,
        settings: PredictionSettings,
        *,
        until_s: float = FOREVER_S,
        exactly: bool = False,
    ) -> None:
        self.motion = motion
        self.settings = settings
        self.until_s = until_s
        self.exactly = exactly
        self.writer = TrajectoryWriter(motion.east_m, motion.north_m, motion.low_m, motion.high_m)
        self.writer.time_s = -motion.age_s
        self.delay_s = 0.0
        """Longest delay of the whole trajectory."""

    def follow(self, intent: Intent) -> None:
        """Write what an intent makes a vehicle do."""
        match intent.commanded:
            case Commanded.MISSION | Commanded.STICK if intent.mission is not None:
                self.fly_mission(intent.mission, intent.passed)
            case Commanded.STICK if intent.target is not None:
                height_m = intent.target_height_above_takeoff_m
                speed_mps = intent.speed_mps or self.settings.go_home_speed_mps
                self.go_to(intent.target, height_m, speed_mps)
                self.writer.stays(FlightPart.HOVERING)
            case Commanded.STICK:
                if intent.target_height_above_takeoff_m is not None:
                    self.writer.widens(*self.motion.up_m(intent.target_height_above_takeoff_m))
                self.go_straight_on(self.settings.stick_horizon_s)
                self.hold()
            case Commanded.HOLD:
                self.hold()
            case Commanded.LAND:
                self.land()
            case Commanded.RETURN:
                self.return_home()
            case _:
                self.drift()

    def fly_mission(self, mission: Mission, passed: int) -> None:
        """The rest of a mission, and indefinitely what it ends with."""
        waypoints, writer, plane = mission.waypoints, self.writer, self.motion.plane
        start_mps = 0.0 if writer.rows else None  # what was written before is a stop
        for index in range(passed, len(waypoints)):
            if writer.time_s > self.until_s:
                return
            waypoint = waypoints[index]
            is_last = index + 1 == len(waypoints)
            speed_mps = waypoints[max(0, index - 1)].speed_mps
            end_mps = 0.0
            if mission.curved and not is_last:
                end_mps = min(speed_mps, waypoint.speed_mps)
            writer.radius_m = self._bulge_m(mission, index)
            place_m = plane.east_north_m(waypoint)
            band_m = self.motion.up_m(waypoint.height_above_takeoff_m)
            towards_mps = self._towards_mps(*place_m) if start_mps is None else start_mps
            leg = Leg(*place_m, band_m, towards_mps, speed_mps, end_mps, index)
            if index == 0:
                self._fly_at_any_height_between(leg, climbs_first=True)
            else:
                fly(writer, leg, self.settings, exactly=self.exactly, until_s=self.until_s)
            start_mps = end_mps
            if waypoint.loiter_s is not None and waypoint.loiter_s > 0.0:
                writer.waits(waypoint.loiter_s, index)
        writer.radius_m = 0.0
        if mission.land_at_end:
            self.sink_here(FlightPart.LANDING)
        else:
            writer.stays(FlightPart.HOVERING)

    def go_to(self, target: LatLon, height_m: float | None, speed_mps: float) -> None:
        """Straight to a place, at any height between here and there."""
        writer = self.writer
        band_m = (writer.low_m, writer.high_m) if height_m is None else self.motion.up_m(height_m)
        place_m = self.motion.plane.east_north_m(target)
        start_mps = self._towards_mps(*place_m)
        leg = Leg(*place_m, band_m, start_mps, speed_mps, 0.0, FlightPart.GOING_TO)
        self._fly_at_any_height_between(leg, climbs_first=False)

    def _fly_at_any_height_between(self, leg: Leg, *, climbs_first: bool) -> None:
        """Fly a leg whose change of height comes first, last or on the way, and as long as that.

        One that climbs first, as most aircraft do at a mission's beginning, comes later to all that
        follows: `delay_s`. One that is seen to do so stays where it is until it has climbed.
        """
        writer, settings = self.writer, self.settings
        slow_mps = settings.slow_climb_mps
        fastest_s = rise_s(writer, leg.band_m, settings.climb_mps, settings.sink_mps)
        slowest_s = rise_s(writer, leg.band_m, slow_mps, slow_mps)
        self.delay_s = slowest_s if climbs_first else slowest_s - fastest_s
        if climbs_first and self.exactly and self._is_seen_to_climb(leg):
            climb_mps = min(settings.climb_mps, abs(self.motion.velocity_mps[2]))
            self._climb_here(leg, eased_rise_s(leg.band_m[1] - writer.high_m, climb_mps))
            fastest_s = 0.0
        writer.widens(*leg.band_m)
        both = leg._replace(band_m=(writer.low_m, writer.high_m))
        fly(writer, both, settings, exactly=self.exactly, until_s=self.until_s, least_s=fastest_s)
        writer.low_m, writer.high_m = leg.band_m

    def _is_seen_to_climb(self, leg: Leg) -> bool:
        is_below = leg.band_m[1] > self.writer.high_m
        climbs = self.motion.velocity_mps[2] >= STANDING_MPS
        return is_below and climbs and self.motion.speed_mps < UNDER_WAY_MPS

    def _climb_here(self, leg: Leg, seconds: float) -> None:
        writer = self.writer
        writer.moves(writer.east_m, writer.north_m, seconds, leg.part, band_m=leg.band_m)

    def go_straight_on(self, seconds: float, part: int = FlightPart.STEERED) -> None:
        """Keep the present velocity for a while."""
        east_mps, north_mps, up_mps = self.motion.velocity_mps
        writer, rise_m = self.writer, up_mps * seconds
        writer.moves(
            writer.east_m + east_mps * seconds,
            writer.north_m + north_mps * seconds,
            seconds,
            part,
            band_m=(writer.low_m + rise_m, writer.high_m + rise_m),
        )

    def hold(self, reaction_s: float = 0.0) -> None:
        """Brake after the reaction time, and hover indefinitely."""
        stop(self.writer, self.motion.velocity_mps, self.settings, reaction_s=reaction_s)
        self.writer.stays(FlightPart.HOVERING)

    def land(self) -> None:
        """Brake and be anywhere between here and the ground."""
        stop(self.writer, self.motion.velocity_mps, self.settings, reaction_s=0.0)
        self.sink_here(FlightPart.LANDING)

    def sink_here(self, part: int) -> None:
        """Sink from where the trajectory has come to, anywhere between there and the ground; then
        be down, which ends the trajectory. A few seconds ahead only so far as it can sink in them.
        """
        writer, settings = self.writer, self.settings
        if self.exactly:
            low_m = writer.low_m - self.until_s * settings.sink_mps
            band_m = low_m, writer.high_m
            writer.moves(writer.east_m, writer.north_m, self.until_s, part, band_m=band_m)
            return
        base_m = self.motion.takeoff_up_m
        high_m = settings.unknown_climb_m if base_m is None else max(0.0, writer.high_m - base_m)
        writer.widens(-ALL_HEIGHTS_M, writer.high_m)
        high_m = min(high_m, settings.unknown_climb_m)
        writer.waits(high_m / settings.landing_mps + settings.landing_wait_s, part)

    def return_home(self) -> None:
        """Climb to the go-home height unless higher, fly home, sink."""
        motion, writer, settings = self.motion, self.writer, self.settings
        if motion.state.flight_mode.value in LANDING_MODES:
            self.land()  # it has come home, and does not climb again
            return
        if motion.home_m is None or is_off_track(motion.state):
            writer.widens(-ALL_HEIGHTS_M, ALL_HEIGHTS_M)
            writer.grows(
                UNHOMED_RADIUS_M, UNHOMED_RADIUS_M / settings.go_home_speed_mps, FlightPart.FREE
            )
            writer.stays(FlightPart.FREE)
            return
        towards_mps = self._towards_mps(*motion.home_m)
        top_m = go_home_top_m(motion, settings)
        if towards_mps >= UNDER_WAY_MPS:
            writer.widens(writer.low_m, top_m)
        else:
            stop(writer, motion.velocity_mps, settings, reaction_s=0.0)
            towards_mps = 0.0
        if top_m > writer.high_m:
            low_m, climb_s = writer.low_m, (top_m - writer.high_m) / settings.climb_mps
            writer.moves(
                writer.east_m,
                writer.north_m,
                climb_s,
                FlightPart.CLIMBING_HOME,
                band_m=(low_m, top_m),
            )
            if motion.go_home_up_m is not None:
                writer.low_m = top_m
        speed_mps = max(settings.go_home_speed_mps, towards_mps)
        band_m = (writer.low_m, writer.high_m)
        leg = Leg(*motion.home_m, band_m, towards_mps, speed_mps, 0.0, FlightPart.GOING_HOME)
        fly(writer, leg, settings, exactly=self.exactly)
        self.sink_here(FlightPart.LANDING)

    def drift(self) -> None:
        """Use the present speed in any direction for a while: a pilot may have it, or the wind."""
        motion, writer, settings = self.motion, self.writer, self.settings
        up_mps = motion.velocity_mps[2]
        if max(motion.speed_mps, abs(up_mps)) < STANDING_MPS:
            writer.stays(FlightPart.HOVERING)
            return
        rise_m = up_mps * settings.free_s
        writer.widens(writer.low_m + rise_m, writer.high_m + rise_m)
        reach_m = motion.speed_mps * settings.free_s
        reach_m += stopping_distance_m(motion.speed_mps, settings)
        writer.grows(reach_m, settings.free_s, FlightPart.FREE)
        writer.stays(FlightPart.FREE)

    def _towards_mps(self, east_m: float, north_m: float) -> float:
        """How fast the vehicle flies now towards a place."""
        ahead_m = east_m - self.writer.east_m, north_m - self.writer.north_m
        far_m = max(hypot(*ahead_m), LEAST_M)
        east_mps, north_mps, _up_mps = self.motion.velocity_mps
        return max(0.0, (ahead_m[0] * east_mps + ahead_m[1] * north_mps) / far_m)

    def _bulge_m(self, mission: Mission, index: int) -> float:
        """How far corners at either end of the leg to a waypoint may carry the vehicle off it."""
        if not mission.curved:
            return 0.0
        waypoints, plane = mission.waypoints, self.motion.plane
        bulges_m = [0.0]
        for corner in (index - 1, index):
            if 0 < corner < len(waypoints) - 1:
                before_m, corner_m, after_m = map(
                    plane.east_north_m, waypoints[corner - 1 : corner + 2]
                )
                radius_m = waypoints[corner].corner_radius_m
                bulges_m.append(corner_bulge_m(before_m, corner_m, after_m, radius_m))
        return max(bulges_m)


def go_home_top_m(motion: VehicleMotion, settings: PredictionSettings) -> float:
    """Return the height of the route home: the go-home height unless already higher."""
    if motion.go_home_up_m is None:
        return min(motion.high_m + settings.unknown_climb_m, ALL_HEIGHTS_M)
    return max(motion.high_m, motion.go_home_up_m)
