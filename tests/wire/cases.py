"""What the tests of the wire share: the golden vectors and packets of any content."""

import json
from pathlib import Path
from typing import Any, NamedTuple

import hypothesis.strategies as st
import numpy as np

from recon import wire

VECTORS = Path(__file__).parents[2] / "vectors"


class Vector(NamedTuple):
    name: str
    data: bytes
    description: dict[str, Any]


def vectors(pattern: str) -> list[Vector]:
    return [
        Vector(
            f"{path.parent.name}/{path.stem}",
            path.read_bytes(),
            json.loads(path.with_suffix(".json").read_text("ascii")),
        )
        for path in sorted(VECTORS.glob(f"{pattern}.bin"))
    ]


GOLDEN = [vector for vector in vectors("*/*") if not vector.name.startswith("bad/")]
BAD = vectors("bad/*")

u8 = st.integers(0, 255)
f32 = st.floats(width=32)
f64 = st.floats()

waypoints = st.builds(
    wire.Waypoint,
    latitude_deg=f64,
    longitude_deg=f64,
    altitude_m=f64,
    corner_radius_m=f32,
    speed_mps=f32,
    loiter_time_s=f32,
    gimbal_pitch_deg=f32,
)

packets: st.SearchStrategy[wire.Packet] = st.one_of(
    st.builds(
        wire.CoreTelemetry,
        is_flying=u8,
        latitude_deg=f64,
        longitude_deg=f64,
        altitude_m=f64,
        height_above_takeoff_m=f64,
        velocity_north_mps=f32,
        velocity_east_mps=f32,
        velocity_down_mps=f32,
        yaw_deg=f64,
        pitch_deg=f64,
        roll_deg=f64,
    ),
    st.builds(
        wire.ExtendedTelemetry,
        gnss_satellite_count=st.integers(0, 65535),
        gnss_signal_level=st.integers(-128, 127),
        max_height_reached=u8,
        max_distance_reached=u8,
        battery_percent=u8,
        battery_warning=u8,
        wind_level=st.integers(-128, 127),
        camera_state=u8,
        flight_mode=u8,
        mission_id=st.integers(0, 65535),
        serial=st.binary(max_size=256),
    ),
    st.builds(
        lambda fps, rows, cols, value: wire.Image(
            target_fps_hz=fps, pixels=np.full((rows, cols, 3), value, np.uint8)
        ),
        f32,
        st.integers(0, 9),
        st.integers(0, 9),
        u8,
    ),
    st.builds(wire.Acknowledgment, positive=u8, source_pid=u8),
    st.builds(wire.MessageString, type=u8, text=st.binary(max_size=99)),
    st.builds(wire.CompressedImage, target_fps_hz=f32, jpeg=st.binary(max_size=99)),
    st.builds(wire.EmergencyCommand, action=u8),
    st.builds(wire.CameraControl, action=u8, target_fps_hz=f32),
    st.builds(
        wire.ExecuteWaypointMission,
        land_at_end=u8,
        curved_flight=u8,
        waypoints=st.lists(waypoints, min_size=1, max_size=5),
    ),
    st.builds(
        wire.VirtualStickCommand,
        mode=u8,
        yaw_deg=f32,
        velocity_x_mps=f32,
        velocity_y_mps=f32,
        height_above_takeoff_m=f32,
        timeout_s=f32,
    ),
    st.builds(wire.UnknownPacket, pid=st.integers(6, 251), payload=st.binary(max_size=99)),
)
