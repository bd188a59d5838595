"""Home is reached with the reserve, from every point of what is flown."""

from dataclasses import replace

import pytest
from tests.safety.cases import STICK, TAKEOFF, ZERO, command, mission, situation, vehicle, waypoint

from recon.model.airspace import Airspace, FlightLimits
from recon.model.command import Body, FlyMission, GoTo, HoldPosition, Hover, Nudge, StartCamera
from recon.model.geo import LatLon
from recon.model.units import Stamped
from recon.model.vehicle import BatteryWarning, VehicleProfile, VehicleState
from recon.safety import PreparedAirspace
from recon.safety.energy import consumption, need_of
from recon.safety.rules.battery import battery
from recon.safety.situation import Situation

OUT = LatLon(waypoint(200.0).latitude_deg, -93.6)
FAR = GoTo(LatLon(waypoint(400.0).latitude_deg, -93.6), 40.0, 5.0)
NEARER = GoTo(LatLon(waypoint(100.0).latitude_deg, -93.6), 40.0, 5.0)
AWAY: list[Body] = [
    mission(waypoint(200.0), waypoint(300.0)),
    FAR,
    Nudge(20.0, 0.0, 0.0),
    replace(STICK, velocity_x_mps=5.0),
]
LANDING = replace(mission(waypoint(200.0), waypoint(0.0)).mission, land_at_end=True)
TOWARDS_HOME: list[Body] = [
    FlyMission(LANDING),
    NEARER,
    Nudge(-20.0, 0.0, 0.0),
    replace(STICK, velocity_x_mps=-5.0),
    HoldPosition(),
]


def out(profile: VehicleProfile | None = TAKEOFF, **changes: object) -> VehicleState:
    """200 m north of home, 40 m high."""
    return vehicle(profile, **{"position": OUT, **changes})  # type: ignore[arg-type]


def reason(body: Body, state: VehicleState, now: Situation | None = None) -> str | None:
    answer = battery(command(body), replace(now or situation(), vehicle=state))
    assert answer is None or (answer.rule, answer.reason[:3]) == ("battery", "A: ")
    return None if answer is None else answer.reason.removeprefix("A: ")


def whole(body: Body, state: VehicleState) -> float:
    now = situation()
    uses = consumption(state, now.airspace, now.settings.energy)
    assert uses is not None
    need = need_of(uses, state, body)
    assert need is not None
    return need.whole


class TestReserve:
    @pytest.mark.parametrize("body", AWAY)
    def test_what_leads_away_must_bring_the_reserve_home(self, body: Body) -> None:
        enough = whole(body, out()) + 0.25
        assert reason(body, out(battery_fraction=enough)) is None
        assert reason(body, out(battery_fraction=enough - 1e-6)) is not None

    @pytest.mark.parametrize("body", TOWARDS_HOME)
    def test_the_reserve_is_for_coming_home(self, body: Body) -> None:
        enough = whole(body, out()) + 0.10
        assert reason(body, out(battery_fraction=enough)) is None
        assert reason(body, out(battery_fraction=enough - 1e-6)) is not None

    def test_the_site_sets_it(self) -> None:
        limits = FlightLimits(battery_reserve_fraction=0.5)
        strict = replace(situation(), airspace=PreparedAirspace(Airspace(limits)))
        enough = whole(FAR, out()) + 0.5
        assert reason(FAR, out(battery_fraction=enough), strict) is None
        assert reason(FAR, out(battery_fraction=enough - 1e-6), strict) is not None

    def test_from_the_ground_the_climb_counts(self) -> None:
        ground = vehicle(flying=False)
        assert whole(mission(), ground) > whole(mission(), vehicle())
        enough = whole(mission(), ground) + 0.25
        assert reason(mission(), replace(ground, battery_fraction=Stamped(enough, 1))) is None
        assert reason(mission(), replace(ground, battery_fraction=Stamped(enough - 1e-6, 1)))

    @pytest.mark.parametrize("body", [ZERO, Hover(), StartCamera(1.0)])
    def test_what_stops_or_looks_needs_nothing(self, body: Body) -> None:
        empty = out(None, battery_fraction=0.0, battery_warning=BatteryWarning.SERIOUS)
        assert reason(body, empty) is None

    def test_a_missing_vehicle_is_another_rules_matter(self) -> None:
        assert battery(command(FAR), replace(situation(), vehicle=None)) is None

    def test_an_unknown_go_home_height_counts_as_the_highest_the_site_allows(self) -> None:
        unsaid = replace(TAKEOFF, go_home_height_m=None)
        highest = replace(TAKEOFF, go_home_height_m=120.0)
        enough = whole(FAR, out(highest)) + 0.25
        assert reason(FAR, out(unsaid, battery_fraction=enough)) is None
        assert reason(FAR, out(unsaid, battery_fraction=enough - 1e-6)) is not None


class TestWarning:
    @pytest.mark.parametrize("body", AWAY)
    @pytest.mark.parametrize(
        ("warning", "goes"),
        [
            (BatteryWarning.NONE, True),
            (BatteryWarning.LOW, False),
            (BatteryWarning.SERIOUS, False),
            (None, False),
        ],
    )
    def test_the_aircrafts_own_warning_counts_whatever_the_model_computes(
        self, body: Body, warning: BatteryWarning | None, goes: bool
    ) -> None:
        assert (reason(body, out(battery_warning=warning)) is None) is goes

    @pytest.mark.parametrize("body", TOWARDS_HOME)
    @pytest.mark.parametrize("warning", [None, *BatteryWarning])
    def test_until_it_is_serious_it_may_come_nearer(
        self, body: Body, warning: BatteryWarning | None
    ) -> None:
        goes = reason(body, out(battery_warning=warning)) is None
        assert goes is (warning is not BatteryWarning.SERIOUS)


class TestUnknown:
    @pytest.mark.parametrize("profile", [None, replace(TAKEOFF, endurance_s=None)])
    def test_endurance_and_how_to_tell_it(self, profile: VehicleProfile | None) -> None:
        refusal_text = reason(HoldPosition(), replace(out(), profile=profile))
        assert refusal_text == (
            "endurance unknown, so the route home cannot be checked; write "
            'endurance_min = MINUTES under [[vehicles]] serial = "A" in site.toml'
        )

    def test_charge(self) -> None:
        assert reason(NEARER, out(battery_fraction=None)) == (
            "battery charge unknown; check its companion app"
        )

    @pytest.mark.parametrize("lost", [{"position": Stamped()}, {"takeoff_point": None}])
    def test_place_or_home(self, lost: dict[str, object]) -> None:
        assert reason(FAR, out(**lost)) == (
            "position or home unknown, so the route home cannot be checked"
        )


class TestNumbers:
    def test_a_missions_refusal_states_what_it_needs_and_where(self) -> None:
        body = mission(waypoint(200.0), waypoint(700.0, speed_mps=10.0), waypoint(650.0))
        assert reason(body, out(battery_fraction=0.459)) == (
            "the mission needs 47 % of its battery; got 45 %: 9 % to waypoint 3, 12 % home "
            "from there, and 25 % reserve; fly less far, or change the battery"
        )

    def test_of_a_steered_order_there_is_only_its_end(self) -> None:
        assert reason(FAR, out(battery_fraction=0.3)) == (
            "the goto needs 38 % of its battery; got 30 %: 4 % to its end, 9 % home from there, "
            "and 25 % reserve; fly less far, or change the battery"
        )
        assert reason(HoldPosition(), out(battery_fraction=0.1)) == (
            "the hold position needs 18 % of its battery; got 10 %: 7 % home from there, and "
            "10 % reserve; fly less far, or change the battery"
        )

    def test_whole_percents_are_rounded_to_the_careful_side(self) -> None:
        limits = FlightLimits(battery_reserve_fraction=0.62)
        now = replace(situation(), airspace=PreparedAirspace(Airspace(limits)))
        refusal_text = reason(FAR, out(battery_fraction=0.29), now)
        assert refusal_text is not None
        assert "got 29 %" in refusal_text
        assert "and 62 % reserve" in refusal_text

    def test_a_whole_percent_is_not_rounded_up_to_the_next(self) -> None:
        limits = FlightLimits(battery_reserve_fraction=0.62)
        now = replace(situation(), airspace=PreparedAirspace(Airspace(limits)))
        endless = replace(TAKEOFF, endurance_s=1e300)
        refusal_text = reason(FAR, out(endless, battery_fraction=0.5), now)
        assert refusal_text is not None
        assert "the goto needs 62 % of its battery; got 50 %" in refusal_text

    def test_more_than_a_full_battery_is_stated(self) -> None:
        endless = replace(TAKEOFF, endurance_s=5e-324)
        refusal_text = reason(FAR, out(endless))
        assert refusal_text is not None
        assert "needs more than 100 % of its battery" in refusal_text
