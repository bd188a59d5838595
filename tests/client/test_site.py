"""The site's layers and vehicles from Python: read, checked, saved and undone."""

from pathlib import Path

import pytest
from tests.api.fake_station import FakeStation, application
from tests.api.serving import serving
from tests.patient_loop import run_patiently

from recon.client import Refusal, SiteDrawing, SiteFeature, SiteVehicle, SiteVehicles, Station
from recon.model.geo import GeoPoint
from recon.site import load_site
from recon.site.new_site import NewSiteFields, make_site

RING = [[-93.604, 41.901], [-93.602, 41.901], [-93.602, 41.903], [-93.604, 41.901]]


def region(*ring: list[float]) -> SiteFeature:
    geometry = {"type": "Polygon", "coordinates": [list(ring)]}
    return SiteFeature("survey_regions", geometry, {"name": "north"})


@pytest.fixture
def fake(tmp_path: Path) -> FakeStation:
    """A station that edits a new site's folder."""
    make_site(
        tmp_path,
        GeoPoint(41.9012, -93.6034, 275.0),
        NewSiteFields(name="field", drones=1, has_imager=False),
    )
    station = FakeStation(load_site(tmp_path))
    station.edit(tmp_path)
    return station


def test_layers_are_read_checked_saved_and_undone(fake: FakeStation, tmp_path: Path) -> None:
    async def main() -> None:
        async with serving(application(fake)) as url, Station(url) as station:
            site = station.site
            empty = await site.drawing()
            assert (empty.features, empty.locked_reason) == ((), None)
            assert await site.check([region(*RING)], empty.revision) is None
            saved = await site.save([region(*RING)], empty.revision)
            assert isinstance(saved, SiteDrawing)
            assert saved.features == (region(*RING),)
            assert list(load_site(tmp_path).layers.survey_regions) == ["north"]
            late = await site.save([], empty.revision)
            assert isinstance(late, Refusal)
            assert "changed meanwhile" in late.reason
            crossed = await site.check([region(RING[0], RING[1])], saved.revision)
            assert crossed is not None
            endless = await site.save([region([float("nan"), 0.0])], saved.revision)
            assert isinstance(endless, Refusal)
            assert endless.rule == "site_form"
            undone = await site.undo(saved.revision)
            assert isinstance(undone, SiteDrawing)
            assert undone.features == ()

    run_patiently(main())


def test_vehicles_are_read_and_saved(fake: FakeStation) -> None:
    async def main() -> None:
        async with serving(application(fake)) as url, Station(url) as station:
            site = station.site
            before = await site.vehicles()
            assert before.vehicles == (SiteVehicle("SIM-1", "Drone 1", 1, None, "takeoff"),)
            new = SiteVehicle("NEW-9", number=9)
            saved = await site.save_vehicles([*before.vehicles, new], before.revision)
            assert isinstance(saved, SiteVehicles)
            assert saved.vehicles == (*before.vehicles, new)
            wrong = SiteVehicle("NEW-9", camera="none such")
            refused = await site.save_vehicles([wrong], saved.revision)
            assert isinstance(refused, Refusal)
            assert "survey camera" in refused.reason

    run_patiently(main())
