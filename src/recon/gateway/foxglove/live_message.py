"""Messages of topics, and the kinds of topics: what a client is told before the first message."""

from dataclasses import dataclass
from functools import cache
from typing import Any

from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from foxglove_schemas_protobuf.GeoJSON_pb2 import GeoJSON
from foxglove_schemas_protobuf.Grid_pb2 import Grid
from foxglove_schemas_protobuf.LocationFix_pb2 import LocationFix
from foxglove_schemas_protobuf.Log_pb2 import Log

from recon.record.mcap.foxglove import ENCODING, schema_of


@dataclass(frozen=True, slots=True)
class TopicKind:
    """Encoding and schema of a topic's messages; a protobuf schema is a `FileDescriptorSet`."""

    encoding: str
    schema_name: str
    schema_encoding: str
    schema: bytes


@cache
def protobuf_kind(message: Any) -> TopicKind:
    """Return the kind of a message class of Foxglove's schemas."""
    name, description = schema_of(message)
    return TopicKind(ENCODING, name, ENCODING, description)


LOCATION, JPEG, GEOJSON = map(protobuf_kind, (LocationFix, CompressedImage, GeoJSON))
GRID, LOG = map(protobuf_kind, (Grid, Log))


@dataclass(frozen=True, slots=True)
class LiveMessage:
    """A message of a topic, encoded, with its time in station time."""

    topic: str
    kind: TopicKind
    at_ns: int
    content: bytes
