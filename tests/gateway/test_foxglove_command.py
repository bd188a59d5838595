"""`recon gateway foxglove` as a process, beside a station with a real site."""

import asyncio
import json
import signal
import sys
from pathlib import Path
from typing import Any

import pytest
from foxglove_schemas_protobuf.GeoJSON_pb2 import GeoJSON
from tests.cli.processes import started
from tests.cli.station_process import station_process
from tests.gateway.foxglove_client import foxglove_client
from typer.testing import CliRunner

from recon.cli.commands import app


def test_it_shows_vehicles_and_site_until_it_is_stopped(tmp_path: Path) -> None:
    with station_process(tmp_path / "audit", 1) as station:
        words = ("gateway", "foxglove", "--listen", "127.0.0.1:0", "--station", station.url)
        with started(*words) as gateway:
            line = gateway.line_with("Foxglove clients: ws://127.0.0.1:")
            gateway.line_with("read-only")
            shapes = asyncio.run(_site(int(line.rpartition(":")[2])))
            site = station.get("/api/state")["site"]
            assert gateway.end(signal.SIGINT) == 0
            assert gateway.lines[-1] == "stopped"
    kinds = [each["kind"] for each in site["areas"]] + ["pad"] * len(site["pads"])
    assert [each["properties"]["kind"] for each in shapes] == kinds
    rings = [each["rings"] for each in site["areas"]]
    assert [each["geometry"]["coordinates"] for each in shapes][: len(rings)] == rings
    assert {"boundary", "keep_out", "survey"} <= set(kinds)


async def _site(port: int) -> list[Any]:
    async with foxglove_client(port) as client:
        await client.until("/vehicles/SIM-1/location")
        (message,) = (await client.until("/site"))[:1]
        shapes = json.loads(GeoJSON.FromString(message.data).geojson)
        assert shapes["type"] == "FeatureCollection"
        return list(shapes["features"])


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("--listen", "0.0.0.0:8765"), "--allow-network"),
        (("--listen", "[::]:8765"), "--allow-network"),
        (("--listen", "nowhere"), "HOST:PORT"),
        (("--listen", "127.0.0.1:1", "--station", "nonsense"), "expected an address"),
    ],
)
def test_what_it_does_not_start_with(words: tuple[str, ...], sentence: str) -> None:
    result = CliRunner().invoke(app, ["gateway", "foxglove", *words])
    assert sentence in result.output
    assert result.exit_code == 2


def test_a_missing_package_names_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in list(sys.modules):
        if name.startswith("recon.gateway.foxglove"):
            monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "foxglove", None)
    result = CliRunner().invoke(app, ["gateway", "foxglove"])
    assert "pip install 'recon-gcs[gateway]'" in result.output
    assert "a gateway for Foxglove needs the package foxglove" in result.output
    assert result.exit_code == 2
