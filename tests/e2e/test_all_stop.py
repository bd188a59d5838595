"""All stop on real sockets: every flying link gets one hover for each, what stands gets nothing.

The clock stands still, so nothing is ever repeated and every packet is accounted for; how long it
takes is measured by benches/station/bench_all_stop.py.
"""

import asyncio
import json
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from benches.station.fake_apps import HoveringApp
from tests.persons import ANN

from recon import wire
from recon.link.server import LinkServer
from recon.link.settings import LinkSettings
from recon.record.audit.audit_log import AuditLog
from recon.site import default_site
from recon.station.api_views.service import Service
from recon.station.audit.auditor import Auditor, LogPrinter
from recon.station.kernel.build import first_state
from recon.station.kernel.driver import AsyncioDriver

FLYING, STANDING, UNIDENTIFIED, STREAMS, STOPS = 12, 4, 2, 3, 5
NOW_NS = 1_800_000_000_000_000_000
HOVER = 0
PATIENCE_S = 120.0


@dataclass(slots=True)
class Here:
    """A station on sockets, with its audit, and the apps that are connected to it."""

    service: Service
    log: AuditLog
    flying: list[HoveringApp]
    standing: list[HoveringApp]


@asynccontextmanager
async def station_with_apps(audit: Path) -> AsyncIterator[Here]:
    async with AsyncExitStack() as stack:
        log = AuditLog(audit)
        log.start()
        stack.callback(log.close)
        auditor = Auditor(log, LogPrinter(), lambda: NOW_NS)
        site = default_site()
        driver = AsyncioDriver(first_state(site), lambda: NOW_NS, auditor.observe)
        driver.links = links = LinkServer(driver.handle, driver.now_ns, LinkSettings())
        await links.start("127.0.0.1", 0)
        stack.push_async_callback(links.stop)
        image = wire.encode(wire.Image(target_fps_hz=5.0, pixels=np.zeros((90, 160, 3), np.uint8)))
        apps = [
            await connect(links.port, number, image if number < STREAMS else None, stack)
            for number in range(FLYING + STANDING + UNIDENTIFIED)
        ]
        flying = [app for app in apps if app.is_flying]
        service = Service.around(driver, site, None, log)
        yield Here(service, log, flying, [app for app in apps if not app.is_flying])


async def connect(
    port: int, number: int, image: bytes | None, stack: AsyncExitStack
) -> HoveringApp:
    is_flying = not FLYING <= number < FLYING + STANDING
    app = HoveringApp(number, image, is_flying)
    if number >= FLYING + STANDING:
        app.serial = b"00000"
    await asyncio.get_running_loop().create_connection(lambda: app, "127.0.0.1", port)
    task = asyncio.create_task(app.fly())
    stack.callback(task.cancel)
    return app


async def until(is_so: object) -> None:
    assert callable(is_so)
    async with asyncio.timeout(PATIENCE_S):
        while not is_so():
            await asyncio.sleep(0.01)


def test_each_flying_link_gets_one_hover_for_each_all_stop(tmp_path: Path) -> None:
    async def main() -> None:
        async with station_with_apps(tmp_path) as here:
            expected = FLYING + UNIDENTIFIED

            def are_known() -> bool:
                told = here.service.state().vehicles
                said = [v for v in told if v.is_flying.value is not None]
                named = sum(v.serial is not None for v in said)
                return len(said) == expected + STANDING and named == FLYING + STANDING

            await until(are_known)
            for stop in range(1, STOPS + 1):
                results = here.service.orders.all_stop(ANN).results
                assert sum(result.accepted for result in results) == expected
                assert {r.rule for r in results if not r.accepted} == {"flying"}
                await until(lambda stop=stop: all(len(a.stops) >= stop for a in here.flying))
            assert [len(app.stops) for app in here.flying] == [STOPS] * expected
            assert {action for app in here.flying for _, action in app.stops} == {HOVER}
            assert [len(app.stops) for app in here.standing] == [0] * STANDING
            assert sum(app.others for app in (*here.flying, *here.standing)) == 0

    asyncio.run(main())
    (path,) = tmp_path.glob("*.jsonl")
    lines = [json.loads(line) for line in path.read_text(encoding="ascii").splitlines()]
    sent = [line["details"]["id"] for line in lines if line["kind"] == "order.sent"]
    assert len(sent) == len(set(sent)) == STOPS * (FLYING + UNIDENTIFIED)
