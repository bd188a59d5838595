"""What the faults of link, reader, aircraft and camera do."""

from itertools import pairwise
from math import inf, isnan
from random import Random

import numpy as np
import pytest

from recon import wire
from recon.model.units import NS_PER_S, seconds_to_ns
from recon.model.vehicle import AltitudeReference, FlightMode
from recon.sim.app.app import AppSettings, SimulatedApp
from recon.sim.app.camera_feed import CameraFeed, FeedSettings
from recon.sim.app.faults import FaultKind, InjectedFault
from recon.sim.camera.frames import CameraView
from recon.sim.flight.aircraft import Aircraft
from recon.sim.flight.flight_modes import PositionHold
from recon.sim.flight.kinematics import AircraftMotion

LAND = wire.EmergencyCommand(action=1)
HOVER = wire.EmergencyCommand(action=0)
MISSION = [(0.0, 10.0, 40.0), (200.0, 10.0, 40.0)]


def of(kind: type, packets: list) -> list:
    return [p for p in packets if isinstance(p, kind)]


@pytest.fixture
def faulty(app_bench):
    def make(kind: FaultKind, start_s: float = 0.0, duration_s: float = inf, **settings):
        fault = InjectedFault(kind, start_s=start_s, duration_s=duration_s)
        return app_bench(faults=(fault,), **settings)

    return make


def test_bursts_hold_back_and_lose_nothing(faulty) -> None:
    bench = faulty(FaultKind.BURSTS, duration_s=6.0)
    came = []
    for _ in range(1_000):
        came += [(bench.now_ns, p) for p in of(wire.CoreTelemetry, bench.run(0.01, 0.01))]
    assert len(came) == 100
    held = [ns for ns, _ in came if ns <= 6 * NS_PER_S]
    assert sorted(set(held)) == [seconds_to_ns(1.5 * n) for n in (1, 2, 3, 4)]
    later = [ns for ns, _ in came if ns > 6 * NS_PER_S]
    assert all(b - a == 100_000_000 for a, b in pairwise(later))


def test_what_is_held_back_is_announced(faulty) -> None:
    app = faulty(FaultKind.BURSTS).app
    app.advance(100_000_000)
    sent, now_ns = [], 0
    while now_ns < 3 * NS_PER_S:
        now_ns = app.next_due_ns
        sent += [now_ns] * len(app.advance(now_ns))
    assert {ns for ns in sent if ns <= 3 * NS_PER_S} == {1_500_000_000, 3_000_000_000}


def test_acknowledgments_are_late_and_execution_is_not(faulty) -> None:
    bench = faulty(FaultKind.DELAYED_ACKS)
    late_s = []
    for _ in range(40):
        assert of(wire.Acknowledgment, bench.send(HOVER)) == []
        sent_ns = bench.now_ns
        while not of(wire.Acknowledgment, bench.run(0.05)):
            assert bench.now_ns - sent_ns < 3.1 * NS_PER_S
        late_s.append((bench.now_ns - sent_ns) / NS_PER_S)
    assert min(late_s) >= 0.5
    assert max(late_s) > 2.0
    bench.send(LAND)
    bench.run(0.3)
    assert bench.app.aircraft.flight_mode is FlightMode.AUTO_LANDING


def test_missions_are_ignored_and_nothing_else(faulty, mission_packet) -> None:
    bench = faulty(FaultKind.IGNORED_MISSIONS)
    (answer,) = of(wire.Acknowledgment, bench.send(mission_packet(MISSION)))
    assert answer.positive == 1
    bench.run(2.0)
    assert bench.mode == FlightMode.GPS_ATTI
    bench.send(LAND)
    bench.run(1.0)
    assert bench.mode == FlightMode.AUTO_LANDING


def test_some_packets_are_corrupted_and_the_others_are_found(faulty) -> None:
    bench = faulty(FaultKind.CORRUPTED_BYTES)
    packets = of(wire.CoreTelemetry, bench.run(200.0))
    # One in ten, and now and then the one after it is lost with it; a few changes are not seen.
    assert 1_700 <= len(packets) < 1_900
    again = of(wire.CoreTelemetry, faulty(FaultKind.CORRUPTED_BYTES).run(200.0))
    assert [p.latitude_deg for p in packets] == [p.latitude_deg for p in again]


def test_a_slow_reader_answers_late_and_in_order(faulty, mission_packet) -> None:
    bench = faulty(FaultKind.SLOW_READER)
    points = [(10.0 * n, 0.0, 40.0) for n in range(1, 17)]
    assert of(wire.Acknowledgment, bench.send(mission_packet(points))) == []
    assert bench.send(HOVER) == []
    sent_ns, came = bench.now_ns, []
    while len(came) < 2:
        came += [(bench.now_ns, p) for p in of(wire.Acknowledgment, bench.run(0.1))]
        assert bench.now_ns - sent_ns < 10 * NS_PER_S
    assert [p.source_pid for _, p in came] == [253, 255]
    # 651 bytes and 10 bytes, 32 each tenth of a second.
    assert (came[0][0] - sent_ns) / NS_PER_S == pytest.approx(2.1, abs=0.15)


def test_a_slow_reader_has_its_socket_left_unread_and_loses_nothing(faulty) -> None:
    bench = faulty(FaultKind.SLOW_READER, duration_s=10.0)
    assert bench.app.takes_more()
    for _ in range(450):
        bench.app.receive(wire.encode(HOVER), bench.now_ns)
    assert not bench.app.takes_more()
    assert len(of(wire.Acknowledgment, bench.run(11.0))) > 100
    assert bench.app.takes_more()
    assert len(of(wire.Acknowledgment, bench.received)) == 450


def test_a_crashed_drone_sends_nothing_and_its_link_stays_open(faulty) -> None:
    bench = faulty(FaultKind.FALLS_SILENT, start_s=2.0)
    assert bench.run(1.9)
    bench.run(0.2)
    assert bench.run(20.0) == []
    assert bench.send(LAND) == []
    assert bench.app.take_link_orders() == []
    assert not bench.app.takes_more()
    assert bench.app.aircraft.motion.height_m == 0.0
    assert not bench.app.aircraft.is_flying


def test_a_crashed_drone_flies_no_mission_that_was_being_uploaded(faulty, mission_packet) -> None:
    bench = faulty(FaultKind.FALLS_SILENT, start_s=2.0)
    bench.run(1.9)
    assert bench.send(mission_packet(MISSION)) != []
    bench.run(30.0)
    assert bench.app.aircraft.motion.height_m == 0.0
    assert not bench.app.aircraft.is_flying


def test_a_lost_takeoff_altitude_is_nan_and_missions_by_it_are_rejected(
    faulty, mission_packet
) -> None:
    bench = faulty(
        FaultKind.TAKEOFF_ALTITUDE_LOST, duration_s=5.0, reference=AltitudeReference.WGS84
    )
    bench.run(1.0)
    core = bench.last(wire.CoreTelemetry)
    assert isnan(core.altitude_m)
    assert core.height_above_takeoff_m == pytest.approx(30.0, abs=0.6)
    bench.send(mission_packet([(n, e, 300.0) for n, e, _ in MISSION]))
    bench.run(1.0)
    assert bench.mode == FlightMode.GPS_ATTI
    bench.run(4.0)
    assert bench.last(wire.CoreTelemetry).altitude_m == pytest.approx(275.0 - 23.0 + 30.0, abs=1.0)


def test_a_stale_takeoff_altitude_jumps_when_it_is_set_right(faulty) -> None:
    bench = faulty(FaultKind.TAKEOFF_ALTITUDE_STALE, duration_s=3.0)
    offsets = [
        p.altitude_m - p.height_above_takeoff_m for p in of(wire.CoreTelemetry, bench.run(6.0))
    ]
    assert offsets[:29] == pytest.approx([275.0 - 23.0 + 47.0] * 29)
    assert offsets[-29:] == pytest.approx([275.0 - 23.0] * 29)


def test_gusts_push_raise_the_warning_and_end(faulty) -> None:
    bench = faulty(FaultKind.GUSTS, start_s=2.0, duration_s=40.0)
    speeds = [
        np.hypot(p.velocity_north_mps, p.velocity_east_mps)
        for p in of(wire.CoreTelemetry, bench.run(42.0))
    ]
    assert max(speeds[:19]) == 0.0
    assert max(speeds[20:]) > 0.3
    levels = [p.wind_level for p in of(wire.ExtendedTelemetry, bench.received)]
    assert levels[0] == 0
    bench.run(60.0)
    assert bench.last(wire.ExtendedTelemetry).wind_level == 0
    assert bench.app.aircraft.motion.ground_speed_mps < 0.01


def test_two_overlapping_losses_of_gnss_end_with_the_later(app_bench) -> None:
    faults = tuple(InjectedFault(FaultKind.GNSS_LOSS, "*", start_s, 5.0) for start_s in (1.0, 4.0))
    bench = app_bench(faults=faults)
    levels = [
        (bench.now_ns, p.gnss_signal_level) for p in of(wire.ExtendedTelemetry, bench.run(3.0))
    ]
    assert levels[-1][1] == 0
    bench.run(4.0)
    assert bench.last(wire.ExtendedTelemetry).gnss_signal_level == 0
    bench.run(3.0)
    assert bench.last(wire.ExtendedTelemetry).gnss_signal_level == 5


class Numbered:
    """Grey pictures whose first pixel is the picture's number, with a bright right half."""

    def prepare(self) -> None:
        return None

    def render(self, view: CameraView) -> np.ndarray:
        picture = np.full((36, 64, 3), 60, dtype=np.uint8)
        picture[:, 32:] = 120
        picture[0, 0] = view.number
        return picture


@pytest.fixture
def pictures(app_bench, flights):
    """Return a maker of the pictures that come in ten seconds, with a fault from 3 s to 6 s."""
    kind_of_bench = type(app_bench())

    def make(kind: FaultKind, duration_s: float = 3.0) -> list[np.ndarray]:
        aircraft = Aircraft(0, motion=AircraftMotion(height_m=100.0), active_mode=PositionHold())
        feed = CameraFeed(Numbered(), FeedSettings(2.0, latency_s=0.3), Random(5), 0)
        fault = InjectedFault(kind, "*", 3.0, duration_s)
        settings = AppSettings("SIM-IMAGER", flights.home, seed=4, faults=(fault,))
        bench = kind_of_bench(SimulatedApp(settings, aircraft, feed))
        return [p.pixels for p in of(wire.Image, bench.run(10.0))]

    return make


def numbers(pictures: list[np.ndarray]) -> list[int]:
    return [int(picture[0, 0, 0]) for picture in pictures]


def test_a_stopped_camera_sends_nothing_and_resumes(pictures) -> None:
    # Taken each half second, sent 0.3 s later: the twentieth is under way at the end.
    assert len(pictures(FaultKind.CAMERA_STOPS)) == 20 - 6
    assert len(pictures(FaultKind.CAMERA_STOPS, inf)) == 6


def test_the_frame_at_the_faults_start_is_repeated(pictures) -> None:
    assert numbers(pictures(FaultKind.FRAMES_REPEATED)) == [*range(6), *[5] * 6, *range(12, 20)]


def test_frames_are_black_while_the_fault_is_active(pictures) -> None:
    came = pictures(FaultKind.FRAMES_BLACK)
    assert [not picture.any() for picture in came] == [False] * 6 + [True] * 6 + [False] * 8


def test_torn_frames_are_intact_above_and_shifted_below(pictures) -> None:
    came = pictures(FaultKind.FRAMES_TORN)
    whole = Numbered().render(CameraView(0.0, 0, None))[1:]
    torn = came[6:12]
    assert all(not np.array_equal(picture[1:], whole) for picture in torn)
    assert all(np.array_equal(picture[1], whole[0]) for picture in torn)
    below = np.sort(whole[-1], axis=0)
    assert all(np.array_equal(np.sort(picture[-1], axis=0), below) for picture in torn)
    assert all(np.array_equal(picture[1:], whole) for picture in came[:6] + came[12:])


def test_exposure_jumps_scale_the_whole_frame(pictures) -> None:
    came = pictures(FaultKind.EXPOSURE_JUMPS)
    gains = [float(picture[-1, 0, 0]) / 60.0 for picture in came]
    assert gains[:6] == [1.0] * 6
    assert gains[12:] == [1.0] * 8
    assert all(gain in (0.35, 0.6, 1.7, 2.6) for gain in gains[6:12])
    assert len(set(gains[6:12])) > 1


def test_a_storm_of_all_faults_is_the_same_for_the_same_seed(app_bench, mission_packet) -> None:
    def stormy() -> bytes:
        kinds = [k for k in FaultKind if k is not FaultKind.FALLS_SILENT]
        faults = tuple(InjectedFault(kind, "*", 2.0 + n, 6.0) for n, kind in enumerate(kinds))
        bench, sent = app_bench(faults=faults), []
        for second in range(60):
            if second % 7 == 0:
                bench.app.receive(wire.encode(mission_packet(MISSION)), bench.now_ns)
            bench.now_ns += NS_PER_S
            sent += bench.app.advance(bench.now_ns)
            if bench.app.take_link_orders():
                bench.app.connected(bench.now_ns)
        return b"".join(sent)

    first = stormy()
    assert len(first) > 10_000
    assert first == stormy()
