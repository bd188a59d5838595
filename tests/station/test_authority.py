"""Who leads a vehicle: taken by word, lost by a stop, and always the pilot's for the taking."""

import pytest
from tests.fleet.said import core, extended
from tests.safety.cases import STICK, mission
from tests.station.commanded import Told

from recon.model.authority import Leader
from recon.model.command import Body, FlyMission, Hover, LandNow, Phase, ReturnHome, VirtualStick
from recon.model.event import AuthorityTaken, CommandSent, OperatorOrder
from recon.model.intent import Commanded, Intent
from recon.model.vehicle import FlightMode
from recon.station.control import authority
from recon.station.state.outputs import WithdrawMotion

HOVERING = (core(), extended(mode=FlightMode.GPS_ATTI))


@pytest.fixture
def told() -> Told:
    return Told().opens(1, *HOVERING).keeps_saying(1, *HOVERING).passes(0.5)


def takes(told: Told, leader: Leader, by: str = "Ann", serial: str = "A") -> Told:
    return told.happens(AuthorityTaken(serial, leader, by))


def led_by(told: Told) -> Leader:
    return authority.lead_of(told.station, "A").leader


def guidance_orders(told: Told, body: Body, number: int = 90) -> Phase:
    told.happens(OperatorOrder(number, body, "guidance", "A", asked_as=Leader.GUIDANCE))
    return told.phase(number)


def says(told: Told, north_mps: float, *, flying: bool = True) -> Told:
    where = core(flying=flying, velocity=(north_mps, 0.0, 0.0))
    return told.keeps_saying(1, where, HOVERING[1]).passes(0.5)


class TestByHand:
    def test_who_flies_about_with_nothing_ordered_is_its_pilots_until_taken(self) -> None:
        told = says(Told().opens(1), 6.0)
        assert led_by(told) is Leader.PILOT
        refused = told.record(told.order(mission()))
        assert refused.note.startswith("leader: A is led by pilot (it moves, and nothing has been")
        assert told.alarms() == set()
        takes(says(told, 6.0), Leader.OPERATOR)
        assert led_by(says(told, 6.0)) is Leader.OPERATOR

    def test_stops_need_no_leader(self) -> None:
        for body in (Hover(), LandNow(), ReturnHome()):
            told = says(Told().opens(1), 6.0)
            assert told.phase(told.order(body)) is Phase.SENT

    def test_one_that_hovers_is_the_operators_until_it_moves(self, told: Told) -> None:
        assert led_by(says(told, 1.9)) is Leader.OPERATOR
        assert led_by(says(told, 2.0)) is Leader.PILOT

    def test_on_the_ground_it_is_the_operators_and_in_the_air_whose_hand_took_it_there(
        self,
    ) -> None:
        told = says(Told().opens(1), 3.0, flying=False)
        assert led_by(told) is Leader.OPERATOR
        assert led_by(says(told, 3.0)) is Leader.PILOT

    def test_whom_somebody_took_before_stays_taken(self) -> None:
        told = says(Told().opens(1), 0.0, flying=False)
        takes(told, Leader.OPERATOR)
        assert led_by(says(told, 6.0)) is Leader.OPERATOR

    def test_after_an_order_of_ours_motion_alone_tells_nothing(self, told: Told) -> None:
        told.order(mission())
        told.passes(10.0)  # it comes to nothing
        assert led_by(says(told, 6.0)) is Leader.OPERATOR

    def test_without_velocity_or_mode_nobody_can_say(self) -> None:
        nothing = core(velocity=None), HOVERING[1]
        assert led_by(Told().opens(1, *nothing).passes(0.5)) is Leader.OPERATOR
        moving = core(velocity=(6.0, 0.0, 0.0)), extended(mode=None)
        assert led_by(Told().opens(1, *moving).passes(0.5)) is Leader.OPERATOR


class TestByWord:
    def test_the_operator_leads_until_somebody_takes_it(self, told: Told) -> None:
        assert led_by(told) is Leader.OPERATOR
        assert authority.lead_of(told.station, "A").reason == "nobody has taken it yet"

    def test_guidance_flies_what_was_given_to_it_and_nothing_else(self, told: Told) -> None:
        assert guidance_orders(told, mission(), 90) is Phase.REFUSED_BY_STATION
        takes(told, Leader.GUIDANCE)
        assert guidance_orders(told, mission(), 91) is Phase.SENT
        assert told.phase(told.order(mission())) is Phase.REFUSED_BY_STATION

    def test_who_gave_it_and_when_is_kept(self, told: Told) -> None:
        lead = authority.lead_of(takes(told, Leader.GUIDANCE).station, "A")
        assert (lead.holder, lead.since_ns) == ("Ann", told.now_ns)
        assert lead.reason == "given to it by Ann"
        lead = authority.lead_of(takes(told, Leader.OPERATOR, "Bob").station, "A")
        assert (lead.leader, lead.holder, lead.reason) == (
            Leader.OPERATOR,
            "Bob",
            "taken over by Bob",
        )

    def test_guidance_takes_nothing_from_a_pilot(self, told: Told) -> None:
        takes(told, Leader.PILOT)
        refusal = authority.refusal(told.station, AuthorityTaken("A", Leader.GUIDANCE, "Ann"))
        assert refusal is not None
        assert refusal.rule == "authority"
        assert "take it over first" in refusal.reason
        assert led_by(takes(told, Leader.GUIDANCE)) is Leader.PILOT

    def test_the_operator_takes_it_from_a_pilot_by_explicit_word(self, told: Told) -> None:
        takes(told, Leader.PILOT)
        assert told.phase(told.order(mission())) is Phase.REFUSED_BY_STATION
        assert told.phase(told.order(mission())) is Phase.REFUSED_BY_STATION
        takes(told, Leader.OPERATOR)
        assert told.phase(told.order(mission())) is Phase.SENT

    def test_a_vehicle_nobody_knows_is_taken_by_nobody(self, told: Told) -> None:
        refusal = authority.refusal(told.station, AuthorityTaken("X", Leader.OPERATOR, "Ann"))
        assert refusal is not None
        assert "X is not known" in refusal.reason
        assert "X" not in takes(told, Leader.OPERATOR, serial="X").station.leads


class TestAStop:
    @pytest.mark.parametrize("body", [Hover(), LandNow(), ReturnHome()])
    def test_takes_it_from_guidance_which_must_not_fly_on_at_once(
        self, told: Told, body: Body
    ) -> None:
        takes(told, Leader.GUIDANCE)
        told.order(body)
        lead = authority.lead_of(told.station, "A")
        assert (lead.leader, lead.holder) == (Leader.OPERATOR, "test")
        assert lead.reason.endswith(", ordered by test")
        assert guidance_orders(told, mission()) is Phase.REFUSED_BY_STATION

    def test_a_stop_that_waits_to_be_heard_takes_it_too(self, told: Told) -> None:
        takes(told, Leader.GUIDANCE)
        told.closes(1)
        assert told.phase(told.order(Hover())) is Phase.QUEUED
        assert led_by(told) is Leader.OPERATOR

    def test_its_own_stop_leaves_it_to_guidance(self, told: Told) -> None:
        takes(told, Leader.GUIDANCE)
        assert guidance_orders(told, Hover()) is Phase.SENT
        assert led_by(told) is Leader.GUIDANCE

    def test_a_stop_takes_nothing_from_a_pilot(self, told: Told) -> None:
        takes(told, Leader.PILOT)
        told.order(Hover())
        assert led_by(told) is Leader.PILOT

    def test_an_order_that_moves_or_looks_takes_nothing(self, told: Told) -> None:
        takes(told, Leader.GUIDANCE)
        told.order(mission())
        assert led_by(told) is Leader.GUIDANCE

    def test_a_stop_of_a_link_that_has_since_said_its_serial_counts(self, told: Told) -> None:
        takes(told, Leader.GUIDANCE)
        told.order(Hover(), None, link=1)
        assert led_by(told) is Leader.OPERATOR

    def test_a_stop_of_a_link_without_a_serial_is_nobodys(self, told: Told) -> None:
        told.opens(2, core()).order(Hover(), None, link=2)
        told.order(Hover(), None, link=99)
        assert dict(told.station.leads) == {}


class TestThePilot:
    def pilot(self, told: Told, serial: str = "A") -> tuple[WithdrawMotion, ...]:
        told.station, outputs = authority.pilot_has_it(told.station, serial, told.now_ns)
        assert all(isinstance(output, WithdrawMotion) for output in outputs)
        return outputs  # type: ignore[return-value]

    def test_leads_at_once_with_the_reason(self, told: Told) -> None:
        self.pilot(told)
        lead = authority.lead_of(told.station, "A")
        assert (lead.leader, lead.holder, lead.since_ns) == (Leader.PILOT, "pilot", told.now_ns)
        assert lead.reason == "the pilot has taken the sticks"

    @pytest.mark.parametrize("body", [mission(), STICK])
    def test_orders_to_move_end_as_superseded(self, told: Told, body: Body) -> None:
        order = told.order(body)
        self.pilot(told)
        assert told.phase(order) is Phase.SUPERSEDED
        assert told.record(order).note == "the pilot has taken the sticks"
        assert not told.record(order).is_watched

    def test_what_waits_unsent_is_withdrawn(self, told: Told) -> None:
        assert self.pilot(told) == (WithdrawMotion((1,), "the pilot has taken the sticks"),)

    def test_is_not_fought_no_zero_follows_the_stick(self, told: Told) -> None:
        told.order(STICK)
        assert "A" in told.station.sticks
        self.pilot(told)
        told.keeps_saying(1, core(), extended(mode=FlightMode.JOYSTICK)).passes(5.0)
        sticks = [body for body in told.bodies() if isinstance(body, VirtualStick)]
        assert sticks == [STICK]

    def test_hold_land_and_return_are_still_sent(self, told: Told) -> None:
        self.pilot(told)
        assert [told.phase(told.order(body)) for body in (Hover(), ReturnHome(), LandNow())] == [
            Phase.SENT
        ] * 3

    def test_raises_one_alarm_that_names_the_vehicle(self, told: Told) -> None:
        self.pilot(told)
        self.pilot(told)
        (alarm,) = told.station.alarms.alarms.values()
        assert alarm.condition.rule == "pilot_took_over"
        assert alarm.condition.text.startswith("A: the pilot has taken the sticks")

    def test_the_station_foresees_nothing_of_its_own_any_more(self, told: Told) -> None:
        self.pilot(told)
        assert told.station.intents["A"] == Intent(Commanded.NOTHING, told.now_ns)

    def test_only_the_first_sight_of_it_counts(self, told: Told) -> None:
        self.pilot(told)
        before = told.station
        told.passes(1.0)
        assert self.pilot(told) == ()
        assert told.station.leads == before.leads

    def test_of_an_unknown_vehicle_is_nobody(self, told: Told) -> None:
        before = told.station
        assert self.pilot(told, "X") == ()
        assert told.station is before

    def test_leaves_other_vehicles_to_the_station(self, told: Told) -> None:
        told.opens(2, core(), extended("B")).keeps_saying(2, core(), extended("B"))
        told.happens(OperatorOrder(80, mission(), "test", "B"))
        self.pilot(told)
        assert told.phase(80) is not Phase.SUPERSEDED

    def test_an_order_sent_before_and_dropped_later_changes_nothing(self, told: Told) -> None:
        told.is_stuck = True
        order = told.order(mission())
        self.pilot(told)
        told.dropped(order, Phase.SUPERSEDED).happens(CommandSent(1, order))
        assert told.phase(order) is Phase.SUPERSEDED
        assert isinstance(told.record(order).command.body, FlyMission)
