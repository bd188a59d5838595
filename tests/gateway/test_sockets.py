"""The gateway's sockets: UDP clients that write first, and addresses that cannot be opened."""

import asyncio
import socket
from collections.abc import Callable, Coroutine
from typing import Any

import pytest
import uvloop
from pymavlink import mavutil
from tests.gateway.running_gateway import GCS, running_gateway
from tests.patient_loop import run_patiently

from recon.client import Station
from recon.gateway.endpoints import shown_endpoint
from recon.gateway.errors import GatewayError
from recon.gateway.mavlink.run import Endpoints, MavlinkGateway
from recon.gateway.mavlink.values import GatewaySettings

SET_MODE, DENIED = 176, 2


def test_a_udp_client_that_writes_first_is_shown_the_vehicles_and_answered() -> None:
    async def main() -> None:
        async with running_gateway(vehicles=1) as running:
            await asyncio.to_thread(_talk, running.udp_port)

    run_patiently(main())


def _talk(port: int) -> None:
    """Speak by pymavlink's own UDP, as its documents do."""
    client: Any = mavutil.mavlink_connection(f"udpout:127.0.0.1:{port}", source_system=GCS)
    try:
        client.mav.heartbeat_send(6, 8, 0, 0, 0)
        for name in ("HEARTBEAT", "GLOBAL_POSITION_INT"):
            assert client.recv_match(type=name, blocking=True, timeout=20.0).get_srcSystem() == 1
        client.mav.command_long_send(1, 1, SET_MODE, 0, 1, 4, 3, 0, 0, 0, 0)
        answer = client.recv_match(type="COMMAND_ACK", blocking=True, timeout=20.0)
        assert (answer.command, answer.result) == (SET_MODE, DENIED)
    finally:
        client.close()


@pytest.mark.parametrize("run", [asyncio.run, uvloop.run])
@pytest.mark.parametrize(
    ("option", "kind"), [("tcp", socket.SOCK_STREAM), ("udp", socket.SOCK_DGRAM)]
)
def test_a_taken_port_is_one_sentence(
    option: str, kind: socket.SocketKind, run: Callable[[Coroutine[Any, Any, None]], None]
) -> None:
    async def main() -> None:
        gateway = MavlinkGateway(Station("http://127.0.0.1:1"), GatewaySettings())
        with socket.socket(socket.AF_INET, kind) as other:
            other.bind(("127.0.0.1", 0))
            place = other.getsockname()
            with pytest.raises(GatewayError) as refused:
                async with gateway.listening(Endpoints(**{option: (place,)})):
                    pass
        assert str(refused.value) == (
            f"cannot open 127.0.0.1:{place[1]} (in use, perhaps by another gateway); "
            f"choose another with --{option}"
        )

    run(main())


def test_an_address_is_shown_as_it_is_given() -> None:
    assert shown_endpoint(("::1", 5760)) == "[::1]:5760"
