"""Authority over a vehicle: transferred explicitly, taken by a stop, always the pilot's."""

import pytest
from tests.fleet.reports import core, extended
from tests.safety.cases import STICK, mission
from tests.station.commanded import CommandedStation

from recon.model.command import Body, FlyMission, Hover, LandNow, Phase, ReturnHome, VirtualStick
from recon.model.control import AuthorityHolder, Commanded, Intent
from recon.model.event import AuthorityTaken, CommandSent, OperatorOrder
from recon.model.vehicle import FlightMode
from recon.station.control import authority
from recon.station.state.steps import WithdrawMotion

HOVERING = (core(), extended(mode=FlightMode.GPS_ATTI))


@pytest.fixture
def scene() -> CommandedStation:
    return CommandedStation().opens(1, *HOVERING).keeps_receiving(1, *HOVERING).passes(0.5)


def takes(
    scene: CommandedStation, holder: AuthorityHolder, by: str = "Ann", serial: str = "A"
) -> CommandedStation:
    return scene.happens(AuthorityTaken(serial, holder, by))


def holder_of(scene: CommandedStation) -> AuthorityHolder:
    return scene.station.control("A").authority.holder


def guidance_orders(scene: CommandedStation, body: Body, number: int = 90) -> Phase:
    scene.happens(OperatorOrder(number, body, "guidance", "A", role=AuthorityHolder.GUIDANCE))
    return scene.phase(number)


def reports(scene: CommandedStation, north_mps: float, *, flying: bool = True) -> CommandedStation:
    where = core(flying=flying, velocity=(north_mps, 0.0, 0.0))
    return scene.keeps_receiving(1, where, HOVERING[1]).passes(0.5)


class TestByHand:
    def test_motion_without_an_order_gives_authority_to_the_pilot(self) -> None:
        scene = reports(CommandedStation().opens(1), 6.0)
        assert holder_of(scene) is AuthorityHolder.PILOT
        refused = scene.record(scene.order(mission()))
        assert refused.refusal is not None
        assert refused.refusal.rule == "authority"
        assert refused.note.startswith("A is controlled by pilot (in motion without an order")
        assert scene.alarms() == set()
        takes(reports(scene, 6.0), AuthorityHolder.OPERATOR)
        assert holder_of(reports(scene, 6.0)) is AuthorityHolder.OPERATOR

    def test_stops_need_no_authority(self) -> None:
        for body in (Hover(), LandNow(), ReturnHome()):
            scene = reports(CommandedStation().opens(1), 6.0)
            assert scene.phase(scene.order(body)) is Phase.SENT

    def test_one_that_hovers_is_the_operators_until_it_moves(self, scene: CommandedStation) -> None:
        assert holder_of(reports(scene, 1.9)) is AuthorityHolder.OPERATOR
        assert holder_of(reports(scene, 2.0)) is AuthorityHolder.PILOT

    def test_on_the_ground_it_is_the_operators_and_in_the_air_whose_hand_took_it_there(
        self,
    ) -> None:
        scene = reports(CommandedStation().opens(1), 3.0, flying=False)
        assert holder_of(scene) is AuthorityHolder.OPERATOR
        assert holder_of(reports(scene, 3.0)) is AuthorityHolder.PILOT

    def test_authority_that_was_taken_before_stays(self) -> None:
        scene = reports(CommandedStation().opens(1), 0.0, flying=False)
        takes(scene, AuthorityHolder.OPERATOR)
        assert holder_of(reports(scene, 6.0)) is AuthorityHolder.OPERATOR

    def test_after_an_order_of_ours_motion_alone_tells_nothing(
        self, scene: CommandedStation
    ) -> None:
        scene.order(mission())
        scene.passes(10.0)  # it comes to nothing
        assert holder_of(reports(scene, 6.0)) is AuthorityHolder.OPERATOR

    def test_without_velocity_or_mode_it_does_not_change(self) -> None:
        nothing = core(velocity=None), HOVERING[1]
        assert (
            holder_of(CommandedStation().opens(1, *nothing).passes(0.5)) is AuthorityHolder.OPERATOR
        )
        moving = core(velocity=(6.0, 0.0, 0.0)), extended(mode=None)
        assert (
            holder_of(CommandedStation().opens(1, *moving).passes(0.5)) is AuthorityHolder.OPERATOR
        )


class TestByWord:
    def test_the_operator_has_it_until_it_is_taken(self, scene: CommandedStation) -> None:
        assert holder_of(scene) is AuthorityHolder.OPERATOR
        assert scene.station.control("A").authority.reason == "not yet transferred"

    def test_guidance_flies_what_was_given_to_it_and_nothing_else(
        self, scene: CommandedStation
    ) -> None:
        assert guidance_orders(scene, mission(), 90) is Phase.REFUSED_BY_STATION
        takes(scene, AuthorityHolder.GUIDANCE)
        assert guidance_orders(scene, mission(), 91) is Phase.SENT
        assert scene.phase(scene.order(mission())) is Phase.REFUSED_BY_STATION

    def test_who_gave_it_and_when_is_kept(self, scene: CommandedStation) -> None:
        held = takes(scene, AuthorityHolder.GUIDANCE).station.control("A").authority
        assert (held.holder_name, held.since_ns) == ("Ann", scene.now_ns)
        assert held.reason == "given by Ann"
        held = takes(scene, AuthorityHolder.OPERATOR, "Bob").station.control("A").authority
        assert (held.holder, held.holder_name, held.reason) == (
            AuthorityHolder.OPERATOR,
            "Bob",
            "taken over by Bob",
        )

    def test_guidance_takes_nothing_from_a_pilot(self, scene: CommandedStation) -> None:
        takes(scene, AuthorityHolder.PILOT)
        refusal = authority.refusal(
            scene.station, AuthorityTaken("A", AuthorityHolder.GUIDANCE, "Ann")
        )
        assert refusal is not None
        assert refusal.rule == "authority"
        assert "take control first" in refusal.reason
        assert holder_of(takes(scene, AuthorityHolder.GUIDANCE)) is AuthorityHolder.PILOT

    def test_the_operator_takes_it_from_a_pilot_by_explicit_word(
        self, scene: CommandedStation
    ) -> None:
        takes(scene, AuthorityHolder.PILOT)
        assert scene.phase(scene.order(mission())) is Phase.REFUSED_BY_STATION
        assert scene.phase(scene.order(mission())) is Phase.REFUSED_BY_STATION
        takes(scene, AuthorityHolder.OPERATOR)
        assert scene.phase(scene.order(mission())) is Phase.SENT

    def test_an_unknown_vehicle_cannot_be_taken(self, scene: CommandedStation) -> None:
        refusal = authority.refusal(
            scene.station, AuthorityTaken("X", AuthorityHolder.OPERATOR, "Ann")
        )
        assert refusal is not None
        assert "X is unknown" in refusal.reason
        assert "X" not in takes(scene, AuthorityHolder.OPERATOR, serial="X").station.controls


class TestAStop:
    @pytest.mark.parametrize("body", [Hover(), LandNow(), ReturnHome()])
    def test_takes_it_from_guidance_which_must_not_fly_on_at_once(
        self, scene: CommandedStation, body: Body
    ) -> None:
        takes(scene, AuthorityHolder.GUIDANCE)
        scene.order(body)
        held = scene.station.control("A").authority
        assert (held.holder, held.holder_name) == (AuthorityHolder.OPERATOR, "test")
        assert held.reason.endswith(", ordered by test")
        assert guidance_orders(scene, mission()) is Phase.REFUSED_BY_STATION

    def test_a_stop_that_waits_for_telemetry_takes_it_too(self, scene: CommandedStation) -> None:
        takes(scene, AuthorityHolder.GUIDANCE)
        scene.closes(1)
        assert scene.phase(scene.order(Hover())) is Phase.QUEUED
        assert holder_of(scene) is AuthorityHolder.OPERATOR

    def test_its_own_stop_leaves_it_to_guidance(self, scene: CommandedStation) -> None:
        takes(scene, AuthorityHolder.GUIDANCE)
        assert guidance_orders(scene, Hover()) is Phase.SENT
        assert holder_of(scene) is AuthorityHolder.GUIDANCE

    def test_a_stop_takes_nothing_from_a_pilot(self, scene: CommandedStation) -> None:
        takes(scene, AuthorityHolder.PILOT)
        scene.order(Hover())
        assert holder_of(scene) is AuthorityHolder.PILOT

    def test_an_order_that_moves_or_looks_takes_nothing(self, scene: CommandedStation) -> None:
        takes(scene, AuthorityHolder.GUIDANCE)
        scene.order(mission())
        assert holder_of(scene) is AuthorityHolder.GUIDANCE

    def test_a_stop_of_a_link_that_has_since_reported_its_serial_counts(
        self, scene: CommandedStation
    ) -> None:
        takes(scene, AuthorityHolder.GUIDANCE)
        scene.order(Hover(), None, link=1)
        assert holder_of(scene) is AuthorityHolder.OPERATOR

    def test_a_stop_of_a_link_without_a_serial_is_nobodys(self, scene: CommandedStation) -> None:
        scene.opens(2, core()).order(Hover(), None, link=2)
        scene.order(Hover(), None, link=99)
        assert not any(control.is_taken for control in scene.station.controls.values())


class TestThePilot:
    def pilot(self, scene: CommandedStation, serial: str = "A") -> tuple[WithdrawMotion, ...]:
        scene.station, outputs = authority.give_to_pilot(scene.station, serial, scene.now_ns)
        assert all(isinstance(output, WithdrawMotion) for output in outputs)
        return outputs  # type: ignore[return-value]

    def test_leads_at_once_with_the_reason(self, scene: CommandedStation) -> None:
        self.pilot(scene)
        held = scene.station.control("A").authority
        assert (held.holder, held.holder_name, held.since_ns) == (
            AuthorityHolder.PILOT,
            "pilot",
            scene.now_ns,
        )
        assert held.reason == "the pilot has taken the sticks"

    @pytest.mark.parametrize("body", [mission(), STICK])
    def test_orders_to_move_end_as_superseded(self, scene: CommandedStation, body: Body) -> None:
        order = scene.order(body)
        self.pilot(scene)
        assert scene.phase(order) is Phase.SUPERSEDED
        assert scene.record(order).note == "the pilot has taken the sticks"
        assert not scene.record(order).is_tracked

    def test_what_waits_unsent_is_withdrawn(self, scene: CommandedStation) -> None:
        assert self.pilot(scene) == (WithdrawMotion((1,), "the pilot has taken the sticks"),)

    def test_is_not_fought_no_zero_follows_the_stick(self, scene: CommandedStation) -> None:
        scene.order(STICK)
        assert scene.station.neutral_pending == ("A",)
        self.pilot(scene)
        scene.keeps_receiving(1, core(), extended(mode=FlightMode.JOYSTICK)).passes(5.0)
        sticks = [body for body in scene.bodies() if isinstance(body, VirtualStick)]
        assert sticks == [STICK]

    def test_hold_land_and_return_are_still_sent(self, scene: CommandedStation) -> None:
        self.pilot(scene)
        assert [scene.phase(scene.order(body)) for body in (Hover(), ReturnHome(), LandNow())] == [
            Phase.SENT
        ] * 3

    def test_raises_one_alarm_that_names_the_vehicle(self, scene: CommandedStation) -> None:
        self.pilot(scene)
        self.pilot(scene)
        (alarm,) = scene.station.alarms.alarms.values()
        assert alarm.condition.rule == "pilot_took_over"
        assert alarm.condition.text.startswith("A: the pilot has taken the sticks")

    def test_the_vehicle_is_commanded_nothing(self, scene: CommandedStation) -> None:
        self.pilot(scene)
        assert scene.station.control("A").intent == Intent(Commanded.NOTHING, scene.now_ns)

    def test_only_the_first_sight_of_it_counts(self, scene: CommandedStation) -> None:
        self.pilot(scene)
        before = scene.station
        scene.passes(1.0)
        assert self.pilot(scene) == ()
        assert scene.station.control("A").authority == before.control("A").authority

    def test_of_an_unknown_vehicle_changes_nothing(self, scene: CommandedStation) -> None:
        before = scene.station
        assert self.pilot(scene, "X") == ()
        assert scene.station is before

    def test_leaves_other_vehicles_to_the_station(self, scene: CommandedStation) -> None:
        scene.opens(2, core(), extended("B")).keeps_receiving(2, core(), extended("B"))
        scene.happens(OperatorOrder(80, mission(), "test", "B"))
        self.pilot(scene)
        assert scene.phase(80) is not Phase.SUPERSEDED

    def test_an_order_sent_before_and_dropped_later_changes_nothing(
        self, scene: CommandedStation
    ) -> None:
        scene.is_stuck = True
        order = scene.order(mission())
        self.pilot(scene)
        scene.dropped(order, Phase.SUPERSEDED).happens(CommandSent(1, order))
        assert scene.phase(order) is Phase.SUPERSEDED
        assert isinstance(scene.record(order).command.body, FlyMission)
