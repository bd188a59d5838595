"""An imaging drone calibrated by points marked on a frozen frame: residuals, files, next frames."""

import json
import shutil
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from tests.api.client import Client
from tests.api.fake_station import FakeStation, application

from recon.camera import mounted_pose
from recon.geo import enu_from_geo, geo_from_enu
from recon.model.imagery import Frame, TelemetryReference
from recon.site import Imager, demo_site_folder, load_site
from recon.station.state.imaging import ImagerSample

SERIAL = "SIM-IMAGER"
# Where the camera is when the frame is taken; it looks 6 degrees off straight down.
TRUTH = TelemetryReference(41.9013, -93.6036, 110.0, 50.0)
PLACES_M = [(-90.0, 60.0), (60.0, 70.0), (60.0, -60.0), (-50.0, -50.0), (10.0, 5.0), (90.0, 10.0)]
NONE_SEEN = {"accepted": False, "rms_px": None, "residuals": []}


@dataclass
class Marker:
    """A person who marks points."""

    folder: Path
    station: FakeStation
    client: Client = field(init=False)
    frame_id: int = 0

    def __post_init__(self) -> None:
        self.station.edit(self.folder)
        self.client = Client(application(self.station))

    def freeze(self, scale: int = 1) -> dict[str, Any]:
        """Freeze a frame of the lens's size times `scale`, taken at `TRUTH`."""
        driver = self.station.driver
        ok, jpeg = cv2.imencode(".jpg", np.zeros((720 * scale, 1280 * scale, 3), np.uint8))
        assert ok
        frame = Frame(7, SERIAL, driver.now_ns(), driver.now_ns(), 0.0, jpeg=jpeg.tobytes())
        imaging = driver.station.imaging
        imager = replace(imaging.imagers[SERIAL], samples=(ImagerSample(driver.now_ns(), TRUTH),))
        driver.station = replace(
            driver.station,
            frames={SERIAL: frame},
            imaging=replace(imaging, imagers={**imaging.imagers, SERIAL: imager}),
        )
        view: dict[str, Any] = self.post("/freeze", {"serial": SERIAL})
        self.frame_id = view["frame_id"]
        return view

    def post(self, end: str, body: dict[str, Any]) -> dict[str, Any]:
        answer: dict[str, Any] = self.client.post(f"/api/site/calibration{end}", json=body).json()
        return answer

    def fit(self, points: list[dict[str, Any]], end: str = "/fit") -> dict[str, Any]:
        return self.post(end, {"serial": SERIAL, "frame_id": self.frame_id, "points": points})

    def points(self, places_m: list[tuple[float, float]], scale: int = 1) -> list[dict[str, Any]]:
        """Return the points as the true camera sees them, on a frame of that scale."""
        site = self.station.site
        imager, frame = site.imagers[SERIAL], site.frame
        assert frame is not None
        origin_m = frame.origin.ellipsoid_height_m
        at_m = enu_from_geo(frame, TRUTH.latitude_deg, TRUTH.longitude_deg, origin_m)[0]
        pose = mounted_pose(TRUTH, np.array([at_m[0], at_m[1], 110.0]), 6.0)
        ground_m = np.column_stack([np.array(places_m), np.zeros(len(places_m))])
        rays = (ground_m - pose.position_enu_m) @ pose.rotation_enu_camera
        pixels = (imager.camera.project(rays) + 0.5) * scale - 0.5
        latitude_deg, longitude_deg, _ = geo_from_enu(frame, ground_m)
        return [
            {
                "name": f"P{number}",
                "latitude_deg": float(lat),
                "longitude_deg": float(lon),
                "col_px": float(col),
                "row_px": float(row),
            }
            for number, (lat, lon, (col, row)) in enumerate(
                zip(latitude_deg, longitude_deg, pixels, strict=True), start=1
            )
        ]

    def imager(self) -> Imager:
        return load_site(self.folder).imagers[SERIAL]


@pytest.fixture
def marker(tmp_path: Path) -> Marker:
    folder = tmp_path / "field"
    shutil.copytree(demo_site_folder(), folder)
    return Marker(folder, FakeStation(load_site(folder)))


@pytest.mark.parametrize("scale", [1, 2])
def test_exact_points_give_the_true_camera_and_one_that_is_off_its_own_residual(
    marker: Marker, scale: int
) -> None:
    view = marker.freeze(scale)
    assert (view["accepted"], view["cols"], view["rows"]) == (True, 1280 * scale, 720 * scale)
    picture = marker.client.get(f"/api/site/calibration/frame.jpg?serial={SERIAL}")
    assert picture.headers["X-Frame-Id"] == "7"
    points = marker.points(PLACES_M, scale)
    found = marker.fit(points)
    assert (found["accepted"], found["reason"]) == (True, None)
    assert found["rms_px"] < 1e-3
    assert found["height_above_ground_m"] == pytest.approx(110.0, abs=0.01)
    assert found["tilt_deg"] == pytest.approx(6.0, abs=0.01)
    points[4]["col_px"] += 8.0
    found = marker.fit(points)
    sizes = {r["name"]: float(np.hypot(r["col_px"], r["row_px"])) for r in found["residuals"]}
    assert max(sizes, key=lambda name: sizes[name]) == "P5"
    assert 3.0 < sizes["P5"] < 8.0
    assert found["rms_px"] == pytest.approx(
        float(np.sqrt(np.mean(np.square(list(sizes.values())))))
    )


def test_accepted_points_are_saved_in_force_and_undone(marker: Marker) -> None:
    before = (marker.folder / "site.toml").read_text()
    old = marker.imager()
    marker.freeze()
    answer = marker.fit(marker.points(PLACES_M), end="")
    assert (answer["accepted"], answer["reason"]) == (True, None)
    saved = marker.imager()
    assert saved.solution is not None
    assert (len(saved.solution.residuals), saved.marked_frame) == (len(PLACES_M), TRUTH)
    in_force = marker.station.driver.station.imaging.imagers[SERIAL]
    assert in_force.reference == TRUTH
    assert in_force.marked_pose is not None
    assert np.allclose(in_force.marked_pose.position_enu_m, saved.marked_pose.position_enu_m)
    # Lens, image circle and comments stay.
    assert saved.image_circle == old.image_circle
    after = (marker.folder / "site.toml").read_text()
    assert "max_height_above_ground_m = 130.0  # the imaging drone hovers at 120 m" in after
    drawing = marker.client.get("/api/site/drawing").json()
    assert drawing["undo"]["what"] == "calibration"
    undone = marker.client.post(
        "/api/site/drawing/undo", json={"revision": drawing["revision"]}
    ).json()
    assert (undone["accepted"], undone["also"]) == (True, ["calibration"])
    assert (marker.folder / "site.toml").read_text() == before
    in_force = marker.station.driver.station.imaging.imagers[SERIAL]
    assert in_force.reference == old.marked_frame


def test_a_camera_placed_by_telemetry_gets_its_points(marker: Marker) -> None:
    text = (marker.folder / "site.toml").read_text()
    head, _, rest = text.partition("control_points = ")
    rest = rest[rest.index("[imager.image_circle]") :]
    placed = f'{head}placed_by = "telemetry"  # no points yet\n\n{rest}'
    (marker.folder / "site.toml").write_text(placed)
    (marker.folder / "GCPs.txt").unlink()
    marker = Marker(marker.folder, FakeStation(load_site(marker.folder)))
    assert marker.freeze()["surveyed"] == []
    assert marker.fit(marker.points(PLACES_M), end="")["accepted"]
    saved = marker.imager()
    assert (saved.solution is not None, saved.marked_frame) == (True, TRUTH)


def test_surveyed_points_are_offered_without_pixels(marker: Marker) -> None:
    surveyed = marker.freeze()["surveyed"]
    assert len(surveyed) == 8
    assert {one["col_px"] for one in surveyed} == {None}
    answer = marker.fit(surveyed)
    assert (
        answer["reason"]
        == f"control point {surveyed[0]['name']}: mark it on the frame, or delete it"
    )


@pytest.mark.parametrize(
    ("places_m", "expected"),
    [
        (PLACES_M[:3], "expected at least 4 control points, got 3"),
        ([(10.0 * n, 5.0 * n) for n in range(-3, 4)], "got points on one line"),
    ],
)
def test_points_that_give_no_pose_say_so_and_save_nothing(
    marker: Marker, places_m: list[tuple[float, float]], expected: str
) -> None:
    before = (marker.folder / "GCPs.txt").read_text()
    marker.freeze()
    for end in ("/fit", ""):
        answer = marker.fit(marker.points(places_m), end)
        assert {key: answer[key] for key in NONE_SEEN} == NONE_SEEN
        assert expected in answer["reason"]
    assert (marker.folder / "GCPs.txt").read_text() == before


def test_a_bad_fit_names_the_worst_point(marker: Marker) -> None:
    marker.freeze()
    points = marker.points(PLACES_M)
    points[0]["col_px"], points[1]["col_px"] = points[1]["col_px"], points[0]["col_px"]
    assert (
        "points are swapped, or the camera file is of another lens" in marker.fit(points)["reason"]
    )


@pytest.mark.parametrize("name", ["a, b", "", "x" * 40, "a\nb", "#"])
def test_a_name_that_the_file_cannot_hold_is_refused(marker: Marker, name: str) -> None:
    marker.freeze()
    points = marker.points(PLACES_M)
    points[2]["name"] = name
    assert not marker.fit(points)["accepted"]


@pytest.mark.parametrize("key", ["col_px", "row_px", "latitude_deg", "longitude_deg", "altitude_m"])
@pytest.mark.parametrize("value", ["1e9", "-1e300", "1e999"])
def test_numbers_of_no_point_are_refused(marker: Marker, key: str, value: str) -> None:
    marker.freeze()
    points = marker.points(PLACES_M)
    points[2][key] = float(value)
    # As a hostile client sends it: JSON with numbers that are not finite.
    text = json.dumps({"serial": SERIAL, "frame_id": marker.frame_id, "points": points})
    response = marker.client.post(
        "/api/site/calibration/fit", content=text, headers={"content-type": "application/json"}
    )
    assert response.status_code == 422 or not response.json()["accepted"]


def test_without_a_frame_or_telemetry_nothing_is_frozen(marker: Marker) -> None:
    assert "switch its camera on" in marker.post("/freeze", {"serial": SERIAL})["reason"]
    assert "no imaging drone of this site" in marker.post("/freeze", {"serial": "SIM-1"})["reason"]
    assert marker.fit([])["reason"] == "Freeze a frame of the imaging drone first"
    marker.freeze()
    marker.station.now_ns += 10_000_000_000
    frame = replace(
        marker.station.driver.station.frames[SERIAL], captured_at_ns=marker.station.now_ns
    )
    marker.station.put_frame(SERIAL, frame)
    assert "No telemetry" in marker.post("/freeze", {"serial": SERIAL})["reason"]
