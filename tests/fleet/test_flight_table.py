"""The flight table: complete, as documented, correct in the cells that matter."""

from itertools import product
from pathlib import Path

import pytest
from tools.flight_table_page import markdown

from recon.fleet.flight_table import (
    KIND_OF_MODE,
    TABLE,
    Instruction,
    ModeKind,
    Place,
    Reading,
    Verdict,
    kind_of,
    read,
)
from recon.model.vehicle import FlightMode

PAGE = Path(__file__).parents[2] / "docs" / "flight-table.md"

C, S, F, PILOT, FAILSAFE, UNDECIDED = (
    Verdict.CARRIED_OUT,
    Verdict.STARTED,
    Verdict.FINISHED,
    Verdict.PILOT,
    Verdict.FAILSAFE,
    Verdict.UNDECIDED,
)
END, ELSEWHERE, DOWN_AT_END, DOWN = Place
MODE = FlightMode
UNDER_WAY = (
    Instruction.MISSION,
    Instruction.MISSION_TO_LAND,
    Instruction.STICK,
    Instruction.RETURN,
    Instruction.LAND,
)


def seen(
    instruction: Instruction,
    mode: FlightMode | None,
    place: Place = ELSEWHERE,
    *,
    before: FlightMode | None = None,
    gnss: int | None = 4,
) -> Verdict:
    return read(instruction, mode, gnss, place, before).verdict


def test_every_mode_of_the_icd_has_a_kind_and_every_cell_a_verdict() -> None:
    assert set(KIND_OF_MODE) == set(FlightMode)
    assert set(TABLE) == set(product(Instruction, ModeKind, Place))
    for instruction, mode, place, gnss in product(Instruction, FlightMode, Place, (None, 0, 5)):
        reading = read(instruction, mode, gnss, place)
        assert isinstance(reading, Reading)
        assert reading.why


def test_the_page_is_written_from_the_table() -> None:
    assert PAGE.read_text(encoding="utf-8") == markdown(), "docs/flight-table.md is old: make docs"


class TestMissions:
    def test_mode_10_in_the_air_is_its_start(self) -> None:
        assert seen(Instruction.MISSION_SENT, MODE.GPS_WAYPOINT) is S
        assert seen(Instruction.MISSION_SENT, MODE.GPS_WAYPOINT, DOWN) is UNDECIDED
        assert seen(Instruction.MISSION, MODE.GPS_WAYPOINT) is C

    @pytest.mark.parametrize("mode", [MODE.AUTO_TAKEOFF, MODE.MOTORS_JUST_STARTED])
    @pytest.mark.parametrize("place", Place)
    def test_taking_off_for_it_is_no_start_and_no_fault(
        self, mode: FlightMode, place: Place
    ) -> None:
        assert seen(Instruction.MISSION_SENT, mode, place) is C

    @pytest.mark.parametrize("mode", [MODE.GPS_ATTI, MODE.GPS_NOVICE])
    def test_leaving_mode_10_at_its_end_is_its_end_and_elsewhere_the_pilot(
        self, mode: FlightMode
    ) -> None:
        assert seen(Instruction.MISSION, mode, END) is F
        assert seen(Instruction.MISSION, mode) is PILOT

    @pytest.mark.parametrize("place", Place)
    def test_going_home_is_its_failsafe_and_the_words_name_the_pilots_button(
        self, place: Place
    ) -> None:
        reading = read(Instruction.MISSION, MODE.GO_HOME, 4, place)
        assert reading.verdict is FAILSAFE
        assert "failsafe, or " in reading.why
        assert "pilot" in reading.why

    @pytest.mark.parametrize("mode", [MODE.AUTO_LANDING, MODE.CONFIRM_LANDING])
    @pytest.mark.parametrize("place", Place)
    def test_landing_that_was_not_ordered_is_its_failsafe(
        self, mode: FlightMode, place: Place
    ) -> None:
        assert seen(Instruction.MISSION, mode, place) is FAILSAFE

    @pytest.mark.parametrize("mode", [MODE.AUTO_LANDING, MODE.CONFIRM_LANDING])
    def test_one_that_lands_at_its_end_lands_there(self, mode: FlightMode) -> None:
        assert seen(Instruction.MISSION_TO_LAND, mode, END) is C
        assert seen(Instruction.MISSION_TO_LAND, mode) is FAILSAFE

    @pytest.mark.parametrize("mode", FlightMode)
    def test_one_that_lands_is_finished_on_the_ground_at_its_end_alone(
        self, mode: FlightMode
    ) -> None:
        assert seen(Instruction.MISSION_TO_LAND, mode, DOWN_AT_END) is F
        assert seen(Instruction.MISSION_TO_LAND, mode, DOWN) is FAILSAFE

    @pytest.mark.parametrize("place", [END, ELSEWHERE])
    def test_one_that_lands_and_hovers_instead_was_stopped_by_the_pilot(self, place: Place) -> None:
        assert seen(Instruction.MISSION_TO_LAND, MODE.GPS_ATTI, place) is PILOT

    def test_sticks_not_sent_by_the_station_are_the_pilots(self) -> None:
        assert seen(Instruction.MISSION, MODE.JOYSTICK) is PILOT
        assert seen(Instruction.HOLD, MODE.JOYSTICK, END) is PILOT


class TestThePilot:
    @pytest.mark.parametrize(
        "instruction",
        [instruction for instruction in Instruction if instruction is not Instruction.NOTHING],
    )
    @pytest.mark.parametrize("mode", [MODE.GPS_SPORT, MODE.MANUAL, MODE.TRIPOD, MODE.TAP_FLY])
    def test_a_mode_only_a_person_selects_is_the_pilot_at_once(
        self, instruction: Instruction, mode: FlightMode
    ) -> None:
        reading = read(instruction, mode, None, ELSEWHERE)
        assert (reading.verdict, reading.is_at_once) == (PILOT, True)

    @pytest.mark.parametrize(
        "instruction",
        [instruction for instruction in Instruction if instruction is not Instruction.HOLD],
    )
    @pytest.mark.parametrize("mode", [MODE.GPS_SPORT, MODE.ATTI, MODE.GPS_ATTI, MODE.JOYSTICK])
    def test_a_mode_that_held_before_is_no_sign_of_the_pilot(
        self, instruction: Instruction, mode: FlightMode
    ) -> None:
        assert seen(instruction, mode, before=mode) is not PILOT

    @pytest.mark.parametrize("instruction", UNDER_WAY)
    @pytest.mark.parametrize("mode", [MODE.ATTI, MODE.ATTI_COURSE_LOCK])
    @pytest.mark.parametrize(
        ("gnss", "verdict"), [(5, PILOT), (3, PILOT), (2, UNDECIDED), (None, UNDECIDED)]
    )
    def test_atti_is_the_pilots_while_gnss_is_good(
        self, instruction: Instruction, mode: FlightMode, gnss: int | None, verdict: Verdict
    ) -> None:
        assert seen(instruction, mode, gnss=gnss) is verdict

    def test_hovering_instead_of_landing_or_going_home_is_the_pilot(self) -> None:
        assert seen(Instruction.LAND, MODE.GPS_ATTI) is PILOT
        assert seen(Instruction.RETURN, MODE.GPS_ATTI) is PILOT
        assert seen(Instruction.STICK, MODE.GPS_ATTI) is PILOT

    def test_before_an_order_shows_position_mode_is_undecided(self) -> None:
        for instruction in (
            Instruction.LAND_SENT,
            Instruction.RETURN_SENT,
            Instruction.STICK_SENT,
            Instruction.MISSION_SENT,
        ):
            assert seen(instruction, MODE.GPS_ATTI) is UNDECIDED

    def test_a_hold_that_moved_away_was_moved(self) -> None:
        assert seen(Instruction.HOLD, MODE.GPS_ATTI, END) is C
        assert seen(Instruction.HOLD, MODE.GPS_ATTI, before=MODE.GPS_ATTI) is PILOT
        assert seen(Instruction.HOLD, MODE.JOYSTICK, before=MODE.JOYSTICK) is UNDECIDED

    def test_only_modes_of_the_pilots_own_count_at_once(self) -> None:
        assert not read(Instruction.MISSION, MODE.GPS_ATTI, 4, ELSEWHERE).is_at_once
        assert not read(Instruction.MISSION, MODE.GO_HOME, 4, ELSEWHERE).is_at_once
        assert read(Instruction.MISSION, MODE.ATTI, 4, ELSEWHERE).is_at_once


class TestOrders:
    def test_a_hold_is_carried_out_outside_of_missions_ways_home_landings_and_sticks(self) -> None:
        for mode in (MODE.GPS_WAYPOINT, MODE.GO_HOME, MODE.AUTO_LANDING, MODE.JOYSTICK):
            assert seen(Instruction.HOLD_SENT, mode, END) is UNDECIDED
        for mode in (MODE.GPS_ATTI, MODE.GPS_NOVICE, MODE.OTHER):
            assert seen(Instruction.HOLD_SENT, mode, END) is C

    def test_a_mission_that_begins_while_a_stop_is_sent_does_not_end_the_stop(self) -> None:
        assert seen(Instruction.HOLD_SENT, MODE.GPS_WAYPOINT) is UNDECIDED
        assert seen(Instruction.HOLD, MODE.GPS_WAYPOINT) is PILOT

    def test_a_return_lands_and_a_landing_does_not_return(self) -> None:
        assert seen(Instruction.RETURN_SENT, MODE.GO_HOME) is C
        assert seen(Instruction.RETURN_SENT, MODE.AUTO_LANDING) is UNDECIDED
        assert seen(Instruction.RETURN, MODE.AUTO_LANDING) is C
        assert seen(Instruction.LAND_SENT, MODE.CONFIRM_LANDING) is C
        assert seen(Instruction.LAND, MODE.GO_HOME) is FAILSAFE

    @pytest.mark.parametrize(
        "instruction",
        [Instruction.LAND, Instruction.RETURN, Instruction.LAND_SENT, Instruction.RETURN_SENT],
    )
    @pytest.mark.parametrize("mode", [MODE.GPS_ATTI, MODE.AUTO_LANDING, MODE.UNKNOWN])
    def test_the_ground_ends_them(self, instruction: Instruction, mode: FlightMode) -> None:
        assert seen(instruction, mode, DOWN) is F

    @pytest.mark.parametrize("instruction", Instruction)
    @pytest.mark.parametrize("mode", [MODE.UNKNOWN, MODE.OTHER])
    def test_an_unknown_mode_is_never_a_takeover_in_the_air(
        self, instruction: Instruction, mode: FlightMode
    ) -> None:
        assert seen(instruction, mode) in (UNDECIDED, C)

    @pytest.mark.parametrize("instruction", Instruction)
    @pytest.mark.parametrize("place", Place)
    def test_no_mode_is_no_verdict(self, instruction: Instruction, place: Place) -> None:
        assert seen(instruction, None, place) is UNDECIDED

    def test_without_an_instruction_only_pilot_modes_give_a_verdict(self) -> None:
        for mode, place in product(FlightMode, (END, ELSEWHERE)):
            is_pilots = kind_of(mode, 4) in (ModeKind.PILOT, ModeKind.ATTI_GOOD)
            assert seen(Instruction.NOTHING, mode, place) is (PILOT if is_pilots else UNDECIDED)
