"""Eight JVM companions survey a field for the real station."""

import asyncio
from pathlib import Path

import pytest
from tests.android.field import VEHICLES, serial
from tests.android.flying import vehicle
from tests.android.processes import IS_THOROUGH, companion_command, in_loop, running, station

from recon.client import Refusal, Station, SurveyStatus

PATIENCE_S = 900.0


@pytest.mark.skipif(not IS_THOROUGH, reason="takes minutes: make study-android")
@in_loop
async def test_eight_companions_survey_a_field(site: Path) -> None:
    async with (
        station(site) as base,
        running(*companion_command(base.link_port, "--vehicles", str(VEHICLES))) as app,
        Station(base.url) as client,
    ):
        serials = [serial(number) for number in range(1, VEHICLES + 1)]
        for name in serials:
            await vehicle(client, name)
        planned = await client.surveys.create(
            region="block", height_above_takeoff_m=40.0, speed_mps=5.0
        )
        assert not isinstance(planned, Refusal), planned
        started = await client.surveys.start(planned.id, serials, takeoff=True)
        assert not isinstance(started, Refusal), started
        ended, flown = await _ended(client, planned.id)
        print(ended.phase, ended.reason, ended.figures, sorted(flown))
        assert ended.figures is not None
        assert ended.figures.not_yet_m2 < 0.05 * ended.figures.region_m2
        assert flown == set(serials)
        assert not [line for line in app.lines if "error" in line]


async def _ended(client: Station, number: int) -> tuple[SurveyStatus, set[str]]:
    """Wait for a survey's end; return it with the serials that have flown rows."""
    flown: set[str] = set()
    async with asyncio.timeout(PATIENCE_S):
        while True:
            status = next(s for s in await client.surveys.list() if s.id == number)
            flown |= {v.serial for v in status.vehicles if v.is_flying_rows}
            if status.phase not in ("planning", "planned", "running", "flying"):
                return status, flown
            await asyncio.sleep(0.5)
