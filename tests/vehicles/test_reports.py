"""What an app's bytes mean: noisy values settled (decisions on the ICD, 8 to 13)."""

from dataclasses import fields
from math import inf, isfinite, nan

import pytest
from hypothesis import given
from hypothesis import strategies as st

from recon import wire
from recon.model.report import (
    AckReport,
    AnsweredKind,
    CoreReport,
    ExtendedReport,
    IgnoredReport,
    MessageReport,
    MessageSeverity,
)
from recon.model.vehicle import BatteryWarning, CameraState, FlightMode
from recon.vehicles.printable import printable
from recon.vehicles.reports import to_report, to_serial

CORE = {
    "is_flying": 1,
    "latitude_deg": 42.0,
    "longitude_deg": -93.6,
    "altitude_m": 300.0,
    "height_above_takeoff_m": 40.0,
    "velocity_north_mps": 1.0,
    "velocity_east_mps": 2.0,
    "velocity_down_mps": 3.0,
    "yaw_deg": 450.0,
    "pitch_deg": 5.0,
    "roll_deg": -5.0,
}
EXTENDED = {
    "gnss_satellite_count": 14,
    "gnss_signal_level": 4,
    "max_height_reached": 0,
    "max_distance_reached": 1,
    "battery_percent": 80,
    "battery_warning": 0,
    "wind_level": 1,
    "camera_state": 2,
    "flight_mode": 10,
    "mission_id": 7,
    "serial": b"0ABC",
}
CORE_FIELD = {
    "is_flying": "is_flying",
    "latitude_deg": "position",
    "longitude_deg": "position",
    "altitude_m": "reported_altitude_m",
    "height_above_takeoff_m": "height_above_takeoff_m",
    "velocity_north_mps": "velocity_ned",
    "velocity_east_mps": "velocity_ned",
    "velocity_down_mps": "velocity_ned",
    "yaw_deg": "attitude",
    "pitch_deg": "attitude",
    "roll_deg": "attitude",
}


def core(**changes: float) -> CoreReport:
    report = to_report(wire.CoreTelemetry(**{**CORE, **changes}))  # type: ignore[arg-type]
    assert isinstance(report, CoreReport)
    return report


def extended(**changes: object) -> ExtendedReport:
    report = to_report(wire.ExtendedTelemetry(**{**EXTENDED, **changes}))  # type: ignore[arg-type]
    assert isinstance(report, ExtendedReport)
    return report


class TestCore:
    def test_good_values_come_through_and_angles_in_any_range(self) -> None:
        report = core()
        assert report.is_flying is True
        assert report.position is not None
        assert report.attitude is not None
        assert report.attitude.yaw_deg == 450.0
        assert report.velocity_ned is not None
        assert report.velocity_ned.down_mps == 3.0

    @pytest.mark.parametrize("value", [nan, inf, -inf])
    @pytest.mark.parametrize("name", [name for name in CORE if name != "is_flying"])
    def test_what_is_not_finite_makes_its_field_unknown_and_no_other(
        self, name: str, value: float
    ) -> None:
        report = core(**{name: value})
        unknown = {f.name for f in fields(report) if getattr(report, f.name) is None}
        assert unknown == {CORE_FIELD[name]}

    def test_0_0_exactly_means_position_unknown(self) -> None:
        assert core(latitude_deg=0.0, longitude_deg=0.0).position is None
        assert core(latitude_deg=-0.0, longitude_deg=0.0).position is None
        assert core(latitude_deg=0.0).position is not None
        assert core(latitude_deg=1e-9, longitude_deg=0.0).position is not None

    @pytest.mark.parametrize(
        ("latitude_deg", "longitude_deg", "is_known"),
        [
            (90.0, 180.0, True),
            (-90.0, -180.0, True),
            (90.0001, 0.0, False),
            (-90.0001, 0.0, False),
            (1.0, 180.0001, False),
            (1.0, -180.0001, False),
        ],
    )
    def test_positions_off_the_globe_are_unknown(
        self, latitude_deg: float, longitude_deg: float, is_known: bool
    ) -> None:
        report = core(latitude_deg=latitude_deg, longitude_deg=longitude_deg)
        assert (report.position is not None) is is_known

    @pytest.mark.parametrize(("value", "means"), [(0, False), (1, True), (2, None), (255, None)])
    def test_is_flying(self, value: int, means: bool | None) -> None:
        assert core(is_flying=value).is_flying is means


class TestExtended:
    @pytest.mark.parametrize(
        ("field", "value", "name", "means"),
        [
            ("gnss_signal_level", -1, "gnss_signal_level", None),
            ("gnss_signal_level", 0, "gnss_signal_level", 0),
            ("gnss_signal_level", 10, "gnss_signal_level", 10),
            ("gnss_signal_level", 11, "gnss_signal_level", None),
            ("gnss_signal_level", -128, "gnss_signal_level", None),
            ("wind_level", -1, "wind_level", None),
            ("wind_level", 3, "wind_level", 3),
            ("battery_percent", 0, "battery_fraction", 0.0),
            ("battery_percent", 100, "battery_fraction", 1.0),
            ("battery_percent", 101, "battery_fraction", None),
            ("battery_percent", 255, "battery_fraction", None),
            ("battery_warning", 2, "battery_warning", BatteryWarning.SERIOUS),
            ("battery_warning", 3, "battery_warning", None),
            ("camera_state", 2, "camera_state", CameraState.FEED_ON),
            ("camera_state", 3, "camera_state", None),
            ("flight_mode", 0, "flight_mode", FlightMode.MANUAL),
            ("flight_mode", 25, "flight_mode", FlightMode.MOTORS_JUST_STARTED),
            ("flight_mode", 26, "flight_mode", None),
            ("flight_mode", 254, "flight_mode", None),
            ("flight_mode", 255, "flight_mode", FlightMode.OTHER),
            ("max_height_reached", 2, "max_height_reached", None),
            ("max_distance_reached", 2, "max_distance_reached", None),
        ],
    )
    def test_values_out_of_range_are_unknown(
        self, field: str, value: int, name: str, means: object
    ) -> None:
        assert getattr(extended(**{field: value}), name) == means

    @pytest.mark.parametrize("mode", range(26, 255))
    def test_flight_modes_26_to_254_are_unknown(self, mode: int) -> None:
        assert extended(flight_mode=mode).flight_mode is None

    @pytest.mark.parametrize("raw", [b"", b"00000", b"00000\0", b" 00000\n", b"\0\0", b"   "])
    def test_the_placeholder_serial_means_none(self, raw: bytes) -> None:
        assert extended(serial=raw).serial is None

    @pytest.mark.parametrize("raw", [b"0", b"0000", b"000000", b"00000A"])
    def test_nothing_else_is_a_placeholder(self, raw: bytes) -> None:
        assert extended(serial=raw).serial == raw.decode()


class TestAcknowledgments:
    @pytest.mark.parametrize("pid", [252, 253, 254, 255])
    @pytest.mark.parametrize("positive", [0, 1, 2, 255])
    def test_positive_other_than_1_is_a_refusal(self, pid: int, positive: int) -> None:
        report = to_report(wire.Acknowledgment(positive=positive, source_pid=pid))
        assert report == AckReport(AnsweredKind(pid), positive == 1)

    @pytest.mark.parametrize("pid", range(252))
    def test_source_pid_outside_252_to_255_is_ignored(self, pid: int) -> None:
        report = to_report(wire.Acknowledgment(positive=1, source_pid=pid))
        assert isinstance(report, IgnoredReport)


class TestOthers:
    def test_packets_of_the_wrong_direction_are_not_acted_on(self) -> None:
        packets: list[wire.Packet] = [
            wire.EmergencyCommand(action=1),
            wire.CameraControl(action=1, target_fps_hz=1.0),
            wire.UnknownPacket(pid=77, payload=b"x"),
        ]
        for packet in packets:
            assert isinstance(to_report(packet), IgnoredReport)

    def test_messages(self) -> None:
        report = to_report(wire.MessageString(type=2, text=b"low \x1b[31mbattery"))
        assert report == MessageReport(MessageSeverity.WARNING, "low \\x1b[31mbattery")
        assert isinstance(to_report(wire.MessageString(type=4, text=b"")), IgnoredReport)


@given(
    st.builds(
        wire.CoreTelemetry,
        is_flying=st.integers(0, 255),
        **{
            name: st.floats(width=32 if "mps" in name else 64)
            for name in CORE
            if name != "is_flying"
        },
    )
)
def test_whatever_core_telemetry_reports_what_is_known_is_finite(
    packet: wire.CoreTelemetry,
) -> None:
    report = to_report(packet)
    assert isinstance(report, CoreReport)
    numbers = [report.reported_altitude_m, report.height_above_takeoff_m]
    for parts in (report.position, report.velocity_ned, report.attitude):
        numbers += [] if parts is None else [getattr(parts, f.name) for f in fields(parts)]
    assert all(number is None or isfinite(number) for number in numbers)


@given(st.binary(max_size=256), st.binary(max_size=256))
def test_two_serials_are_never_taken_for_one(a: bytes, b: bytes) -> None:
    one, other = to_serial(a), to_serial(b)
    assert a == b or one is None or one != other


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("altitude_m", 20_001.0),
        ("height_above_takeoff_m", 1e300),
        ("height_above_takeoff_m", -20_001.0),
        ("velocity_north_mps", 151.0),
        ("velocity_down_mps", -3e38),
    ],
)
def test_what_no_drone_can_do_is_unknown(field: str, value: float) -> None:
    report = to_report(wire.CoreTelemetry(**{**CORE, field: value}))
    assert isinstance(report, CoreReport)
    reported = {
        "altitude_m": report.reported_altitude_m,
        "height_above_takeoff_m": report.height_above_takeoff_m,
        "velocity_north_mps": report.velocity_ned,
        "velocity_down_mps": report.velocity_ned,
    }
    assert reported[field] is None


@given(st.binary(max_size=400))
def test_nothing_unprintable_comes_out(raw: bytes) -> None:
    assert printable(raw).isprintable()


@given(st.binary(max_size=40), st.binary(max_size=40))
def test_two_inputs_never_look_the_same(a: bytes, b: bytes) -> None:
    assert (printable(a) == printable(b)) == (a == b)


@pytest.mark.parametrize(
    ("raw", "shown"),
    [
        (b"plain", "plain"),
        ("grün".encode(), "grün"),
        (b"\x1b[2J", "\\x1b[2J"),
        (b"a\nb", "a\\x0ab"),
        (b"\xff", "\\xff"),
        (b"\x80", "\\x80"),
        (b"\xc2\x80", "\\u0080"),
        ("\u202e".encode(), "\\u202e"),
        ("\U000e0001".encode(), "\\U000e0001"),
        (b"\\x1b", "\\\\x1b"),
    ],
)
def test_escapes(raw: bytes, shown: str) -> None:
    assert printable(raw) == shown


def test_long_text_ends_with_an_ellipsis() -> None:
    assert printable(b"a" * 11, limit_chars=10) == "a" * 10 + "…"
    assert printable(b"a" * 10, limit_chars=10) == "a" * 10
