"""Topics in Foxglove's schemas, as protobuf: Foxglove and Lichtblick show them without a plug-in.

Grids begin at their lower left corner there, row by row upwards: rows are turned over. Positions on
the ground are east-north metres of the site's frame, which is called `site`.
"""

import json
from collections.abc import Iterable
from math import nan
from typing import Any

import numpy as np
from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from foxglove_schemas_protobuf.GeoJSON_pb2 import GeoJSON
from foxglove_schemas_protobuf.Grid_pb2 import Grid
from foxglove_schemas_protobuf.LocationFix_pb2 import LocationFix
from foxglove_schemas_protobuf.Log_pb2 import Log
from foxglove_schemas_protobuf.PackedElementField_pb2 import PackedElementField
from foxglove_schemas_protobuf.RawImage_pb2 import RawImage
from google.protobuf.descriptor_pb2 import FileDescriptorSet

from recon.model.geo import GroundGrid, LatLon
from recon.model.imagery import RgbImage
from recon.model.mission import Mission
from recon.model.shade import ShadeMap, SunForecast

ENCODING = "protobuf"
SITE_FRAME = "site"
SHADE_TOPIC, SUN_TOPIC, LOG_TOPIC = "/shade", "/forecast", "/log"
RAW_IMAGE: Any = RawImage
LENGTH_DELIMITED = 2
"""Protobuf's wire type of bytes."""

UINT8, FLOAT32 = PackedElementField.UINT8, PackedElementField.FLOAT32
LEVELS = {"debug": Log.DEBUG, "info": Log.INFO, "warning": Log.WARNING, "error": Log.ERROR}
_AUDIT_LEVELS = {"alarm.raised": "warning", "alarm.worse": "error", "order.failed": "error"}


def vehicle_topic(vehicle: str, what: str) -> str:
    """Return a topic of a vehicle: its location, image, jpeg or mission."""
    return f"/vehicles/{vehicle}/{what}"


def schema_of(message: Any) -> tuple[str, bytes]:
    """Return the name of a message's schema, and its description with all that it imports."""
    files = FileDescriptorSet()
    seen: set[str] = set()

    def add(descriptor: Any) -> None:
        if descriptor.name not in seen:
            seen.add(descriptor.name)
            for each in descriptor.dependencies:
                add(each)
            descriptor.CopyToProto(files.file.add())

    add(message.DESCRIPTOR.file)
    return message.DESCRIPTOR.full_name, files.SerializeToString()


def location(place: LatLon, height_m: float | None, frame_id: str, at_ns: int) -> Any:
    """Return where a vehicle is; the height is what its app reports as altitude, NaN if none."""
    fix = LocationFix(
        frame_id=frame_id,
        latitude=place.latitude_deg,
        longitude=place.longitude_deg,
        altitude=nan if height_m is None else height_m,
        position_covariance_type=LocationFix.UNKNOWN,
    )
    fix.timestamp.FromNanoseconds(at_ns)
    return fix


def raw_image_bytes(rgb: RgbImage, frame_id: str, at_ns: int) -> bytes:
    """Return a frame (H, W, 3) uint8 as it came, as the bytes of a RawImage.

    The pixels are put behind the other fields by hand: protobuf would copy them twice more, and a
    page of memory costs more than a page of pixels.
    """
    rows, cols = rgb.shape[:2]
    image = RawImage(frame_id=frame_id, width=cols, height=rows, encoding="rgb8", step=3 * cols)
    image.timestamp.FromNanoseconds(at_ns)
    pixels = np.ascontiguousarray(rgb)
    tag = RawImage.DESCRIPTOR.fields_by_name["data"].number << 3 | LENGTH_DELIMITED
    head = image.SerializeToString() + _varint(tag) + _varint(pixels.nbytes)
    return b"".join((head, pixels.data))


def _varint(number: int) -> bytes:
    parts = bytearray()
    while number > 127:
        parts.append(number & 127 | 128)
        number >>= 7
    return bytes((*parts, number))


def jpeg_image(jpeg: bytes, frame_id: str, at_ns: int) -> Any:
    """Return a JPEG as it came."""
    image = CompressedImage(frame_id=frame_id, data=jpeg, format="jpeg")
    image.timestamp.FromNanoseconds(at_ns)
    return image


def log(text: str, level: str, name: str, at_ns: int) -> Any:
    """Return a line of the log; `level` is debug, info, warning or error."""
    line = Log(level=LEVELS[level], message=text, name=name)
    line.timestamp.FromNanoseconds(at_ns)
    return line


def audit_log(kind: str, text: str, vehicle: str, at_ns: int) -> Any:
    """Return an audit entry as a line of the log; without a vehicle it is the station's."""
    return log(text, _AUDIT_LEVELS.get(kind, "info"), vehicle or "station", at_ns)


def shade_grid(shade: ShadeMap) -> Any:
    """Return a shade map: transmittance, confidence and metres per pixel, NaN where not valid.

    Its timestamp is that of the capture.
    """
    transmittance = np.where(shade.valid, shade.transmittance, np.float32(np.nan))
    layers = np.stack([transmittance, shade.confidence, shade.metres_per_pixel], axis=-1)
    names = ("transmittance", "confidence", "metres_per_pixel")
    fields = [(name, 4 * number, FLOAT32) for number, name in enumerate(names)]
    return _grid(shade.grid, layers.astype("<f4"), fields, shade.captured_at_ns)


def forecast_grid(sun: SunForecast) -> Any:
    """Return a forecast: the probability of sun at each lead, in 255ths, then the horizon in s.

    It is stamped when issued.
    """
    probability = np.moveaxis(sun.sun_probability, 0, -1)
    horizon = np.ascontiguousarray(sun.horizon_s, "<f4")[..., np.newaxis].view(np.uint8)
    layers = np.concatenate([probability, horizon], axis=-1)
    fields = [(f"sun_in_{lead_s:g}_s", n, UINT8) for n, lead_s in enumerate(sun.lead_s.tolist())]
    fields.append(("horizon_s", len(fields), FLOAT32))
    return _grid(sun.grid, layers, fields, sun.issued_at_ns)


def _grid(
    ground: GroundGrid, layers: Any, fields: Iterable[tuple[str, int, Any]], at_ns: int
) -> Any:
    cell_bytes = layers.shape[2] * layers.itemsize
    grid = Grid(
        frame_id=SITE_FRAME,
        column_count=ground.cols,
        row_stride=ground.cols * cell_bytes,
        cell_stride=cell_bytes,
        fields=[
            PackedElementField(name=name, offset=offset, type=kind) for name, offset, kind in fields
        ],
        data=np.ascontiguousarray(layers[::-1]).tobytes(),
    )
    grid.timestamp.FromNanoseconds(at_ns)
    grid.pose.position.x = ground.west_m
    grid.pose.position.y = ground.north_m - ground.rows * ground.cell_m
    grid.pose.orientation.w = 1.0
    grid.cell_size.x = grid.cell_size.y = ground.cell_m
    return grid


def mission_path(mission: Mission, serial: str | None) -> Any:
    """Return a mission as a line on the map, with the height of each waypoint above takeoff."""
    points = [
        [each.longitude_deg, each.latitude_deg, each.height_above_takeoff_m]
        for each in mission.waypoints
    ]
    shape = (
        {"type": "LineString", "coordinates": points}
        if len(points) > 1
        else {"type": "Point", "coordinates": points[0] if points else [0.0, 0.0]}
    )
    return GeoJSON(
        geojson=json.dumps(
            {"type": "Feature", "properties": {"name": serial or ""}, "geometry": shape}
        )
    )
