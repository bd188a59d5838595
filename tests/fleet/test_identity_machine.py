"""Random lives of links: no vehicle is lost, no link is two vehicles, rivals are what links say."""

from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule
from tests.examples import examples
from tests.fleet.reports import Story, core, extended

SERIALS = st.sampled_from([None, "A", "B", "C"])


class Links(RuleBasedStateMachine):
    def __init__(self) -> None:
        super().__init__()
        self.story = Story()
        self.next_id = 1
        self.open: set[int] = set()
        self.serials: set[str] = set()
        self.claims: dict[int, str] = {}

    def pick(self, data: st.DataObject) -> int:
        return data.draw(st.sampled_from(sorted(self.open)))

    @rule(seconds=st.sampled_from([0.0, 0.1, 0.5, 1.0, 3.0, 30.0]))
    def time_goes_on(self, seconds: float) -> None:
        self.story.at(self.story.now_s + seconds)

    @rule()
    def opens(self) -> None:
        self.story.opens(self.next_id)
        self.open.add(self.next_id)
        self.next_id += 1

    @precondition(lambda self: self.open)
    @rule(data=st.data())
    def closes(self, data: st.DataObject) -> None:
        link_id = self.pick(data)
        self.story.closes(link_id)
        self.open.discard(link_id)

    @rule(link_id=st.integers(0, 40))
    def closes_what_may_not_be_there(self, link_id: int) -> None:
        self.story.closes(link_id)
        self.open.discard(link_id)

    @precondition(lambda self: self.open)
    @rule(data=st.data(), serial=SERIALS)
    def reports_its_serial(self, data: st.DataObject, serial: str | None) -> None:
        self.story.receives(self.pick(data), extended(serial))
        self.serials |= {serial} - {None}

    @rule(link_id=st.integers(0, 40), flying=st.sampled_from([True, False, None]))
    def telemetry_on_any_link(self, link_id: int, flying: bool | None) -> None:
        self.story.receives(link_id, core(flying=flying))

    @rule(is_prompt=st.booleans())
    def ticks(self, is_prompt: bool) -> None:
        self.story.ticks()
        for closing in self.story.closing if is_prompt else ():
            self.story.closes(closing.link_id)
            self.open.discard(closing.link_id)
        if is_prompt:
            self.story.closing.clear()

    @invariant()
    def no_vehicle_is_lost(self) -> None:
        assert set(self.story.fleet.vehicles) == self.serials

    @invariant()
    def a_link_is_one_vehicle_at_most_and_open(self) -> None:
        bound = [v.link_id for v in self.story.fleet.vehicles.values() if v.link_id is not None]
        assert len(bound) == len(set(bound))
        assert set(bound) <= self.open

    @invariant()
    def a_vehicles_link_claims_its_serial(self) -> None:
        for serial, vehicle in self.story.fleet.vehicles.items():
            assert vehicle.serial == serial
            if vehicle.link_id is not None:
                assert self.story.fleet.links[vehicle.link_id].claimed_serial == serial

    @invariant()
    def rivals_are_the_other_open_links_that_claim_the_serial(self) -> None:
        fleet = self.story.fleet
        for serial, vehicle in fleet.vehicles.items():
            claiming = {
                link.id
                for link in fleet.links.values()
                if link.is_open and link.claimed_serial == serial
            }
            assert set(vehicle.rival_link_ids) == claiming - {vehicle.link_id}
            assert len(set(vehicle.rival_link_ids)) == len(vehicle.rival_link_ids)
            assert not (claiming and vehicle.link_id is None)
            assert vehicle.in_conflict == any(
                fleet.links[rival].in_conflict for rival in vehicle.rival_link_ids
            )

    @invariant()
    def every_open_link_is_a_vehicle_or_shown_as_none(self) -> None:
        fleet = self.story.fleet
        bound = {v.link_id for v in fleet.vehicles.values()} - {None}
        assert {link.id for link in fleet.unbound_links()} == self.open - bound


TestLinks = Links.TestCase
TestLinks.settings = settings(max_examples=examples(150), stateful_step_count=40, deadline=None)
