"""The estimate of flight at its limits, packet by packet, from evidence made for the test."""

from dataclasses import replace

import pytest
from tests.fleet.reports import PLACE, S, core

from recon.fleet.airborne import AirborneBelief, believe, flown
from recon.fleet.settings import AirborneSettings
from recon.geo.distance import horizontal_distance_m, moved_m
from recon.model.report import CoreReport
from recon.model.trust import FlightEvidence, GroundReports, GroundStand, KnownPlace, Trust
from recon.model.units import Stamped
from recon.model.vehicle import FlightMode, VehicleState

NOW = 1_000 * S
SETTINGS = AirborneSettings()
AWAY = moved_m(PLACE, 500.0, 0.0)


def ago(seconds: float) -> int:
    return NOW - round(seconds * S)


def vehicle(
    evidence: FlightEvidence,
    *,
    flying: bool | None = True,
    charge: Stamped[float] = Stamped(0.6, NOW),
    mode: Stamped[FlightMode] = Stamped(FlightMode.GPS_ATTI, NOW),
    home: bool = True,
    last_height_m: float | None = None,
) -> VehicleState:
    place = KnownPlace(height_m=last_height_m)
    return VehicleState(
        serial="A",
        link_id=1,
        is_flying=Stamped(flying, ago(0.1)),
        battery_fraction=charge,
        flight_mode=mode,
        takeoff_point=PLACE if home else None,
        trust=Trust(evidence=evidence, place=place),
    )


def ground(
    height_m: float | None = 40.0,
    velocity: tuple[float, float, float] | None = (0.0, 0.0, 0.0),
    **values: object,
) -> CoreReport:
    return core(flying=False, height_m=height_m, velocity=velocity, **{"position": AWAY, **values})  # type: ignore[arg-type]


def after(state: VehicleState, report: CoreReport, **settings: float) -> AirborneBelief:
    return believe(state, report, NOW, replace(SETTINGS, **settings))  # type: ignore[arg-type]


class TestReportedInFlight:
    BEFORE = FlightEvidence(
        flown_at_ns=ago(0.1),
        flown_height_m=39.0,
        battery_fraction=0.7,
        high_m=50.0,
        older_high_m=60.0,
        high_since_ns=ago(10.0),
        slow_since_ns=5,
        reports=GroundReports(1, 2, 3.0, 0.5),
    )

    def evidence(
        self, before: FlightEvidence, height_m: float | None, mode: FlightMode | None = None
    ) -> FlightEvidence:
        state = vehicle(before, mode=Stamped(mode or FlightMode.GPS_ATTI, NOW))
        belief = after(state, core(height_m=height_m))
        assert belief.is_flying is True
        return belief.evidence

    @pytest.mark.parametrize(
        ("before", "height_m", "highs"),
        [
            (FlightEvidence(high_m=9.0, older_high_m=8.0), 40.0, (40.0, None, NOW)),
            (BEFORE, 40.0, (50.0, 60.0, ago(10.0))),
            (BEFORE, 50.5, (50.5, 60.0, ago(10.0))),
            (BEFORE, None, (50.0, 60.0, ago(10.0))),
            (replace(BEFORE, high_m=None), 40.0, (40.0, 60.0, ago(10.0))),
            (replace(BEFORE, high_since_ns=ago(30.0) + 1), 40.0, (50.0, 60.0, ago(30.0) + 1)),
            (replace(BEFORE, high_since_ns=ago(30.0)), 40.0, (40.0, 50.0, NOW)),
        ],
    )
    def test_the_greatest_height_of_this_half_minute_and_the_last(
        self,
        before: FlightEvidence,
        height_m: float | None,
        highs: tuple[float | None, float | None, int],
    ) -> None:
        found = self.evidence(before, height_m)
        assert (found.high_m, found.older_high_m, found.high_since_ns) == highs

    def test_the_whole_evidence(self) -> None:
        assert self.evidence(self.BEFORE, 40.0) == FlightEvidence(
            flown_at_ns=NOW,
            flown_height_m=40.0,
            battery_fraction=0.6,
            high_m=50.0,
            older_high_m=60.0,
            high_since_ns=ago(10.0),
        )

    @pytest.mark.parametrize(
        ("mode", "landing_s", "from_m", "height_m", "found"),
        [
            (FlightMode.AUTO_LANDING, None, None, 40.0, (NOW, 40.0)),
            (FlightMode.CONFIRM_LANDING, 0.1, 45.0, 40.0, (NOW, 45.0)),
            (FlightMode.AUTO_LANDING, 0.1, 39.0, 40.0, (NOW, 40.0)),
            (FlightMode.AUTO_LANDING, 0.1, 45.0, None, (NOW, 45.0)),
            (FlightMode.AUTO_LANDING, None, None, None, (NOW, None)),
            (FlightMode.GPS_ATTI, 1.5, 45.0, 40.0, (ago(1.5), 45.0)),
            (FlightMode.GPS_ATTI, 1.500000001, 45.0, 40.0, (None, None)),
            (FlightMode.GPS_ATTI, None, None, 40.0, (None, None)),
        ],
    )
    def test_the_landing_that_it_may_be_in(
        self,
        mode: FlightMode,
        landing_s: float | None,
        from_m: float | None,
        height_m: float | None,
        found: tuple[int | None, float | None],
    ) -> None:
        at_ns = None if landing_s is None else ago(landing_s)
        before = replace(self.BEFORE, landing_at_ns=at_ns, landing_from_m=from_m)
        evidence = self.evidence(before, height_m, mode)
        assert (evidence.landing_at_ns, evidence.landing_from_m) == found

    def test_after_the_ground_it_is_a_takeoff(self) -> None:
        stood = FlightEvidence(ground=GroundStand(ago(9.0), ago(0.1), PLACE, 0.0))
        belief = after(vehicle(stood, flying=False), core(position=AWAY))
        assert belief == AirborneBelief(True, belief.evidence, True, AWAY, is_doubted=False)
        assert belief.evidence.ground is None
        again = after(vehicle(belief.evidence), core(position=AWAY))
        assert (again.takes_off, again.home) == (False, None)

    @pytest.mark.parametrize(
        ("gap_s", "stood", "here", "home"),
        [
            (1.0, PLACE, AWAY, AWAY),
            (1.0, PLACE, None, PLACE),
            (1.000000001, PLACE, AWAY, PLACE),
            (60.0, PLACE, AWAY, PLACE),
            (60.000000001, PLACE, AWAY, None),
            (61.0, None, AWAY, AWAY),
            (61.0, None, None, None),
        ],
    )
    def test_home_after_a_gap(self, gap_s, stood, here, home) -> None:  # type: ignore[no-untyped-def]
        stand = FlightEvidence(ground=GroundStand(ago(900.0), ago(gap_s), stood, 0.0))
        assert after(vehicle(stand, flying=False), core(position=here)).home == home


def test_an_unknown_report_is_unknown_and_its_takeoff_is_not_seen() -> None:
    stood = FlightEvidence(flown_height_m=3.0, ground=GroundStand(ago(9.0), ago(0.1), PLACE, 0.0))
    belief = after(vehicle(stood, flying=False), core(flying=None))
    assert belief == AirborneBelief(None, FlightEvidence(flown_height_m=3.0))


def test_one_known_only_to_have_flown_is_not_landed_by_its_first_report() -> None:
    belief = after(vehicle(flown(ago(0.1))), ground())
    assert belief.is_flying is None
    assert belief.evidence.flown_at_ns == ago(0.1)


class TestALanding:
    """Reports of the ground for 1 s without motion; then one piece of evidence lands it."""

    REPORTS = GroundReports(ago(1.0), ago(1.0), 20.0, 0.6)
    FLOWN = FlightEvidence(
        flown_at_ns=ago(1.1),
        flown_height_m=20.0,
        high_m=80.0,
        slow_since_ns=ago(1.0),
        reports=REPORTS,
    )
    LANDS = replace(FLOWN, landing_at_ns=ago(1.2), landing_from_m=21.0)

    def lands(self, evidence: FlightEvidence, report: CoreReport, **changes: object) -> bool | None:
        return after(vehicle(evidence, **changes), report).is_flying  # type: ignore[arg-type]

    def test_it_leaves_only_where_it_stands(self) -> None:
        belief = after(vehicle(self.LANDS), ground(20.0))
        stand = GroundStand(NOW, NOW, AWAY, 20.0)
        assert belief == AirborneBelief(False, FlightEvidence(ground=stand))

    @pytest.mark.parametrize(("slow_s", "is_flying"), [(1.0, False), (0.999999999, None)])
    def test_after_a_second(self, slow_s: float, is_flying: bool | None) -> None:
        slow = replace(self.LANDS, slow_since_ns=ago(slow_s))
        assert self.lands(slow, ground(20.0)) is is_flying

    @pytest.mark.parametrize(
        ("velocity", "is_flying"),
        [((0.49, 0.0, 0.0), False), ((0.5, 0.0, 0.0), None), (None, None)],
    )
    def test_without_speed(
        self, velocity: tuple[float, float, float] | None, is_flying: bool | None
    ) -> None:
        belief = after(vehicle(self.LANDS), ground(20.0, velocity))
        assert belief.is_flying is is_flying
        if is_flying is None:
            assert belief.evidence.slow_since_ns is None

    def test_not_with_values_that_stand_still(self) -> None:
        belief = believe(vehicle(self.LANDS), ground(20.0), NOW, SETTINGS, is_changed=False)
        assert belief.is_flying is None
        assert belief.evidence.slow_since_ns is None

    def test_its_first_slow_report_begins_the_second(self) -> None:
        begins = after(vehicle(replace(self.LANDS, slow_since_ns=None)), ground(20.0))
        assert begins.evidence.slow_since_ns == NOW
        lasts = after(vehicle(replace(self.LANDS, slow_since_ns=ago(0.5))), ground(20.0))
        assert lasts.evidence.slow_since_ns == ago(0.5)

    @pytest.mark.parametrize(("height_m", "is_flying"), [(20.0, False), (20.1, None), (None, None)])
    def test_down_by_a_metre_in_a_landing_mode(
        self, height_m: float | None, is_flying: bool | None
    ) -> None:
        assert self.lands(self.LANDS, ground(height_m)) is is_flying
        moved = replace(self.REPORTS, has_moved=True)
        assert self.lands(replace(self.LANDS, reports=moved), ground(20.0)) is None
        assert self.lands(self.FLOWN, ground(20.0)) is None

    @pytest.mark.parametrize(
        ("height_m", "is_flying"), [(2.0, False), (-2.0, False), (2.1, None), (None, None)]
    )
    def test_near_its_takeoff_height(self, height_m: float | None, is_flying: bool | None) -> None:
        low = replace(self.FLOWN, reports=replace(self.REPORTS, height_m=0.5))
        assert self.lands(low, ground(height_m, position=PLACE)) is is_flying

    def test_near_its_takeoff_point(self) -> None:
        low = replace(self.FLOWN, reports=replace(self.REPORTS, height_m=0.5))
        there = moved_m(PLACE, 12.0, 0.0)
        far_m = horizontal_distance_m(PLACE, there)
        report = ground(0.0, position=there)
        assert after(vehicle(low), report, takeoff_radius_m=far_m).is_flying is False
        assert after(vehicle(low), report, takeoff_radius_m=far_m - 0.1).is_flying is None
        assert self.lands(low, ground(0.0, position=None)) is None

    @pytest.mark.parametrize(
        ("gap_s", "flown_m", "height_m", "is_flying"),
        [
            (5.0, 40.0, 0.0, False),
            (4.999999999, 40.0, 0.0, None),
            (5.0, 62.0, 2.0, False),
            (5.0, 62.1, 2.0, None),
            (5.1, 62.1, 2.0, False),
            (5.0, None, 2.0, False),
            (5.0, None, -1.0, False),
            (5.0, 40.0, 2.1, None),
            (5.0, 40.0, -2.0, False),
            (5.0, 40.0, None, None),
            (5.0, -40.0, 0.0, False),
        ],
    )
    def test_at_takeoff_height_after_a_gap(
        self,
        gap_s: float,
        flown_m: float | None,
        height_m: float | None,
        is_flying: bool | None,
    ) -> None:
        """Long enough to come down at 12 m/s; only while its takeoff point is unknown."""
        reports = replace(self.REPORTS, height_m=height_m)
        flown_ns = ago(1.0) - round(gap_s * S)
        gap = replace(self.FLOWN, flown_at_ns=flown_ns, flown_height_m=flown_m, reports=reports)
        assert self.lands(gap, ground(height_m), home=False) is is_flying
        assert self.lands(gap, ground(height_m), home=True) is None
        moved = replace(gap, reports=replace(reports, has_moved=True))
        assert self.lands(moved, ground(height_m), home=False) is None

    @pytest.mark.parametrize(
        ("gap_s", "before", "charge", "is_flying"),
        [
            (15.0, 0.5, Stamped(0.5626, NOW), False),
            (14.999999999, 0.5, Stamped(0.5626, NOW), None),
            (15.0, 0.5, Stamped(0.5625, NOW), None),
            (15.0, 0.5, Stamped(0.9, ago(16.0)), None),
            (15.0, 0.5, Stamped(0.9, ago(16.0) + 1), False),
            (15.0, 0.5, Stamped(None, NOW), None),
            (15.0, 0.5, Stamped(0.9, None), None),
            (15.0, None, Stamped(0.9, NOW), None),
        ],
    )
    def test_by_a_battery_changed_in_a_gap(
        self, gap_s: float, before: float | None, charge: Stamped[float], is_flying: bool | None
    ) -> None:
        flown_ns = ago(1.0) - round(gap_s * S)
        gap = replace(self.FLOWN, flown_at_ns=flown_ns, battery_fraction=before)
        belief = after(vehicle(gap, charge=charge), ground(20.0), battery_gain_fraction=0.0625)
        assert belief.is_flying is is_flying

    @pytest.mark.parametrize(
        ("rest_s", "at_rest", "charge", "is_flying"),
        [
            (120.0, 0.625, Stamped(0.625, NOW), False),
            (119.999999999, 0.625, Stamped(0.625, NOW), None),
            (120.0, 0.625, Stamped(0.594, NOW), False),
            (120.0, 0.625, Stamped(0.59375, NOW), None),
            (120.0, 0.625, Stamped(0.65625, NOW), None),
            (120.0, 0.625, Stamped(0.625, ago(5.0)), False),
            (120.0, 0.625, Stamped(0.625, ago(5.0) - 1), None),
            (120.0, 0.625, Stamped(None, NOW), None),
            (120.0, 0.625, Stamped(0.625, None), None),
            (120.0, None, Stamped(None, NOW), None),
        ],
    )
    def test_by_two_minutes_of_rest_without_power(
        self,
        rest_s: float,
        at_rest: float | None,
        charge: Stamped[float],
        is_flying: bool | None,
    ) -> None:
        rests = GroundReports(ago(300.0), ago(rest_s), 20.0, at_rest)
        state = vehicle(replace(self.FLOWN, slow_since_ns=None, reports=rests), charge=charge)
        belief = after(state, ground(20.0, (0.6, 0.0, 0.0)), rest_fraction=0.03125)
        assert belief.is_flying is is_flying
        if is_flying is False:
            assert belief.evidence.ground == GroundStand(NOW, NOW, AWAY, 20.0)

    @pytest.mark.parametrize(
        ("height_m", "is_flying"), [(38.0, True), (37.9, None), (None, None), (90.0, True)]
    )
    def test_until_then_it_flies_if_it_has_not_come_down(
        self, height_m: float | None, is_flying: bool | None
    ) -> None:
        for highs in ({"high_m": 40.0, "older_high_m": 30.0}, {"high_m": None, "older_high_m": 40}):
            reports = replace(self.REPORTS, height_m=height_m)
            up = replace(self.FLOWN, reports=reports, **highs)
            belief = after(vehicle(up), ground(height_m))
            assert belief.is_flying is is_flying
        unknown = replace(self.FLOWN, high_m=None, older_high_m=None)
        assert self.lands(unknown, ground(20.0)) is None

    def test_a_landing_or_its_home_speaks_against_that(self) -> None:
        up = replace(self.FLOWN, high_m=0.0, slow_since_ns=None)
        assert self.lands(up, ground(20.0)) is True
        assert (
            self.lands(replace(self.LANDS, high_m=20.0, slow_since_ns=None), ground(20.0)) is None
        )
        low = replace(up, reports=replace(self.REPORTS, height_m=0.0))
        assert self.lands(low, ground(0.0, position=PLACE)) is None

    @pytest.mark.parametrize(("lasts_s", "is_doubted"), [(2.0, True), (1.999999999, False)])
    def test_after_2_s_that_is_a_doubt(self, lasts_s: float, is_doubted: bool) -> None:
        reports = replace(self.REPORTS, since_ns=ago(lasts_s))
        belief = after(vehicle(replace(self.FLOWN, reports=reports)), ground(20.0))
        assert (belief.is_flying, belief.is_doubted) == (None, is_doubted)
        up = after(vehicle(replace(self.FLOWN, high_m=20.0)), ground(20.0))
        assert (up.is_flying, up.is_doubted) == (True, True)


class TestARunOfReports:
    BEFORE = GroundReports(ago(60.0), ago(50.0), 20.0, 0.6)

    def run(
        self, before: GroundReports | None, report: CoreReport, charge: float | None = 0.6
    ) -> AirborneBelief:
        flew = FlightEvidence(flown_at_ns=ago(60.0), high_m=80.0, reports=before)
        return after(vehicle(flew, charge=Stamped(charge, NOW)), report)

    def test_the_first_begins_it(self) -> None:
        assert self.run(None, ground(20.0)).evidence.reports == GroundReports(NOW, NOW, 20.0, 0.6)

    @pytest.mark.parametrize(
        ("height_m", "velocity", "moves"),
        [
            (22.0, (0.0, 0.0, 0.0), False),
            (18.0, (0.0, 0.0, 0.0), False),
            (22.1, (0.0, 0.0, 0.0), True),
            (17.9, (0.0, 0.0, 0.0), True),
            (20.0, (1.0, 0.0, 0.0), False),
            (20.0, (1.1, 0.0, 0.0), True),
            (20.0, None, False),
            (None, (0.0, 0.0, 0.0), False),
        ],
    )
    def test_motion_refutes_the_landing(
        self, height_m: float | None, velocity: tuple[float, float, float] | None, moves: bool
    ) -> None:
        belief = self.run(self.BEFORE, ground(height_m, velocity))
        moved = GroundReports(ago(60.0), NOW, height_m, 0.6, True, NOW)
        assert belief.evidence.reports == (moved if moves else self.BEFORE)
        assert (belief.is_flying, belief.is_doubted) == ((True if moves else None), True)

    def test_without_a_height_before_none_has_changed(self) -> None:
        before = replace(self.BEFORE, height_m=None)
        assert self.run(before, ground(20.0)).evidence.reports == before

    @pytest.mark.parametrize(("moved_s", "is_flying"), [(0.999999999, True), (1.0, None)])
    def test_motion_counts_for_a_second(self, moved_s: float, is_flying: bool | None) -> None:
        before = replace(self.BEFORE, has_moved=True, moved_at_ns=ago(moved_s))
        belief = self.run(before, ground(20.0))
        assert belief.is_flying is is_flying
        assert belief.is_doubted

    def test_rest_counts_from_the_first_charge(self) -> None:
        unknown = replace(self.BEFORE, battery_fraction=None)
        assert self.run(unknown, ground(20.0)).evidence.reports == replace(
            self.BEFORE, rest_since_ns=NOW
        )
        assert self.run(unknown, ground(20.0), None).evidence.reports == unknown

    def test_and_anew_after_two_minutes(self) -> None:
        for rest_ns, is_new in ((ago(121.0), False), (ago(121.0) - 1, True)):
            before = replace(self.BEFORE, rest_since_ns=rest_ns)
            expected = (
                replace(before, rest_since_ns=NOW, battery_fraction=0.5) if is_new else before
            )
            assert self.run(before, ground(20.0), 0.5).evidence.reports == expected


class TestSignsOfFlight:
    """It stands; its mode is one of flight since it came to stand, where `flies`."""

    STAND = GroundStand(ago(60.0), ago(0.1), PLACE, 0.0)
    MODE = Stamped(FlightMode.GPS_WAYPOINT, ago(60.0) + 1)

    def belief(
        self,
        stand: GroundStand,
        report: CoreReport,
        *,
        flying: bool | None = False,
        mode: Stamped[FlightMode] = Stamped(FlightMode.GPS_ATTI, NOW),
        last_height_m: float | None = 0.0,
    ) -> AirborneBelief:
        evidence = FlightEvidence(ground=stand)
        return after(
            vehicle(evidence, flying=flying, mode=mode, last_height_m=last_height_m), report
        )

    def test_the_first_report_of_the_ground_is_where_it_stands(self) -> None:
        belief = after(vehicle(FlightEvidence(), flying=None), ground(3.0))
        stand = GroundStand(NOW, NOW, AWAY, 3.0)
        assert belief == AirborneBelief(False, FlightEvidence(ground=stand))

    @pytest.mark.parametrize(
        ("report", "is_sign"),
        [
            (ground(0.0, (2.0, 0.0, 0.0)), False),
            (ground(0.0, (2.1, 0.0, 0.0)), True),
            (ground(0.0, None), False),
            (ground(5.005, (0.0, 0.0, 0.0)), False),
            (ground(5.006, (0.0, 0.0, 0.0)), True),
            (ground(-5.006, (0.0, 0.0, 0.0)), True),
            (ground(5.006, (2.1, 0.0, 0.0)), True),
            (ground(None, (0.0, 0.0, 0.0)), False),
        ],
    )
    def test_speed_and_height(self, report: CoreReport, is_sign: bool) -> None:
        """The height of the ground follows by 5 mm in 0.1 s."""
        stand = self.belief(self.STAND, report).evidence.ground
        assert stand is not None
        assert (stand.signs_since_ns == NOW) is is_sign
        assert (stand.signs_since_ns is None) is not is_sign

    @pytest.mark.parametrize(
        ("mode", "is_sign"),
        [
            (MODE, True),
            (Stamped(FlightMode.GPS_WAYPOINT, ago(60.0)), False),
            (Stamped(FlightMode.GPS_WAYPOINT, None), False),
            (Stamped(FlightMode.GPS_ATTI, NOW), False),
            (Stamped(FlightMode.AUTO_LANDING, NOW), False),
        ],
    )
    def test_a_mode_of_flight_that_is_new(self, mode: Stamped[FlightMode], is_sign: bool) -> None:
        stand = self.belief(self.STAND, ground(0.0), mode=mode).evidence.ground
        assert stand is not None
        assert (stand.signs_since_ns == NOW) is is_sign

    def test_for_less_than_a_second_nothing_changes(self) -> None:
        early = replace(self.STAND, signs_since_ns=ago(1.0) + 1)
        for flying in (False, None):
            belief = self.belief(early, ground(0.0, (3.0, 0.0, 0.0)), flying=flying)
            stand = GroundStand(ago(60.0), NOW, PLACE, 0.0, ago(1.0) + 1)
            assert belief == AirborneBelief(flying, FlightEvidence(ground=stand))

    def test_after_a_second_one_sign_is_a_doubt_and_two_are_a_flight(self) -> None:
        since = replace(self.STAND, signs_since_ns=ago(1.0))
        stand = FlightEvidence(ground=GroundStand(ago(60.0), NOW, PLACE, 0.0, ago(1.0)))
        doubt = AirborneBelief(None, stand, is_doubted=True)
        moves = ground(0.0, (3.0, 0.0, 0.0))
        assert self.belief(since, moves) == doubt
        assert self.belief(since, ground(0.0), mode=self.MODE) == doubt
        flying = FlightEvidence(flown_at_ns=NOW, flown_height_m=0.0, high_m=0.0, high_since_ns=NOW)
        assert self.belief(since, moves, mode=self.MODE) == AirborneBelief(
            True, flying, True, PLACE, is_doubted=True
        )

    def test_without_signs_it_stands_there(self) -> None:
        signs = replace(self.STAND, signs_since_ns=ago(0.5))
        for here, place in ((AWAY, AWAY), (None, PLACE)):
            belief = self.belief(signs, ground(0.0, position=here))
            stand = GroundStand(ago(60.0), NOW, place, 0.0)
            assert belief == AirborneBelief(False, FlightEvidence(ground=stand))

    def test_after_a_doubt_it_must_be_quiet_for_a_second(self) -> None:
        for flying in (None, True):
            begins = self.belief(self.STAND, ground(0.0), flying=flying)
            stand = GroundStand(ago(60.0), NOW, PLACE, 0.0, None, NOW)
            assert begins == AirborneBelief(None, FlightEvidence(ground=stand), is_doubted=True)
            for quiet_ns, is_flying in ((ago(1.0) + 1, None), (ago(1.0), False)):
                quiet = replace(self.STAND, quiet_since_ns=quiet_ns)
                belief = self.belief(quiet, ground(0.0), flying=flying)
                assert belief.is_flying is is_flying
                if is_flying is None:
                    assert belief.evidence.ground == replace(stand, quiet_since_ns=quiet_ns)

    @pytest.mark.parametrize(
        ("stood_m", "gap_s", "last_m", "height_m", "ground_m"),
        [
            (0.0, 2.0, 0.0, 0.05, 0.05),
            (0.0, 2.0, 0.0, 4.0, 0.1),
            (0.0, 2.0, 0.0, -4.0, -0.1),
            (12.0, 2.0, 12.0, None, 12.0),
            (None, 2.0, None, 7.0, 7.0),
            (None, 2.0, None, None, None),
            (40.0, 2.0, 40.0, 11.0, 39.9),
            (40.0, 2.0, 40.0, 10.9, 10.9),
            (40.0, 2.0, 11.0, 10.9, 39.9),
            (40.0, 2.0, None, 10.9, 39.9),
            (0.0, 2.0, 0.0, 29.1, 29.1),
            (6.0, 5.0, 6.0, 2.0, 2.0),
            (6.0, 5.0, 6.0, -2.0, -2.0),
            (6.0, 5.0, 6.0, 2.1, 5.75),
            (6.0, 4.0, 6.0, 2.0, 5.8),
        ],
    )
    def test_the_height_of_the_ground(
        self,
        stood_m: float | None,
        gap_s: float,
        last_m: float | None,
        height_m: float | None,
        ground_m: float | None,
    ) -> None:
        """It drifts by 5 cm/s; a step is a new zero, and so is its takeoff height after 5 s."""
        stand = GroundStand(ago(60.0), ago(gap_s), PLACE, stood_m)
        found = self.belief(stand, ground(height_m), last_height_m=last_m).evidence.ground
        assert found is not None
        assert found.height_m == (None if ground_m is None else pytest.approx(ground_m))
