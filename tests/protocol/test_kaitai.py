"""protocol/recon-drone.ksy alone, compiled by Kaitai's own compiler, reads the golden packets."""

import hashlib
import json
import shutil
import struct
import subprocess
import types
from collections.abc import Mapping
from typing import Any

import kaitaistruct
import pytest
import yaml
from tests.wire.cases import BAD, GOLDEN, Vector
from tools.protocol_descriptions import FOLDER, descriptions

COMPILER = FOLDER.parent / "web" / "node_modules" / "kaitai-struct-compiler"
COMPILE = """
const compiler = require(process.argv[1]);
const description = JSON.parse(require("fs").readFileSync(0));
compiler.compile("python", description, null, false)
    .then((files) => process.stdout.write(files["recon_drone.py"]));
"""
STOPPED = (kaitaistruct.KaitaiStructError, EOFError)
UNCHECKED = {"hash_a", "hash_b", "one_bit"}
"""Bad frames that differ in their hash alone."""


@pytest.fixture(scope="module")
def parser() -> types.ModuleType:
    """The parser that is made of the description, as a module."""
    if not COMPILER.exists() or shutil.which("node") is None:
        pytest.skip("Kaitai's compiler is not here: `make web/node_modules/.stamp` installs it")
    description = yaml.safe_load((FOLDER / "recon-drone.ksy").read_text("utf-8"))
    done = subprocess.run(
        ["node", "-e", COMPILE, str(COMPILER)],
        input=json.dumps(description),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    made = types.ModuleType("recon_drone")
    exec(done.stdout, made.__dict__)
    return made


def read(parser: types.ModuleType, data: bytes) -> list[Any]:
    packets: list[Any] = parser.ReconDrone.from_bytes(data).packets
    return packets


def as_vector(value: Any, stated: Any) -> Any:
    """Return a parser's value in the form of a vector: floats and texts as hex of their bytes."""
    if isinstance(value, bytes):
        return value.hex()
    if isinstance(value, float):
        packed = struct.pack(">f" if len(stated) == 8 else ">d", value)
        return stated if is_nan(stated) and value != value else packed.hex()
    return int(getattr(value, "value", value))


def is_nan(bits: str) -> bool:
    """Whether these bits are those of a NaN, of which Python keeps no payload."""
    value = struct.unpack(">f" if len(bits) == 8 else ">d", bytes.fromhex(bits))[0]
    return bool(value != value)


def check_fields(read: Any, fields: Mapping[str, Any]) -> None:
    for name, stated in fields.items():
        if name == "waypoints":
            for waypoint, its_fields in zip(read.waypoints, stated, strict=True):
                check_fields(waypoint, its_fields)
        elif name.endswith("_sha256"):
            data = getattr(read, name.removesuffix("_sha256"))
            assert hashlib.sha256(data).hexdigest() == stated
        else:
            assert as_vector(getattr(read, name), stated) == stated, name


def test_every_golden_packet_has_its_fields(parser: types.ModuleType) -> None:
    for vector in GOLDEN:
        (packet,) = read(parser, vector.data)
        check_fields(packet, {"size": len(vector.data), "pid": vector.description["pid"]})
        assert bytes((packet.hash_a, packet.hash_b)) == vector.data[-2:]
        check_fields(packet.payload, vector.description["fields"])


def test_a_stream_is_read_to_its_end(parser: types.ModuleType) -> None:
    packets = read(parser, b"".join(vector.data for vector in GOLDEN))
    assert len(packets) == len(GOLDEN)


@pytest.mark.parametrize(
    "vector", [v for v in BAD if v.description["decode"] and v.data], ids=lambda v: v.name
)
def test_what_is_no_packet_is_refused_unless_its_hash_alone_is_wrong(
    parser: types.ModuleType, vector: Vector
) -> None:
    if vector.name.removeprefix("bad/") in UNCHECKED:
        assert len(read(parser, vector.data)) == 1
    else:
        with pytest.raises(STOPPED):
            read(parser, vector.data)


def test_the_files_are_made_of_the_table() -> None:
    for name, text in descriptions().items():
        assert text == (FOLDER / name).read_text("utf-8"), f"{name} is old: make docs"
