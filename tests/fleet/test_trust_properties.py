"""Drawn flights: honest telemetry is never doubted, and no fault lands what flies."""

from hypothesis import given
from hypothesis import strategies as st
from tests.fleet.honest_flights import DrawnFlight, Sample, with_faults
from tests.fleet.reports import Story

from recon.model.event import PacketReceived
from recon.model.report import CoreReport

SETTLES_S = 2.0
HIGH_M = 3.0
UNSEEN_S = 3.0
"""Signs of flight count after a second of them."""


def received(story: Story, sample: Sample) -> None:
    story.at(sample.at_s).happens(PacketReceived(1, sample.report))


@given(st.integers(0, 10**6))
def test_honest_flights_are_believed(seed: int) -> None:
    flight, story = DrawnFlight(seed), Story().opens(1)
    was, since_s = False, 0.0
    for sample in flight.with_gaps():
        received(story, sample)
        if not isinstance(sample.report, CoreReport) or not story.fleet.vehicles:
            continue
        if sample.is_flying is not was:
            was, since_s = sample.is_flying, sample.at_s
        vehicle = story.vehicle()
        assert vehicle.trust.doubts == (), (sample, vehicle.trust)
        assert vehicle.core_received_at_ns == round(sample.at_s * 1e9)
        if sample.at_s - since_s > SETTLES_S:
            assert vehicle.is_flying.value is sample.is_flying, (sample, vehicle.trust)


@given(st.integers(0, 10**6), st.integers(0, 10**6))
def test_no_fault_lands_what_flies(seed: int, fault_seed: int) -> None:
    """Once flight was believed, at no packet; of a takeoff not reported, after some seconds."""
    flight, story = DrawnFlight(seed), Story().opens(1)
    was_believed, unseen_s = False, 0.0
    for sample in with_faults(flight.samples, fault_seed):
        received(story, sample)
        if not story.fleet.vehicles or not isinstance(sample.report, CoreReport):
            continue
        vehicle = story.vehicle()
        if not sample.is_flying:
            was_believed, unseen_s = False, 0.0
        was_believed = was_believed or (sample.is_flying and vehicle.is_flying.value is True)
        if sample.above_ground_m <= HIGH_M or vehicle.is_flying.value is not False:
            continue
        # Values frozen on the ground, or a hover at first contact, show nothing of a takeoff.
        is_new = vehicle.trust.changed_at_ns == round(sample.at_s * 1e9)
        velocity = sample.report.velocity_ned
        shows_flight = velocity is not None and velocity.speed_mps > 2.2
        is_believed = vehicle.core_received_at_ns == vehicle.trust.changed_at_ns
        unseen_s = unseen_s + 0.1 if shows_flight and is_new and is_believed else 0.0
        assert not was_believed, (sample, vehicle.trust)
        assert unseen_s < UNSEEN_S, (sample, vehicle.trust)
