"""The ground's heights, and cameras over it."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from tests.product.made_flight import FRAME, HEIGHT_M, ONE, track
from tests.product.mosaic.made_mosaic import MadeMosaic

from recon.cli import mosaic
from recon.model.airspace import ElevationModel
from recon.model.errors import RecordError
from recon.model.geo import GeoPoint, GroundGrid, LocalFrame
from recon.product.mosaic import LevelGround, SiteGround, preview_cameras


def slope(east_m, north_m):
    """Above the ellipsoid: 5 % to the east, 2 % to the north, above the origin's 290 m."""
    return 290.0 + 3.0 + 0.05 * east_m + 0.02 * north_m


def site_ground(half_m: float = 400.0) -> SiteGround:
    count = round(2.0 * half_m / 10.0)
    grid = GroundGrid(FRAME, -half_m, half_m, 10.0, count, count)
    middles = -half_m + 10.0 * (np.arange(count) + 0.5)
    east, north = np.meshgrid(middles, middles[::-1])
    return SiteGround(ElevationModel(grid, slope(east, north)))


def test_heights_are_above_the_plane_at_the_origin() -> None:
    east, north = np.array([-150.0, 0.0, 300.0]), np.array([100.0, -200.0])
    easts, norths = np.meshgrid(east, north)
    # At 360 m the earth has fallen away by a centimetre.
    fallen = (easts**2 + norths**2) / (2.0 * 6.371e6)
    expected = slope(easts, norths) - 290.0 - fallen
    ground = site_ground()
    assert np.allclose(ground.up_m(east, north), expected, atol=1e-6)
    low, high = ground.bounds_m
    assert low < expected.min() < expected.max() < high


def test_cameras_are_as_high_above_takeoff_as_the_photos_state(tmp_path: Path) -> None:
    made, ground = MadeMosaic(tmp_path, ways=(ONE,), every=20), site_ground()
    views = [each.view for each in made.photos]
    flown = track(ONE)
    takeoff_m = float(slope(flown.east_m[0], flown.north_m[0]) - 290.0)
    for camera, view in zip(
        preview_cameras(made.flight, made.photos, views, ground), views, strict=True
    ):
        assert camera.place_m[2] == pytest.approx(takeoff_m + HEIGHT_M, abs=0.01)
        assert np.allclose(camera.place_m[:2], (view.aim.east_m, view.aim.north_m))
    level = preview_cameras(made.flight, made.photos, views, LevelGround())
    assert {camera.place_m[2] for camera in level} == {HEIGHT_M}


def test_a_takeoff_beyond_the_model_is_refused(tmp_path: Path) -> None:
    made = MadeMosaic(tmp_path, ways=(ONE,), every=20)
    views = [each.view for each in made.photos]
    with pytest.raises(RecordError, match="to where Drone 1 took off"):
        preview_cameras(made.flight, made.photos, views, site_ground(50.0))


def test_the_ground_of_another_site_is_not_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    site = SimpleNamespace(elevation=site_ground().model)
    monkeypatch.setattr(mosaic, "load_site", lambda _folder: site)
    own, _words = mosaic.site_ground(tmp_path, FRAME)
    assert isinstance(own, SiteGround)
    other, words = mosaic.site_ground(tmp_path, LocalFrame(GeoPoint(41.91, -93.6, 290.0)))
    assert (other, words) == (LevelGround(), "level ground")
    assert "the flight is of another site" in capsys.readouterr().err
