"""Only telemetry newer than a command confirms it (decisions on the ICD, 14)."""

import pytest
from tests.fleet.reports import S, Story, core, extended

from recon.fleet.confirmation import Progress, SentContext, progress, reading_of_sent
from recon.fleet.flight_table import Verdict
from recon.model.command import (
    Body,
    FlyMission,
    Hover,
    LandNow,
    ReturnHome,
    StartCamera,
    StickFrame,
    StopCamera,
    VirtualStick,
)
from recon.model.geo import LatLon
from recon.model.mission import Mission, Waypoint
from recon.model.report import ImageReport, Report
from recon.model.vehicle import FlightMode, VehicleState

WAYPOINT, GPS, LANDING, CONFIRM, HOME, JOYSTICK = (
    FlightMode.GPS_WAYPOINT,
    FlightMode.GPS_ATTI,
    FlightMode.AUTO_LANDING,
    FlightMode.CONFIRM_LANDING,
    FlightMode.GO_HOME,
    FlightMode.JOYSTICK,
)
MOVING = (5.0, 0.0, 0.0)
NORTH_THEN_EAST = FlyMission(
    Mission((Waypoint(42.01, -93.6, 40.0, 5.0), Waypoint(42.01, -93.59, 40.0, 5.0)))
)
STICK = VirtualStick(StickFrame.GROUND, 0.0, 1.0, 0.0, 30.0, 1.0)


def after(*reports: Report) -> VehicleState:
    """A vehicle that reported these values 1 s after the command was sent."""
    return (
        Story()
        .opens(1)
        .receives(1, extended("A", mode=None))
        .at(2.0)
        .receives(1, *reports)
        .vehicle()
    )


def sent(mode: FlightMode | None = WAYPOINT, was_flying: bool | None = True) -> SentContext:
    return SentContext(1 * S, mode, was_flying)


def seen(body: Body, state: VehicleState, context: SentContext | None = None) -> Progress:
    return progress(body, context or sent(), state, 2 * S)


class TestHover:
    @pytest.mark.parametrize("mode", [LANDING, WAYPOINT, HOME, JOYSTICK, CONFIRM, None])
    def test_hover_is_not_confirmed_in_modes_9_to_12_nor_21(self, mode: FlightMode | None) -> None:
        assert seen(Hover(), after(core(), extended(mode=mode))) is Progress.UNSEEN

    def test_hover_is_confirmed_when_the_mode_has_left_and_speed_is_near_zero(self) -> None:
        standing = core(velocity=(0.3, 0.3, 0.0))
        assert seen(Hover(), after(standing, extended(mode=GPS))) is Progress.COMPLETE

    @pytest.mark.parametrize("velocity", [(0.51, 0.0, 0.0), (0.0, 0.0, -0.6), None])
    def test_a_moving_vehicle_has_only_begun_to_hover(
        self, velocity: tuple[float, float, float] | None
    ) -> None:
        state = after(core(velocity=velocity), extended(mode=GPS))
        assert seen(Hover(), state) is Progress.BEGUN

    def test_a_takeoff_by_hover_is_confirmed_in_the_air_only(self) -> None:
        on_ground = after(core(flying=False), extended(mode=GPS))
        assert seen(Hover(), on_ground, sent(GPS, was_flying=False)) is Progress.UNSEEN
        in_the_air = after(core(), extended(mode=GPS))
        assert seen(Hover(), in_the_air, sent(GPS, was_flying=False)) is Progress.COMPLETE

    def test_telemetry_older_than_the_command_confirms_nothing(self) -> None:
        state = after(core(), extended(mode=GPS))
        assert seen(Hover(), state, SentContext(2 * S, WAYPOINT, True)) is Progress.UNSEEN
        assert seen(LandNow(), state, SentContext(2 * S, WAYPOINT, True)) is Progress.UNSEEN


class TestLand:
    @pytest.mark.parametrize("mode", [LANDING, CONFIRM])
    def test_land_is_confirmed_by_mode_9_or_21_then_on_ground(self, mode: FlightMode) -> None:
        assert seen(LandNow(), after(core(), extended(mode=mode))) is Progress.CONFIRMED
        on_ground = after(core(flying=False), extended(mode=mode))
        assert seen(LandNow(), on_ground) is Progress.COMPLETE

    @pytest.mark.parametrize("mode", [GPS, HOME, WAYPOINT, None])
    def test_other_modes_in_the_air_do_not(self, mode: FlightMode | None) -> None:
        assert seen(LandNow(), after(core(), extended(mode=mode))) is Progress.UNSEEN

    def test_not_knowing_whether_it_flies_is_not_the_ground(self) -> None:
        assert seen(LandNow(), after(core(flying=None), extended(mode=GPS))) is Progress.UNSEEN


class TestReturn:
    def test_return_is_confirmed_by_mode_11_then_on_ground(self) -> None:
        assert seen(ReturnHome(), after(core(), extended(mode=HOME))) is Progress.CONFIRMED
        on_ground = after(core(flying=False), extended(mode=GPS))
        assert seen(ReturnHome(), on_ground) is Progress.COMPLETE
        assert seen(ReturnHome(), after(core(), extended(mode=GPS))) is Progress.UNSEEN
        assert seen(ReturnHome(), after(core(), extended(mode=LANDING))) is Progress.UNSEEN


class TestMission:
    def test_a_mission_is_confirmed_when_the_mode_becomes_10(self) -> None:
        state = after(core(velocity=(-5.0, 0.0, 0.0)), extended(mode=WAYPOINT))
        assert seen(NORTH_THEN_EAST, state, sent(GPS)) is Progress.CONFIRMED
        assert seen(NORTH_THEN_EAST, after(extended(mode=GPS)), sent(GPS)) is Progress.UNSEEN

    @pytest.mark.parametrize("before", [WAYPOINT, None])
    @pytest.mark.parametrize(
        ("velocity", "is_seen"),
        [
            ((5.0, 0.0, 0.0), True),
            ((5.0, 2.8, 0.0), True),
            ((5.0, 3.0, 0.0), False),
            ((-5.0, 0.0, 0.0), False),
            ((0.2, 0.0, 0.0), False),
            (None, False),
        ],
    )
    def test_in_mode_10_already_position_and_velocity_must_agree_with_the_first_leg(
        self,
        before: FlightMode | None,
        velocity: tuple[float, float, float] | None,
        is_seen: bool,
    ) -> None:
        state = after(core(velocity=velocity), extended(mode=WAYPOINT))
        expected = Progress.CONFIRMED if is_seen else Progress.UNSEEN
        assert seen(NORTH_THEN_EAST, state, sent(before)) is expected

    @pytest.mark.parametrize(
        ("velocity", "is_seen"),
        [((0.0, 0.0, 0.0), True), ((0.0, 5.0, 0.0), True), ((0.0, -5.0, 0.0), False)],
    )
    def test_at_the_first_waypoint_it_must_stand_or_fly_on_along_the_mission(
        self, velocity: tuple[float, float, float], is_seen: bool
    ) -> None:
        state = after(
            core(position=LatLon(42.01, -93.6), velocity=velocity), extended(mode=WAYPOINT)
        )
        expected = Progress.CONFIRMED if is_seen else Progress.UNSEEN
        assert seen(NORTH_THEN_EAST, state) is expected

    @pytest.mark.parametrize(
        ("reported", "is_seen"),
        [
            ([(WAYPOINT, 7), (WAYPOINT, 7)], False),  # flies on with the mission before
            ([(WAYPOINT, 7), (WAYPOINT, 8)], True),
            ([(WAYPOINT, 7), (WAYPOINT, 0)], False),  # restarted, and flies on with it
            ([(WAYPOINT, 7), (WAYPOINT, 0), (GPS, 0), (WAYPOINT, 1)], True),
            ([(WAYPOINT, 7), (GPS, 0), (WAYPOINT, 7), (WAYPOINT, 7)], True),  # always the same
            ([(WAYPOINT, 0), (WAYPOINT, 0)], True),  # always 0
        ],
    )
    def test_an_app_that_counts_its_missions_must_show_another_number(
        self, reported: list[tuple[FlightMode, int]], is_seen: bool
    ) -> None:
        first, *later = (extended(mode=mode, mission_id=number) for mode, number in reported)
        story = Story().opens(1).receives(1, core(velocity=MOVING), first).at(1.0)
        when_sent = story.vehicle().mission_id.value
        state = story.at(2.0).receives(1, core(velocity=MOVING), *later).vehicle()
        context = SentContext(1 * S, WAYPOINT, True, when_sent)
        expected = Progress.CONFIRMED if is_seen else Progress.UNSEEN
        assert seen(NORTH_THEN_EAST, state, context) is expected

    def test_taking_off_for_it_is_only_its_beginning(self) -> None:
        state = after(core(), extended(mode=FlightMode.AUTO_TAKEOFF))
        assert seen(NORTH_THEN_EAST, state, sent(GPS)) is Progress.BEGUN

    def test_on_the_ground_it_is_not_flown(self) -> None:
        state = after(core(flying=False), extended(mode=WAYPOINT))
        assert seen(NORTH_THEN_EAST, state, sent(GPS)) is Progress.UNSEEN

    def test_without_a_position_nothing_agrees(self) -> None:
        state = after(core(position=None, velocity=MOVING), extended(mode=WAYPOINT))
        assert seen(NORTH_THEN_EAST, state) is Progress.UNSEEN


class TestStickAndCamera:
    def test_a_stick_is_confirmed_by_mode_12(self) -> None:
        assert seen(STICK, after(extended(mode=JOYSTICK))) is Progress.CONFIRMED
        assert seen(STICK, after(extended(mode=GPS))) is Progress.UNSEEN

    def test_a_camera_start_is_confirmed_by_an_image(self) -> None:
        image = ImageReport(target_fps_hz=1.0, jpeg=b"x")
        assert seen(StartCamera(1.0), after(image)) is Progress.COMPLETE
        assert seen(StartCamera(1.0), after(core())) is Progress.UNSEEN

    def test_a_camera_stop_is_confirmed_by_2_s_without_images(self) -> None:
        state = after(core())
        assert progress(StopCamera(), sent(), state, 3 * S) is Progress.COMPLETE
        assert progress(StopCamera(), sent(), state, 3 * S - 1) is Progress.UNSEEN
        late = after(core(), ImageReport(target_fps_hz=1.0, jpeg=b"x"))
        assert progress(StopCamera(), sent(), late, 3 * S) is Progress.UNSEEN


class TestPilot:
    def took_over(self, state: VehicleState, context: SentContext | None = None) -> bool:
        reading = reading_of_sent(Hover(), context or sent(), state)
        return reading.verdict is Verdict.PILOT and reading.is_at_once

    def test_a_mode_only_a_pilot_selects_is_a_takeover(self) -> None:
        assert self.took_over(after(extended(mode=FlightMode.GPS_SPORT)))
        assert self.took_over(after(extended(mode=FlightMode.MANUAL)))

    def test_the_mode_of_a_cancelled_mission_is_none(self) -> None:
        for mode in (GPS, FlightMode.GPS_NOVICE, None):
            assert not self.took_over(after(extended(mode=mode)))

    def test_a_mode_that_held_before_is_none_and_does_not_speak_against_a_hover(self) -> None:
        state = after(core(), extended(mode=FlightMode.GPS_SPORT))
        context = sent(FlightMode.GPS_SPORT)
        assert not self.took_over(state, context)
        assert seen(Hover(), state, context) is Progress.COMPLETE

    @pytest.mark.parametrize(("level", "is_pilot"), [(3, True), (2, False), (None, False)])
    def test_atti_is_the_pilots_only_while_gnss_is_good(
        self, level: int | None, is_pilot: bool
    ) -> None:
        state = after(extended(mode=FlightMode.ATTI, gnss_level=level))
        assert self.took_over(state) is is_pilot
