"""The guard holds what a silent station steered, and everything on a person's word."""

from dataclasses import replace

from tests.fleet.reports import core, jittered

from recon.guard.watch import (
    CoreRead,
    GuardState,
    Intervention,
    LinkGone,
    Picture,
    StationEnded,
    Watched,
    noted,
    step,
)
from recon.model.command import Command, Hover
from recon.model.event import AllStopped, Tick
from recon.model.units import Stamped, seconds_to_ns
from recon.model.vehicle import VehicleState

S = seconds_to_ns(1.0)
START_NS = 1_000 * S


def watched(
    link_id: int, *, flying: bool | None = True, steered: bool = False, at_ns: int = START_NS
) -> Watched:
    serial = f"V-{link_id}"
    is_flying = Stamped(flying, at_ns)
    vehicle = VehicleState(
        serial,
        link_id,
        is_flying=is_flying,
        reported_is_flying=is_flying,
        core_received_at_ns=at_ns,
    )
    return Watched(f"Drone {link_id}", vehicle, steered)


class Guard:
    """A guard in virtual time, with the links its hovers went to."""

    def __init__(self, *links: Watched) -> None:
        self.state, self.now_ns = GuardState(), START_NS
        self.sent: list[tuple[float, int]] = []
        self.links = {one.vehicle.link_id or 0: one for one in links}
        self.pictures()

    def happens(self, event: object) -> "Guard":
        self.state, hovers = step(self.state, event, self.now_ns)  # type: ignore[arg-type]
        for hover in hovers:
            assert isinstance(hover.command.body, Hover)
            assert not hover.command.takeoff
            (link_id,) = hover.link_ids
            assert hover.command == Command(
                0,
                Hover(),
                "guard",
                self.now_ns,
                self.now_ns + seconds_to_ns(self.state.settings.repeat_s),
                link_id=link_id,
            )
            self.sent.append(((self.now_ns - START_NS) / S, link_id))
        return self

    def pictures(self) -> "Guard":
        """The station sends what it believes, with telemetry of this moment."""
        fresh = {
            n: replace(
                one,
                vehicle=replace(
                    one.vehicle,
                    is_flying=Stamped(one.vehicle.is_flying.value, self.now_ns),
                    reported_is_flying=Stamped(one.vehicle.reported_is_flying.value, self.now_ns),
                ),
            )
            for n, one in self.links.items()
        }
        return self.happens(Picture(fresh))

    def silent(self, seconds: float) -> "Guard":
        for _ in range(round(seconds * 20)):
            self.now_ns += S // 20
            self.happens(Tick())
        return self

    def beats(self, seconds: float) -> "Guard":
        for _ in range(round(seconds * 10)):
            self.silent(0.1).pictures()
        return self

    def links_sent(self) -> set[int]:
        return {link_id for _, link_id in self.sent}


def test_while_pictures_come_nothing_is_sent() -> None:
    guard = Guard(watched(1, steered=True), watched(2)).beats(60.0)
    assert guard.sent == []
    assert guard.state.interventions == ()


def test_a_silent_stations_steered_vehicles_are_held_and_no_others() -> None:
    guard = Guard(watched(1, steered=True), watched(2), watched(3, steered=True)).beats(5.0)
    guard.silent(0.95)
    assert guard.sent == []
    guard.silent(0.15)
    assert [link_id for _, link_id in guard.sent] == [1, 3]
    why = "the station was silent for 1 s"
    assert guard.state.interventions == (Intervention(why, ("V-1", "V-3"), ("Drone 1", "Drone 3")),)


def test_it_is_repeated_until_pictures_grow_too_old_for_the_gate() -> None:
    """Telemetry older than 3 s shows no flight: on the ground a hover takes off."""
    guard = Guard(watched(1, steered=True)).silent(20.0)
    times_s = [round(at_s, 2) for at_s, _ in guard.sent]
    assert times_s == [1.05, 1.75, 2.45]


def test_with_telemetry_of_its_own_each_link_gets_its_repeats_and_no_more() -> None:
    """Both links at once: a repeat of one takes none from the other."""
    guard = Guard(watched(1), watched(2)).happens(AllStopped("ann"))
    for number in range(100):
        reports = [CoreRead(n, jittered(core(height_m=20.0), number)) for n in (1, 2)]
        guard.silent(0.1).happens(reports[0]).happens(reports[1])
    times_s = sorted((link_id, round(at_s, 2)) for at_s, link_id in guard.sent)
    assert times_s == [(n, at_s) for n in (1, 2) for at_s in (0.0, 0.7, 1.4, 2.1)]


def test_a_station_that_ends_after_its_silence_is_acted_upon_once() -> None:
    guard = Guard(watched(1, steered=True)).silent(1.1).happens(StationEnded())
    assert len(guard.sent) == 1
    assert len(guard.state.interventions) == 1


def test_high_above_the_ground_nothing_goes_out_without_fresh_telemetry() -> None:
    """It knows no ground: from 100 m over a takeoff point the hill may be 5 m below."""
    high = watched(1)
    vehicle = replace(high.vehicle, height_above_takeoff_m=Stamped(100.0, START_NS))
    guard = Guard(replace(high, vehicle=vehicle)).silent(0.5).happens(StationEnded())
    guard.silent(4.0).happens(AllStopped("ann"))
    assert guard.sent == []
    assert guard.state.interventions[-1].refused == ("Drone 1",)


def test_one_false_report_of_the_ground_does_not_hide_a_flying_vehicle() -> None:
    """In the air is an estimate: the app's own flag says ground, and it is held all the same."""
    flying = watched(1)
    vehicle = replace(flying.vehicle, reported_is_flying=Stamped(False, START_NS))
    guard = Guard(replace(flying, vehicle=vehicle)).happens(AllStopped("ann"))
    assert guard.links_sent() == {1}


def test_a_station_that_speaks_again_ends_the_repeats_and_is_noted_once() -> None:
    guard = Guard(watched(1, steered=True)).silent(1.1).pictures()
    assert len(guard.sent) == 1
    guard.beats(5.0)
    assert len(guard.sent) == 1
    assert len(guard.state.interventions) == 1
    assert noted(guard.state).interventions == ()
    guard.silent(1.1)
    assert len(guard.sent) == 2


def test_a_station_that_never_spoke_is_not_missed() -> None:
    assert Guard().silent(30.0).state.interventions == ()


def test_a_vehicle_on_the_ground_is_not_held() -> None:
    guard = Guard(watched(1, flying=False, steered=True)).silent(2.0)
    assert guard.sent == []


def test_when_the_station_has_ended_steered_vehicles_are_held_at_once() -> None:
    guard = Guard(watched(1, steered=True), watched(2)).happens(StationEnded())
    assert guard.sent == [(0.0, 1)]
    assert guard.state.interventions[0].why == "the station has ended"


def test_after_its_end_own_telemetry_keeps_an_all_stop_possible() -> None:
    guard = Guard(watched(1), watched(2)).happens(StationEnded())
    for number in range(300):
        guard.silent(0.1).happens(CoreRead(1, jittered(core(height_m=20.0), number)))
    guard.happens(AllStopped("ann"))
    assert guard.links_sent() == {1}  # nothing is known of the other for half a minute
    intervention = guard.state.interventions[-1]
    assert (intervention.names, intervention.refused) == (("Drone 1",), ("Drone 2",))


def test_telemetry_of_an_unknown_link_changes_nothing() -> None:
    guard = Guard(watched(1)).happens(StationEnded())
    before = guard.state
    assert guard.happens(CoreRead(9, core())).state == before


def test_a_persons_all_stop_holds_everything_that_may_fly() -> None:
    guard = Guard(watched(1), watched(2, flying=False), watched(3, steered=True), watched(4))
    guard.happens(AllStopped("ann"))
    assert guard.links_sent() == {1, 3, 4}
    intervention = guard.state.interventions[-1]
    assert intervention == Intervention(
        "all stop at the guard",
        ("V-1", "V-3", "V-4"),
        ("Drone 1", "Drone 3", "Drone 4"),
        by="ann",
    )


def test_what_may_fly_is_named_but_no_takeoff_is_risked() -> None:
    guard = Guard(watched(1, flying=None)).happens(AllStopped("ann"))
    assert guard.sent == []
    assert guard.state.interventions[-1].refused == ("Drone 1",)


def test_a_link_that_has_gone_is_sent_nothing() -> None:
    guard = Guard(watched(1, steered=True), watched(2, steered=True)).happens(LinkGone(1))
    guard.silent(3.0)
    assert guard.links_sent() == {2}


def test_a_link_that_goes_during_its_repeats_ends_them() -> None:
    guard = Guard(watched(1, steered=True)).silent(1.1).happens(LinkGone(1)).silent(3.0)
    assert len(guard.sent) == 1


def test_what_was_done_is_bounded() -> None:
    guard = Guard(watched(1))
    for number in range(100):
        guard.happens(AllStopped(f"person {number}"))
    assert len(guard.state.interventions) == guard.state.settings.interventions_kept
    assert guard.state.interventions[-1].by == "person 99"
