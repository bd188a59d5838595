"""`recon sim proxy` as it is called, and fault files given to `recon sim`."""

import asyncio
import signal
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from recon.cli.commands import app

LIMIT_S = 120.0


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--listen", "nowhere"], "--listen: expected HOST:PORT"),
        (["--station", "host:0"], "--station: expected HOST:PORT"),
        (["--delay-ms", "-1"], "delay: expected 0 to 60 seconds"),
        (["--rate-kb-s", "0"], "rate: expected 10 to inf bytes per second"),
        (["--corruption-per-mb", "1e9"], "corruption: expected"),
        (["--resets-per-min", "1e9"], "resets: expected"),
    ],
)
def test_bad_options_get_one_sentence_and_exit_code_2(options: list[str], words: str) -> None:
    result = CliRunner().invoke(app, ["sim", "proxy", *options])
    assert result.exit_code == 2
    assert result.stderr.startswith("recon sim: ")
    assert words in result.stderr
    assert len(result.stderr.splitlines()) == 1


def test_a_bad_fault_file_is_located_and_nothing_is_started(tmp_path: Path) -> None:
    file = tmp_path / "storm.toml"
    file.write_text("[[fault]]\nname = 'no-ack'\n\n[[chance]]\nname = 'gremlins'\n")
    result = CliRunner().invoke(app, ["sim", "--faults", str(file)])
    assert result.exit_code == 2
    assert f"{file}: line 4: per_hour: expected a number" in result.stderr
    assert result.stdout == ""


def test_a_proxy_passes_on_and_ends_politely() -> None:
    async def scenario() -> tuple[bytes, str, int | None]:
        received = asyncio.get_running_loop().create_future()

        async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            received.set_result(await reader.readexactly(5))
            writer.close()

        async with asyncio.timeout(LIMIT_S):
            station = await asyncio.start_server(serve, "127.0.0.1", 0)
            port = station.sockets[0].getsockname()[1]
            arguments = ("--listen", "127.0.0.1:0", "--station", f"127.0.0.1:{port}")
            process = await asyncio.create_subprocess_exec(
                sys.executable,
                "-m",
                "recon",
                "sim",
                "proxy",
                *arguments,
                stdout=asyncio.subprocess.PIPE,
            )
            try:
                assert process.stdout is not None
                first = (await process.stdout.readline()).decode()
                place = first.split()[2].rpartition(":")
                _, writer = await asyncio.open_connection(place[0], int(place[2]))
                writer.write(b"hello")
                data = await received
                process.send_signal(signal.SIGINT)
                rest, _ = await process.communicate()
                writer.close()
            finally:
                if process.returncode is None:
                    process.kill()
                    await process.wait()
            station.close()
        return data, first + rest.decode(), process.returncode

    data, output, code = asyncio.run(scenario())
    assert data == b"hello"
    assert output.startswith("listening on 127.0.0.1:")
    assert output.endswith("proxy ended\n")
    assert code == 0
