"""`recon sim` as it is called: bad options in one sentence, a real run that ends politely."""

import asyncio
import signal
import sys
from functools import partial
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from recon import wire
from recon.cli.commands import app
from recon.cli.endpoints import host_and_port
from recon.cli.sim_options import parse_home, parse_size
from recon.model.errors import ReconError

LIMIT_S = 120.0


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--station", "nowhere"], "--station: expected HOST:PORT"),
        (["--station", "host:99999"], "--station: expected HOST:PORT"),
        (["--home", "north pole"], "--home: expected LAT,LON"),
        (["--home", "91,0"], "--home: expected LAT,LON"),
        (["--fps", "0"], "--fps: expected a positive number"),
        (["--latency-s", "-1"], "--latency-s: expected"),
        (["--endurance-min", "-5"], "--endurance-min: expected a positive number"),
        (["--fault", "gremlins"], "expected one of ack-then-nothing"),
        (["--fault", "no-ack:SIM-77"], "expected a vehicle of SIM-IMAGER"),
        (["--frames", "/no/such/folder"], "expected a folder of images"),
        (["--frames", "/", "--frame-size", "big"], "--frame-size: expected COLSxROWS"),
        (["--replay-site", "/no/such/folder"], "expected a folder with RefFrame.jpeg"),
        (["--replay-site", "/", "--frames", "/"], "--replay-site or --frames, got both"),
        (["--no-imager", "--frames", "/"], "--no-imager: expected neither"),
        (["--site", "/no/such/folder"], "Folder or site.toml not found"),
    ],
)
def test_bad_options_get_one_sentence_and_exit_code_2(options: list[str], words: str) -> None:
    result = CliRunner().invoke(app, ["sim", *options])
    assert result.exit_code == 2
    assert words in result.stderr
    assert result.stderr.startswith("recon sim: ")
    assert len(result.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    ("text", "expected"),
    [("127.0.0.1:3001", ("127.0.0.1", 3001)), ("[::1]:80", ("::1", 80)), ("a.b:1", ("a.b", 1))],
)
def test_stations(text: str, expected: tuple[str, int]) -> None:
    assert host_and_port("--station", text) == expected


@given(st.text(max_size=30))
def test_any_text_is_read_or_refused(text: str) -> None:
    for parse in (partial(host_and_port, "--station"), parse_home, parse_size):
        try:
            values: tuple[object, ...] = parse(text)
        except ReconError as problem:
            values = (str(problem), "expected")
        assert len(values) == 2


def test_sizes_and_homes() -> None:
    assert parse_size("640x360") == (640, 360)
    assert parse_home("41.9, -93.6") == (41.9, -93.6)


async def _listen_until_spoken_to(options: list[str]) -> tuple[list[wire.Packet], str, int]:
    """Run the command against a server; interrupt it after four serials and an image."""
    packets: list[wire.Packet] = []
    is_enough = asyncio.Event()

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        deframer = wire.Deframer()
        while data := await reader.read(65_536):
            packets.extend(deframer.feed(data))
            serials = {p.serial for p in packets if isinstance(p, wire.ExtendedTelemetry)}
            if len(serials) == 4 and any(isinstance(p, wire.Image) for p in packets):
                is_enough.set()
        writer.close()

    async with asyncio.timeout(LIMIT_S):
        server = await asyncio.start_server(serve, "127.0.0.1", 0)
        port = server.sockets[0].getsockname()[1]
        arguments = ["-m", "recon", "sim", "--station", f"127.0.0.1:{port}", *options]
        process = await asyncio.create_subprocess_exec(
            sys.executable, *arguments, stdout=asyncio.subprocess.PIPE
        )
        try:
            await is_enough.wait()
            process.send_signal(signal.SIGINT)
            output, _ = await process.communicate()
        finally:
            if process.returncode is None:
                process.kill()
                await process.wait()
        server.close()
    return packets, output.decode(), process.returncode


@pytest.mark.flight
def test_a_run_with_made_up_land_ends_politely() -> None:
    options = ["--fps", "5", "--latency-s", "0.05", "--airborne", "--wander"]
    packets, output, code = asyncio.run(_listen_until_spoken_to(options))
    assert code == 0
    assert "simulating SIM-IMAGER, SIM-1, SIM-2, SIM-3" in output
    assert output.endswith("simulation ended\n")
    image = next(p for p in packets if isinstance(p, wire.Image))
    assert image.pixels.shape == (720, 1280, 3)
    assert image.pixels[300:420, 560:720].std() > 3.0
    assert all(p.is_flying for p in packets if isinstance(p, wire.CoreTelemetry))


@pytest.mark.flight
def test_a_run_with_a_folder_of_frames(tmp_path: Path) -> None:
    picture = np.full((36, 64, 3), 77, dtype=np.uint8)
    assert cv2.imwrite(str(tmp_path / "one.png"), picture)
    options = ["--frames", str(tmp_path), "--frame-size", "64x36", "--latency-s", "0.05"]
    packets, _, code = asyncio.run(_listen_until_spoken_to(options))
    assert code == 0
    image = next(p for p in packets if isinstance(p, wire.Image))
    assert np.array_equal(image.pixels, picture)
