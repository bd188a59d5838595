"""Telemetry at the limits of trust: at each limit it is believed, just beyond it is not."""

from dataclasses import replace

import pytest
from tests.fleet.reports import PLACE, S, extended

from recon.fleet.settings import FleetSettings, TrustSettings
from recon.fleet.telemetry import fold_core, fold_extended
from recon.fleet.trust import after_gap, is_backlog, judge_core, merged_trust, with_doubt
from recon.geo.distance import horizontal_distance_m, moved_m
from recon.model.geo import LatLon
from recon.model.report import CoreReport
from recon.model.trust import (
    DeadReckoning,
    Doubt,
    DoubtKind,
    FlightEvidence,
    GroundReports,
    GroundStand,
    JumpedPlace,
    KnownPlace,
    Trust,
)
from recon.model.units import Stamped
from recon.model.vehicle import Attitude, VehicleState, VelocityNed

START_NS = 1_000 * S
STILL = (0.0, 0.0, 0.0)
FROZEN = "its telemetry is frozen: the same values arrive again and again. Restart its app"
STAYS = "its position and height stay where they jumped to"
NOT_BELIEVED = "not believed. Check its position on its controller"


class Packets:
    """One vehicle's core packets at exact times; a packet jitters unless it is `same`."""

    def __init__(self, *, settings: TrustSettings | None = None, **first: object) -> None:
        self.settings = FleetSettings(trust=settings or TrustSettings())
        self.now_ns, self.number = START_NS, 0
        self.state = VehicleState(serial="A", link_id=1)
        self.last = self.report(**first)
        self.receives(0.0, **first)

    def report(
        self,
        north_m: float = 0.0,
        height_m: float | None = 40.0,
        velocity: tuple[float, float, float] | None = STILL,
        *,
        flying: bool | None = True,
        place: LatLon | None = PLACE,
        attitude: bool = True,
    ) -> CoreReport:
        self.number += 1
        return CoreReport(
            is_flying=flying,
            position=None if place is None else moved_m(place, north_m, 0.0),
            reported_altitude_m=300.0,
            height_above_takeoff_m=height_m,
            velocity_ned=None if velocity is None else VelocityNed(*velocity),
            attitude=Attitude(0.0, 0.0, self.number / 1000.0) if attitude else None,
        )

    def receives(self, after_s: float, **values: object) -> "Packets":
        self.last = self.report(**values)  # type: ignore[arg-type]
        return self.again(after_s)

    def again(self, after_s: float) -> "Packets":
        """The same packet once more."""
        self.now_ns += round(after_s * S)
        self.state = fold_core(self.state, self.last, self.now_ns, self.settings)
        return self

    @property
    def is_believed(self) -> bool:
        return self.state.core_received_at_ns == self.now_ns

    @property
    def texts(self) -> list[str]:
        return [doubt.text for doubt in self.state.trust.doubts if doubt.until_ns > self.now_ns]


class TestJumps:
    """Half a second after the last packet 22.5 m and 11 m up or down are possible."""

    @pytest.mark.parametrize(("north_m", "is_jump"), [(22.4, False), (22.6, True), (-22.6, True)])
    def test_by_a_distance(self, north_m: float, is_jump: bool) -> None:
        packets = Packets().receives(0.5, north_m=north_m)
        assert packets.is_believed is not is_jump
        assert packets.texts == [f"its position jumped by 23 m; {NOT_BELIEVED}"] * is_jump

    def test_exactly_as_far_as_it_can_fly(self) -> None:
        far_m = horizontal_distance_m(PLACE, moved_m(PLACE, 20.0, 0.0))
        settings = TrustSettings(jump_m=far_m - 12.5)
        assert Packets(settings=settings).receives(0.5, north_m=20.0).is_believed

    @pytest.mark.parametrize(
        ("height_m", "is_jump"), [(51.0, False), (51.6, True), (29.0, False), (28.4, True)]
    )
    def test_by_a_height(self, height_m: float, is_jump: bool) -> None:
        packets = Packets().receives(0.5, height_m=height_m)
        assert packets.is_believed is not is_jump
        text = f"its height jumped from 40 m to {height_m:.0f} m; {NOT_BELIEVED}"
        assert packets.texts == [text] * is_jump

    @pytest.mark.parametrize(
        ("after_s", "north_m", "up_m"), [(0.05, 11.25, 5.6), (0.04, 48.5, 23.48)]
    )
    def test_packets_of_a_burst_may_be_missing(
        self, after_s: float, north_m: float, up_m: float
    ) -> None:
        assert Packets().receives(after_s, north_m=north_m - 0.05).is_believed
        assert not Packets().receives(after_s, north_m=north_m + 0.05).is_believed
        assert Packets().receives(after_s, height_m=39.95 + up_m).is_believed
        assert not Packets().receives(after_s, height_m=40.05 + up_m).is_believed

    def test_the_allowance_grows_while_the_value_is_unknown(self) -> None:
        """Position and height each from the time when it was known last."""
        for north_m, is_believed in ((59.9, True), (60.1, False)):
            blind = Packets().receives(1.0, place=None, height_m=41.0)
            assert blind.state.trust.place == KnownPlace(
                moved_m(PLACE, 0.0, 0.0), START_NS, 41.0, START_NS + S
            )
            blind.receives(1.0, north_m=north_m)
            assert blind.is_believed is is_believed
        for height_m, is_believed in ((68.9, True), (69.1, False)):
            high = Packets().receives(1.0, north_m=5.0, height_m=None)
            assert high.state.trust.place == KnownPlace(
                moved_m(PLACE, 5.0, 0.0), START_NS + S, 40.0, START_NS
            )
            assert high.receives(1.0, height_m=height_m).is_believed is is_believed

    def test_heights_may_jump_only_where_it_is_known_to_stand(self) -> None:
        stands = Packets(flying=False, height_m=40.0)
        assert stands.receives(0.5, flying=False, height_m=0.0).is_believed
        perhaps = Packets(flying=None, height_m=40.0)
        assert not perhaps.receives(0.5, flying=None, height_m=0.0).is_believed

    @pytest.mark.parametrize(("flies_m", "is_believed"), [(0.0, True), (6.9, True), (7.1, False)])
    def test_a_packet_nearer_to_the_jump_belongs_to_it(
        self, flies_m: float, is_believed: bool
    ) -> None:
        """14 m off in 0.1 s; 0.1 s later its allowance would take in the rest without a word."""
        packets = Packets().receives(0.1, north_m=14.0)
        assert not packets.is_believed
        packets.receives(0.1, north_m=flies_m)
        assert packets.is_believed is is_believed
        assert (packets.state.trust.jumped is None) is is_believed
        why = "its position jumped by 14 m" if is_believed else STAYS
        assert packets.texts == [f"{why}; {NOT_BELIEVED}"]

    def test_half_way_back_it_is_believed(self) -> None:
        packets = Packets().receives(0.1, height_m=54.0)
        assert not packets.is_believed
        assert packets.receives(0.5, height_m=47.0).is_believed
        packets = Packets().receives(0.1, height_m=26.0)
        assert packets.receives(0.5, height_m=33.0).is_believed

    def test_height_and_distance_count_together(self) -> None:
        """3 m beside the track and 8 m from its height, or 8 m beside and 3 m from the jump's."""
        packets = Packets().receives(0.1, height_m=51.0)
        assert packets.receives(0.5, height_m=48.0, north_m=8.0).is_believed is False
        packets = Packets().receives(0.1, height_m=51.0)
        assert packets.receives(0.5, height_m=43.0, north_m=8.0).is_believed

    def test_what_is_unknown_counts_on_neither_side(self) -> None:
        """Half way: neither side is nearer, wherever a value is missing on one of them."""
        here = moved_m(PLACE, 0.0, 0.0)

        def after(track: KnownPlace, off: KnownPlace, **values: object) -> bool:
            packets = Packets()
            trust = replace(packets.state.trust, place=track, jumped=JumpedPlace(off, START_NS))
            packets.state = replace(packets.state, trust=trust)
            return packets.receives(0.5, **values).is_believed

        at_ns = START_NS
        low, high = KnownPlace(here, at_ns, 40.0, at_ns), KnownPlace(here, at_ns, 54.0, at_ns)
        assert after(replace(low, position=None), high, height_m=47.0)
        assert after(low, replace(high, position=None), height_m=47.0)
        north = KnownPlace(moved_m(here, 14.0, 0.0), at_ns, 40.0, at_ns)
        south = KnownPlace(moved_m(here, -14.0, 0.0), at_ns, 40.0, at_ns)
        assert after(replace(south, height_m=None), north, north_m=-0.01)
        assert not after(replace(south, height_m=None), north, north_m=0.01)
        assert not after(south, replace(north, height_m=None), north_m=0.01)
        assert after(south, replace(north, height_m=None), north_m=-0.01)
        assert after(low, high, place=None, height_m=46.9)
        assert after(south, north, height_m=None, north_m=-0.01)

    def test_a_run_is_accepted_after_2_s_and_5_packets(self) -> None:
        packets = Packets().receives(0.5, north_m=60.0)
        for _ in range(3):
            assert not packets.receives(0.5, north_m=60.0).is_believed
        early = packets.state
        assert packets.receives(0.5, north_m=60.0).is_believed
        assert packets.texts == [f"{STAYS}; accepted after 2 s. Check its position before it moves"]
        assert packets.state.trust.jump_accepted_at_ns == packets.now_ns
        assert packets.state.trust.jumped is None
        (doubt,) = packets.state.trust.doubts
        assert doubt.until_ns == packets.now_ns + 60 * S
        before_2_s = fold_core(early, packets.last, packets.now_ns - 1, packets.settings)
        assert before_2_s.core_received_at_ns == START_NS
        rare = Packets().receives(1.0, north_m=90.0)
        for _ in range(3):
            assert not rare.receives(1.0, north_m=90.0).is_believed
        assert rare.receives(1.0, north_m=90.0).is_believed

    def test_one_that_jumps_again_begins_a_new_run(self) -> None:
        for values in ({"north_m": 160.0}, {"north_m": 60.0, "height_m": 70.0}):
            packets = Packets().receives(0.5, north_m=60.0).receives(0.5, north_m=60.0)
            jumped = packets.state.trust.jumped
            assert jumped is not None
            assert (jumped.since_ns, jumped.count) == (START_NS + S // 2, 2)
            jumped = packets.receives(0.5, **values).state.trust.jumped
            assert jumped is not None
            assert (jumped.since_ns, jumped.count) == (packets.now_ns, 1)

    def test_its_values_are_new(self) -> None:
        packets = Packets().receives(0.5, north_m=60.0)
        assert packets.state.trust.changed_at_ns == packets.now_ns

    def test_a_jump_ends_dead_reckoning(self) -> None:
        north = {"velocity": (4.0, 0.0, 0.0)}
        packets = Packets(**north).receives(0.5, **north)
        assert packets.state.trust.reckoning is not None
        assert packets.receives(0.5, north_m=60.0, **north).state.trust.reckoning is None
        for _ in range(4):
            packets.receives(0.5, north_m=60.0, **north)
        assert packets.is_believed
        assert packets.state.trust.reckoning is None

    @pytest.mark.parametrize(
        ("was", "reports", "becomes"),
        [
            (False, True, None),
            (False, None, None),
            (False, False, False),
            (True, False, True),
            (True, True, True),
            (None, True, None),
        ],
    )
    def test_a_jumped_packet_may_be_right_that_it_took_off(
        self, was: bool | None, reports: bool | None, becomes: bool | None
    ) -> None:
        packets = Packets(flying=was).receives(0.5, flying=reports, north_m=500.0)
        assert not packets.is_believed
        assert packets.state.is_flying == Stamped(becomes, START_NS)


class TestFrozen:
    @pytest.mark.parametrize(
        ("velocity", "after_s"),
        [((0.3, 0.0, 0.0), 1.0), ((0.29, 0.0, 0.0), 5.0), (STILL, 5.0), (None, 5.0)],
    )
    def test_after_1_s_of_motion_and_5_s_of_none(
        self, velocity: tuple[float, float, float] | None, after_s: float
    ) -> None:
        packets = Packets(velocity=velocity)
        assert packets.again(after_s - 1e-9).is_believed
        assert packets.texts == []
        assert not packets.again(1e-9).is_believed
        assert packets.texts == [FROZEN]
        assert packets.state.core_received_at_ns == START_NS
        assert packets.state.trust.changed_at_ns == START_NS
        for name in ("position", "height_above_takeoff_m", "velocity_ned", "attitude"):
            assert getattr(packets.state, name).received_at_ns == START_NS, name
        assert packets.state.is_flying == Stamped(True, START_NS)

    @pytest.mark.parametrize(
        "alone", [{"place": None, "velocity": None}, {"place": None, "attitude": False}]
    )
    def test_each_value_alone_can_be_frozen(self, alone: dict[str, object]) -> None:
        assert not Packets(**alone).again(5.0).is_believed
        assert not Packets(velocity=None, attitude=False).again(5.0).is_believed

    def test_values_that_stand_still_show_no_landing(self) -> None:
        packets = Packets().receives(0.5, flying=False)
        assert packets.state.trust.evidence.slow_since_ns == packets.now_ns
        assert packets.again(0.5).is_believed
        assert packets.state.trust.evidence.slow_since_ns is None

    def test_without_a_value_that_could_change_nothing_is(self) -> None:
        packets = Packets(place=None, velocity=None, attitude=False)
        assert packets.again(60.0).is_believed

    @pytest.mark.parametrize(
        "change", [{"north_m": 0.01}, {"height_m": 40.1}, {"velocity": (0.0, 0.1, 0.0)}]
    )
    def test_a_change_of_any_value_is_new(self, change: dict[str, object]) -> None:
        packets = Packets(attitude=False)
        assert packets.receives(6.0, attitude=False, **change).is_believed
        assert packets.state.trust.changed_at_ns == packets.now_ns

    def test_values_of_an_older_packet_are_not_made_newer(self) -> None:
        """Core telemetry received before the values changed keeps its time, or none."""
        packets = Packets()
        for received_ns in (None, START_NS - S):
            state = replace(packets.state, core_received_at_ns=received_ns)
            after = judge_core(state, packets.last, START_NS + 5 * S, packets.settings)
            assert after.belief is None
            assert after.state.core_received_at_ns == received_ns


class TestAPositionThatStandsStill:
    """The velocity adds up: 5 m/s towards north and east, 2.5 m in half a second."""

    NORTH_EAST = (3.0, 4.0, 0.0)

    def packets(self, count: int, velocity: tuple[float, float, float] = NORTH_EAST) -> Packets:
        packets = Packets(velocity=velocity)
        for _ in range(count):
            packets.receives(0.5, velocity=velocity)
        return packets

    def test_beyond_20_m_it_is_not_telemetry(self) -> None:
        assert self.packets(8).is_believed
        packets = self.packets(9)
        assert not packets.is_believed
        text = (
            "its velocity adds up to 22 m while its position stands still; not believed. "
            "Restart its app"
        )
        assert packets.texts == [text]
        assert packets.state.trust.changed_at_ns == packets.now_ns
        assert packets.state.trust.reckoning == DeadReckoning(
            moved_m(PLACE, 0.0, 0.0), packets.now_ns, 13.5, 18.0
        )

    def test_below_half_a_metre_a_second_it_is_noise(self) -> None:
        slow = self.packets(2, (0.3, 0.4, 0.0)).state.trust.reckoning
        assert slow is not None
        assert slow.north_m == pytest.approx(0.3)
        assert self.packets(2, (0.3, 0.39, 0.0)).state.trust.reckoning is None

    def test_a_gap_of_more_than_1_s_begins_anew(self) -> None:
        packets = self.packets(2)
        reckoning = packets.receives(1.0, velocity=self.NORTH_EAST).state.trust.reckoning
        assert reckoning is not None
        assert (reckoning.north_m, reckoning.east_m) == (6.0, 8.0)
        reckoning = packets.receives(1.001, velocity=self.NORTH_EAST).state.trust.reckoning
        assert reckoning == DeadReckoning(moved_m(PLACE, 0.0, 0.0), packets.now_ns)

    def test_a_move_of_more_than_3_m_begins_anew(self) -> None:
        far_m = horizontal_distance_m(moved_m(PLACE, 0.0, 0.0), moved_m(PLACE, 3.0, 0.0))
        for stands_m, is_new in ((far_m, False), (far_m - 0.01, True)):
            packets = Packets(settings=TrustSettings(stands_m=stands_m), velocity=self.NORTH_EAST)
            packets.receives(0.5, velocity=self.NORTH_EAST)
            packets.receives(0.5, velocity=self.NORTH_EAST, north_m=3.0)
            reckoning = packets.state.trust.reckoning
            assert reckoning is not None
            assert (reckoning.north_m == 0.0) is is_new
            assert (reckoning.position == moved_m(PLACE, 3.0, 0.0)) is is_new

    @pytest.mark.parametrize("unknown", [{"place": None}, {"velocity": None}])
    def test_what_is_unknown_ends_it(self, unknown: dict[str, object]) -> None:
        values = {"velocity": self.NORTH_EAST, **unknown}
        assert self.packets(2).receives(0.5, **values).state.trust.reckoning is None


class Charges:
    """The charges that one vehicle reports in flight, at exact times."""

    def __init__(self, charge: float | None, *, flying: bool | None = True, **settings: float):
        self.settings = FleetSettings(trust=TrustSettings(**settings))  # type: ignore[arg-type]
        self.now_ns = START_NS
        self.state = VehicleState(serial="A", link_id=1, is_flying=Stamped(flying, START_NS))
        self.reports(0.0, charge)

    def reports(self, after_s: float, charge: float | None) -> "Charges":
        self.now_ns += round(after_s * S)
        report = extended(battery=charge)
        self.state = fold_extended(self.state, report, self.now_ns, self.settings)
        return self

    @property
    def used(self) -> float | None:
        return self.state.battery_fraction.value

    @property
    def text(self) -> str | None:
        doubt = self.state.trust.doubt(DoubtKind.BATTERY)
        return None if doubt is None else doubt.text


class TestBattery:
    def test_a_rise_of_more_than_a_tenth(self) -> None:
        charges = Charges(0.5).reports(1.0, 0.6)
        assert (charges.used, charges.text) == (0.6, None)
        charges = Charges(0.5).reports(1.0, 0.61)
        assert charges.used == 0.5
        assert charges.text == "its battery rose from 50% to 61% in flight; 50% is used"
        (doubt,) = charges.state.trust.doubts
        assert doubt.until_ns == charges.now_ns + 3 * S

    def test_it_rises_from_the_greatest_charge_of_the_last_seconds(self) -> None:
        assert Charges(0.5).reports(1.0, 0.4).reports(1.0, 0.59).used == 0.59
        assert Charges(0.5).reports(1.0, 0.58).reports(1.0, 0.67).used == 0.67
        assert Charges(0.5).reports(1.0, 0.58).reports(1.0, 0.69).used == 0.58

    def test_a_fall_of_more_than_a_fifth(self) -> None:
        exact = {"battery_fall_fraction": 0.25}
        charges = Charges(0.75, **exact).reports(1.0, 0.5)
        assert (charges.used, charges.text) == (0.5, None)
        charges = Charges(0.75, **exact).reports(1.0, 0.49)
        assert charges.used == 0.49
        assert charges.text == (
            "its battery fell from 75% to 49% within 10 s; 49% is used. Land it soon"
        )
        (doubt,) = charges.state.trust.doubts
        assert doubt.until_ns == charges.now_ns + 3 * S

    def test_a_fall_in_steps_is_compared_with_the_first_charge_and_one_at_once_with_the_last(
        self,
    ) -> None:
        steps = Charges(0.75).reports(4.0, 0.65).reports(4.0, 0.5)
        assert steps.state.trust.battery == Stamped(0.75, START_NS + 4 * S)
        assert steps.text is not None
        falls = Charges(0.75).reports(4.0, 0.74).reports(4.0, 0.5)
        assert falls.state.trust.battery == Stamped(0.74, falls.now_ns)
        exact = Charges(0.875, battery_fall_fraction=0.25).reports(4.0, 0.75).reports(4.0, 0.5)
        assert exact.state.trust.battery == Stamped(0.875, START_NS + 4 * S)
        assert exact.text is not None

    @pytest.mark.parametrize(("after_s", "is_kept"), [(10.0, True), (10.001, False)])
    def test_the_first_charge_counts_for_10_s(self, after_s: float, is_kept: bool) -> None:
        charges = Charges(0.75).reports(1.0, 0.70)
        assert charges.state.trust.battery == Stamped(0.75, START_NS + S)
        charges.reports(after_s, 0.69)
        expected = Stamped(0.75, START_NS + S) if is_kept else Stamped(0.70, charges.now_ns)
        assert charges.state.trust.battery == expected

    @pytest.mark.parametrize("first", [Stamped(0.95, None), Stamped(None, START_NS)])
    def test_without_a_first_charge_the_last_one_counts(self, first: Stamped[float]) -> None:
        charges = Charges(0.5)
        trust = replace(charges.state.trust, battery=first)
        charges.state = replace(charges.state, trust=trust)
        assert charges.reports(1.0, 0.61).used == 0.5
        assert charges.state.trust.battery == Stamped(0.5, charges.now_ns)

    @pytest.mark.parametrize(("gap_s", "used"), [(15.0, 0.2), (15.001, 0.9)])
    def test_in_a_gap_of_more_than_15_s_it_may_be_another_battery(
        self, gap_s: float, used: float
    ) -> None:
        charges = Charges(0.2).reports(gap_s, 0.9)
        assert charges.used == used
        if used == 0.9:
            assert charges.state.trust.battery == Stamped(0.9, charges.now_ns)

    def test_on_the_ground_any_charge_is_believed(self) -> None:
        charges = Charges(0.2, flying=False).reports(1.0, 0.9)
        assert charges.used == 0.9
        assert charges.state.trust.battery == Stamped(0.9, charges.now_ns)
        assert Charges(0.2, flying=None).reports(1.0, 0.9).used == 0.2

    def test_an_unknown_charge_is_no_fall(self) -> None:
        charges = Charges(0.9).reports(1.0, None)
        assert charges.used is None
        charges.reports(1.0, 0.2)
        assert (charges.used, charges.text) == (0.2, None)

    def test_without_a_time_of_the_charge_before_nothing_is_compared(self) -> None:
        charges = Charges(0.2)
        charges.state = replace(charges.state, extended_received_at_ns=None)
        assert charges.reports(1.0, 0.9).used == 0.9


class TestDoubts:
    def test_the_first_time_is_kept_while_it_lasts(self) -> None:
        trust = with_doubt(Trust(), DoubtKind.JUMP, "one", 10, 3e-9)
        assert trust.doubts == (Doubt(DoubtKind.JUMP, "one", 10, 10, 13, 1),)
        again = with_doubt(trust, DoubtKind.JUMP, "two", 12, 3e-9)
        assert again.doubts == (Doubt(DoubtKind.JUMP, "two", 10, 12, 15, 2),)
        ended = with_doubt(trust, DoubtKind.JUMP, "two", 13, 3e-9)
        assert ended.doubts == (Doubt(DoubtKind.JUMP, "two", 13, 13, 16, 1),)
        other = with_doubt(trust, DoubtKind.BATTERY, "two", 12, 3e-9)
        assert [doubt.kind for doubt in other.doubts] == [DoubtKind.JUMP, DoubtKind.BATTERY]

    def test_one_that_has_ended_is_forgotten_with_the_next_packet(self) -> None:
        settings = TrustSettings(lingers_s=1.0)
        packets = Packets(settings=settings).receives(0.5, north_m=60.0)
        assert len(packets.receives(0.999_999_999).state.trust.doubts) == 1
        assert packets.receives(1e-9).state.trust.doubts == ()

    @pytest.mark.parametrize(
        ("flying", "height_m", "where"),
        [(True, 40.0, "at 40 m height"), (None, None, "at an unknown height")],
    )
    def test_a_report_of_the_ground_without_a_landing(
        self, flying: bool | None, height_m: float | None, where: str
    ) -> None:
        packets = Packets(height_m=40.0)
        for _ in range(3):
            packets.receives(1.0, flying=False, height_m=height_m)
        treated = "as flying" if flying else "as possibly in flight"
        assert packets.state.is_flying.value is flying
        assert packets.texts == [
            f"reports on the ground {where}, and no landing was seen; treated {treated}. "
            "Check it, and restart its app"
        ]
        (doubt,) = packets.state.trust.doubts
        assert (doubt.kind, doubt.until_ns) == (
            DoubtKind.GROUND_REPORT,
            packets.now_ns + 3 * S,
        )

    def test_signs_of_flight_on_the_ground(self) -> None:
        moves = {"flying": False, "velocity": (3.0, 0.0, 0.0)}
        packets = Packets(flying=False, height_m=0.0)
        for number in range(1, 4):
            packets.receives(0.5, height_m=0.0, north_m=1.5 * number, **moves)
        assert packets.state.is_flying.value is None
        assert packets.texts == [
            "reports on the ground, but shows signs of flight at 0 m height; treated as possibly "
            "in flight. Check it, and restart its app"
        ]
        assert packets.state.trust.doubts[0].kind is DoubtKind.FLIGHT_SIGNS


class TestAfterAGap:
    def test_nothing_counts_for_a_second(self) -> None:
        packets = Packets()
        jumped = replace(
            packets.state.trust,
            jumped=JumpedPlace(KnownPlace(), START_NS),
            reckoning=DeadReckoning(PLACE, START_NS),
        )
        state = after_gap(replace(packets.state, trust=jumped), START_NS, TrustSettings())
        assert state.trust == replace(packets.state.trust, not_before_ns=START_NS + S)
        assert is_backlog(state, START_NS + S - 1)
        assert not is_backlog(state, START_NS + S)
        assert not is_backlog(packets.state, START_NS)
        late = judge_core(state, packets.report(), START_NS + S - 1, packets.settings)
        assert (late.state, late.belief) == (state, None)


class TestAnotherLink:
    """A link with newer telemetry takes the vehicle over."""

    STAND = GroundStand(START_NS + 5, START_NS + 9, PLACE, 40.0)
    FLOWN = FlightEvidence(flown_at_ns=START_NS, high_m=40.0, slow_since_ns=START_NS)

    def merged(
        self, flown: FlightEvidence, other: FlightEvidence
    ) -> tuple[Trust, Stamped[bool], Trust]:
        charge = Stamped(0.7, START_NS)
        doubts = (Doubt(DoubtKind.JUMP, "old", 1, 1, 1), Doubt(DoubtKind.FROZEN, "own", 1, 1, 1))
        newer = (Doubt(DoubtKind.JUMP, "new", 2, 2, 2),)
        old = VehicleState(serial="A", trust=Trust(doubts=doubts, evidence=flown))
        new = VehicleState(
            serial="A",
            trust=Trust(doubts=newer, evidence=other, changed_at_ns=7),
            battery_fraction=charge,
            is_flying=Stamped(False, 8),
        )
        trust, is_flying = merged_trust(old, new)
        assert trust.doubts == (newer[0], doubts[1])
        assert trust.changed_at_ns == 7
        return trust, is_flying, new.trust

    def test_its_report_of_the_ground_is_no_landing_yet(self) -> None:
        trust, is_flying, _ = self.merged(self.FLOWN, FlightEvidence(ground=self.STAND))
        assert is_flying == Stamped(None, 8)
        reports = GroundReports(START_NS + 5, START_NS + 5, 40.0, 0.7)
        assert trust.evidence == replace(self.FLOWN, reports=reports, slow_since_ns=None)

    def test_otherwise_the_newer_one_is_believed(self) -> None:
        for flown, other in (
            (self.FLOWN, self.FLOWN),
            (FlightEvidence(), FlightEvidence(ground=self.STAND)),
        ):
            trust, is_flying, new = self.merged(flown, other)
            assert is_flying == Stamped(False, 8)
            assert trust.evidence == new.evidence
