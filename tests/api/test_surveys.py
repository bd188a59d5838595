"""Surveys and shade by HTTP: requests, refusals, answers and pictures."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from tests.api.client import Client
from tests.api.fake_station import FakeStation, application
from tests.ready import ready_profile, ready_site
from tests.station.imagers import with_imagers
from tests.station.imaging.test_shade_line import ground_image
from tests.station.station_world import HOME

from recon.api.pictures import cells_png, cells_values_png
from recon.detection import DetectionState, RejectedFrame
from recon.detection.frame_step import FrameFault
from recon.forecast import ForecastSettings, ForecastState
from recon.forecast.persistence import persisting
from recon.geo import geo_from_enu
from recon.model.geo import GroundGrid, LocalFrame
from recon.model.shade import ShadeMap, SunForecast
from recon.station.api_views.imaging_views import shade_view
from recon.station.imaging.shade import READ_SHADE, ShadeRead, on_ground_image
from recon.station.state.imaging import SeenShade, ShadePipeline
from recon.station.state.station import Station
from recon.station.state.steps import JobDone

FRAME = LocalFrame(HOME)


def ring(*places_m: tuple[float, float]) -> list[list[float]]:
    points = np.array([(*place, 0.0) for place in (*places_m, places_m[0])])
    latitude, longitude, _ = geo_from_enu(FRAME, points)
    return [[float(lon), float(lat)] for lon, lat in zip(longitude, latitude, strict=True)]


SQUARE = ring((0.0, 0.0), (120.0, 0.0), (120.0, 80.0), (0.0, 80.0))
ASKED = {"name": "field", "polygon": [SQUARE], "height_above_takeoff_m": 40.0, "speed_mps": 5.0}


@pytest.fixture
def station() -> FakeStation:
    return FakeStation(ready_site(HOME, [ready_profile("A", HOME)]))


@pytest.fixture
def client(station: FakeStation) -> Client:
    return Client(application(station))


STARTS = {
    "kmz": b"PK",
    "plan": b"{",
    "survey.plan": b"{",
    "waypoints": b"QGC WPL 110",
    "csv": b"latitude,",
    "kml": b"<?xml",
    "gpx": b"<?xml",
}
"""How a file of each kind begins."""


class TestAsked:
    def test_it_is_answered_with_its_rows_worked_out(self, client: Client) -> None:
        answer = client.post("/api/surveys", json=ASKED).json()
        assert answer["accepted"]
        survey = answer["survey"]
        assert survey["phase"] == "created"
        assert survey["rows"] >= 4
        assert survey["figures"]["region_m2"] == pytest.approx(9_600.0, rel=0.05)
        assert survey["figures"]["not_yet_m2"] == survey["figures"]["region_m2"]
        assert client.get("/api/surveys").json() == [survey]
        assert client.get(f"/api/surveys/{survey['id']}").json() == survey

    def test_an_imaging_drone_decides_which_planner_is_usual(
        self, client: Client, station: FakeStation
    ) -> None:
        def planner(**asked: str) -> str:
            answer = client.post("/api/surveys", json={**ASKED, **asked}).json()
            return str(answer["survey"]["planner"])

        assert planner() == "lawnmower_once"
        station.driver.station = with_imagers(station.driver.station, "IMAGER")
        assert planner() == "sunlit_first"
        assert planner(planner="lawnmower_again") == "lawnmower_again"

    def test_what_it_will_take_is_known_before_the_start(
        self, client: Client, station: FakeStation
    ) -> None:
        camera = {"model": "mini3pro", "interval_s": 2.0}
        survey = client.post("/api/surveys", json={**ASKED, "camera": camera}).json()["survey"]
        before = station.state().model_copy(update={"time_ns": 0})
        view = client.get(f"/api/surveys/{survey['id']}/estimate").json()
        assert view["refusal"] is None
        assert view["gsd_m"] == pytest.approx(0.0138, rel=0.01)
        assert view["rows"] == survey["rows"]
        assert view["region_m2"] == pytest.approx(survey["figures"]["region_m2"])
        assert view["photos"] > 40
        assert view["photos_in_all"] > view["photos"]
        assert 120.0 < view["time_s"] == view["flown_s"] < 600.0
        assert view["batteries"] is None  # no vehicle, so no endurance
        assert [drone["serial"] for drone in view["drones"]] == [None]
        assert view["warnings"] == []
        assert station.state().model_copy(update={"time_ns": 0}).surveys == before.surveys

    def test_what_one_would_take_is_estimated_and_nothing_is_kept(
        self, client: Client, station: FakeStation
    ) -> None:
        asked = {**ASKED, "camera": {"model": "mini3pro", "interval_s": 2.0}}
        drafted = client.post("/api/surveys/estimate", json=asked).json()
        assert station.state().surveys == []
        survey = client.post("/api/surveys", json=asked).json()["survey"]
        view = client.get(f"/api/surveys/{survey['id']}/estimate").json()
        assert drafted == {**view, "survey_id": 0}
        refused = client.post("/api/surveys/estimate", json={**asked, "front_overlap": 1.5})
        assert refused.status_code == 422
        assert "overlap" in refused.json()["error"]

    def test_an_estimate_of_an_unknown_vehicle_or_survey_is_refused(self, client: Client) -> None:
        survey = client.post("/api/surveys", json=ASKED).json()["survey"]
        view = client.get(f"/api/surveys/{survey['id']}/estimate?serial=Z").json()
        assert view["refusal"] == "Vehicle 'Z' not found"
        assert view["time_s"] is None
        assert client.get("/api/surveys/999/estimate").status_code == 404

    def test_its_flights_are_downloaded_for_other_programs(self, client: Client) -> None:
        survey = client.post("/api/surveys", json=ASKED).json()["survey"]
        root = f"/api/surveys/{survey['id']}"
        view = client.get(f"{root}/exports?aircraft=Matrice%20350&payload=H20T").json()
        formats = {each["kind"]: each for each in view["formats"]}
        assert {each["refusal"] for each in formats.values()} == {None}
        assert formats["kmz"]["by_hand"] == []
        assert any("lost signal" in sentence for sentence in formats["csv"]["by_hand"])
        assert {"name": "Mavic 3E", "payloads": []} in view["aircraft"]
        for kind, start in STARTS.items():
            answer = client.get(f"{root}/plan.{kind}?aircraft=Mavic%203E")
            assert answer.status_code == 200
            assert answer.content.startswith(start)
            name = f'attachment; filename="survey-{survey["id"]}.{kind}"'
            assert answer.headers["content-disposition"] == name

    def test_what_cannot_be_downloaded_is_a_sentence(self, client: Client) -> None:
        survey = client.post("/api/surveys", json=ASKED).json()["survey"]
        root = f"/api/surveys/{survey['id']}"
        answer = client.get(f"{root}/plan.kmz")
        assert answer.status_code == 422
        assert answer.json()["error"].startswith("a .kmz names its aircraft: choose one of Mavic")
        kmz, *others = client.get(f"{root}/exports").json()["formats"]
        assert (kmz["kind"], kmz["files"], kmz["refusal"]) == ("kmz", 0, answer.json()["error"])
        assert {each["files"] for each in others} == {1}
        assert client.get(f"{root}/plan.gpx?serial=Z").json()["error"] == "Vehicle 'Z' not found"
        assert client.get(f"{root}/plan.exe").status_code == 422
        for path in ("exports", "plan.kml"):
            assert client.get(f"/api/surveys/999/{path}").status_code == 404

    def test_a_blurred_survey_is_warned_of(self, client: Client) -> None:
        asked = {**ASKED, "speed_mps": 8.0, "front_overlap": 0.2}
        camera = {"model": "mini3pro", "interval_s": 2.0}
        survey = client.post("/api/surveys", json={**asked, "camera": camera}).json()["survey"]
        (warning,) = client.get(f"/api/surveys/{survey['id']}/estimate").json()["warnings"]
        assert warning.startswith("8 m/s is more than 6.91 m/s: blur of 0.5 pixel")

    def test_cameras_are_listed_and_an_unknown_one_is_refused(self, client: Client) -> None:
        cameras = {each["name"]: each for each in client.get("/api/cameras").json()}
        assert cameras["p1-35mm"]["across_px"] == 8192
        answer = client.post("/api/surveys", json={**ASKED, "camera": {"model": "x9"}}).json()
        assert not answer["accepted"]
        assert "Camera 'x9' not found; available: mavic3m" in answer["reason"]

    @pytest.mark.parametrize(
        ("changes", "words"),
        [
            ({"polygon": [ring((0, 0), (50, 50), (50, 0), (0, 50))]}, "polygon"),
            ({"polygon": [[[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.0, 0.0]]]}, "origin"),
            ({"polygon": [[[-93.6, 41.9]]]}, "polygon"),
            ({"polygon": None, "region": "north"}, "Survey region 'north' not found"),
            ({"polygon": None}, "either a region of the site or a polygon"),
            ({"region": "north"}, "either a region of the site or a polygon"),
            ({"speed_mps": 14.0}, "fly at"),
            ({"height_above_takeoff_m": 9_000.0}, "height"),
            ({"height_above_takeoff_m": None}, "give one height: either"),
            ({"height_above_ground_m": 40.0}, "give one height: either"),
            (
                {"height_above_takeoff_m": None, "height_above_ground_m": 40.0},
                "needs the site's elevation model",
            ),
            ({"planner": "best"}, "Unknown planner best"),
        ],
    )
    def test_what_cannot_be_flown_is_refused_with_words(
        self, client: Client, changes: dict[str, object], words: str
    ) -> None:
        answer = client.post("/api/surveys", json=ASKED | changes).json()
        assert not answer["accepted"]
        assert answer["rule"] == "survey"
        assert words in answer["reason"]
        assert all(each["phase"] == "refused" for each in client.get("/api/surveys").json())

    @pytest.mark.parametrize("extra", [{"fly": True}, {"speed_mps": "fast"}, {"cell_m": None}])
    def test_what_is_no_request_is_one_sentence(
        self, client: Client, extra: dict[str, object]
    ) -> None:
        response = client.post("/api/surveys", json=ASKED | extra)
        assert response.status_code == 422
        assert list(response.json()) == ["error"]

    def test_without_a_site_there_is_no_survey(self) -> None:
        answer = Client(application(FakeStation())).post("/api/surveys", json=ASKED).json()
        assert not answer["accepted"]
        assert "--site" in answer["reason"]


class TestWords:
    @pytest.fixture
    def number(self, client: Client) -> int:
        asked: int = client.post("/api/surveys", json=ASKED).json()["survey"]["id"]
        return asked

    def test_a_stranger_is_refused_and_nothing_starts(self, client: Client, number: int) -> None:
        answer = client.post(f"/api/surveys/{number}/start", json={"serials": ["Z"]}).json()
        assert not answer["accepted"]
        assert "Z is unknown" in answer["reason"]
        assert client.get(f"/api/surveys/{number}").json()["phase"] == "created"

    def test_a_start_by_a_wrong_clock_is_refused_and_nothing_starts(
        self, client: Client, number: int
    ) -> None:
        start = {"serials": ["A"], "takeoff": True, "given_at_unix_ms": 10_000}
        refused = client.post(f"/api/surveys/{number}/start", json=start).json()
        assert (refused["accepted"], refused["rule"]) == (False, "not_expired")
        assert client.get(f"/api/surveys/{number}").json()["phase"] != "running"

    def test_a_start_without_vehicles_is_malformed(self, client: Client, number: int) -> None:
        assert client.post(f"/api/surveys/{number}/start", json={"serials": []}).status_code == 422

    def test_what_does_not_fly_cannot_be_paused_but_aborted(
        self, client: Client, number: int
    ) -> None:
        assert not client.post(f"/api/surveys/{number}/pause").json()["accepted"]
        answer = client.post(f"/api/surveys/{number}/abort").json()
        assert answer["accepted"]
        assert answer["survey"]["phase"] == "aborted"
        assert not client.post(f"/api/surveys/{number}/abort").json()["accepted"]

    @pytest.mark.parametrize("word", ["pause", "abort"])
    def test_a_survey_that_is_not_there_is_refused(self, client: Client, word: str) -> None:
        answer = client.post(f"/api/surveys/77/{word}").json()
        assert answer == {
            "accepted": False,
            "rule": "survey",
            "reason": "Survey 77 not found; no survey was created yet",
            "survey": None,
        }

    def test_other_words_are_none(self, client: Client, number: int) -> None:
        assert client.post(f"/api/surveys/{number}/explode").status_code == 422


class TestLooks:
    @pytest.mark.parametrize("path", ["", "/paths", "/cells.png"])
    def test_what_is_not_there_is_one_sentence(self, client: Client, path: str) -> None:
        response = client.get(f"/api/surveys/77{path}")
        assert response.status_code == 404
        assert "Survey 77 not found" in response.json()["error"]

    def test_those_there_are_are_named(self, client: Client) -> None:
        number = client.post("/api/surveys", json=ASKED).json()["survey"]["id"]
        error = client.get("/api/surveys/77").json()["error"]
        assert error == f"Survey 77 not found; available: {number} field (created)"

    def test_one_without_rows_gives_the_reason(self, client: Client) -> None:
        asked = {**ASKED, "speed_mps": 14.0}
        number = client.post("/api/surveys", json=asked).json()["survey"]["id"]
        error = client.get(f"/api/surveys/{number}/paths").json()["error"]
        assert error.startswith(f"Survey {number} has no rows: ")

    def test_rows_lie_in_the_field(self, client: Client) -> None:
        number = client.post("/api/surveys", json=ASKED).json()["survey"]["id"]
        paths = client.get(f"/api/surveys/{number}/paths").json()
        places = np.array([place for row in paths["rows"] for place in row])
        west, south = np.array(SQUARE).min(axis=0)
        east, north = np.array(SQUARE).max(axis=0)
        assert (places >= (west - 3e-4, south - 3e-4)).all()
        assert (places <= (east + 3e-4, north + 3e-4)).all()
        assert paths["flying"] == paths["flown"] == []

    def test_cells_are_values_or_a_picture(self, client: Client) -> None:
        survey = client.post("/api/surveys", json=ASKED).json()["survey"]
        path = f"/api/surveys/{survey['id']}/cells.png"
        values = decoded(client.get(path, params={"as": "values"}).content)
        assert values.shape[:2] == (survey["cells"]["rows"], survey["cells"]["cols"])
        counted = (values[..., 3] == 255).sum() * survey["cells"]["cell_m"] ** 2
        assert counted == survey["figures"]["region_m2"]
        assert (values[..., 0] == 0).all()
        assert decoded(client.get(path).content).shape[0] > values.shape[0]


class TestShade:
    def test_before_any_there_is_none(self, client: Client) -> None:
        for path in ("/api/shade.png", "/api/forecast.png"):
            response = client.get(path)
            assert response.status_code == 404
            assert list(response.json()) == ["error"]

    def test_the_map_and_the_forecast_are_drawn_as_they_are(
        self, client: Client, station: FakeStation
    ) -> None:
        shade, sun = found()
        put(station, shade, sun)
        response = client.get("/api/shade.png", params={"as": "values"})
        assert response.headers["X-Frame-Id"] == "1"
        drawn = decoded(response.content)
        assert (drawn[..., 3] == np.where(shade.valid, 255, 0)).all()
        assert drawn[0, 0, 0] == 0
        assert drawn[0, 3, 0] == 255
        picture = decoded(client.get("/api/shade.png").content)
        assert picture[0, 0, 0] > picture[0, 0, 2], "shade is blue"
        assert picture[0, -1, 0] < picture[0, -1, 2], "sun is yellow"

    def test_what_is_in_view_without_a_value_is_hatched_and_counted_as_unknown(
        self, client: Client, station: FakeStation
    ) -> None:
        shade, sun = found()
        seen = np.ones((3, 4), np.bool_)
        seen[2, 2:] = False
        put(station, shade, sun, seen)
        cells = decoded(client.get("/api/shade.png").content)[..., 3].reshape(3, 8, 4, 8)
        drawn = (cells > 0).mean(axis=(1, 3))
        assert (drawn[:2] == 1.0).all()
        assert (drawn[2, :2] == 0.25).all()
        assert (drawn[2, 2:] == 0.0).all()

    def test_the_shares_of_the_ground_in_view_add_up(self) -> None:
        shade, _ = found()
        seen = np.ones((3, 4), np.bool_)
        seen[2, 2:] = False
        station = with_imagers(Station(), "IMAGER")
        pipeline = ShadePipeline(shade=shade, seen=seen, number=1)
        view = shade_view(replace(station, shade=pipeline), 0)
        assert view is not None
        assert view.map is not None
        assert view.map.in_view is not None
        assert view.map.in_view.model_dump() == pytest.approx(IN_VIEW)

    @pytest.mark.parametrize(("asked_s", "nearest_s"), [(0.0, "0"), (36.0, "30"), (4_000.0, "600")])
    def test_the_nearest_lead_is_drawn_and_named(
        self, client: Client, station: FakeStation, asked_s: float, nearest_s: str
    ) -> None:
        put(station, *found())
        response = client.get("/api/forecast.png", params={"lead_s": asked_s, "as": "values"})
        assert response.headers["X-Lead-S"] == nearest_s
        drawn = decoded(response.content)
        is_predicted = float(nearest_s) <= 300.0
        assert (drawn[..., 3] == 255).any() == is_predicted

    def test_beyond_the_horizon_the_estimate_is_drawn_under_the_hatching(
        self, client: Client, station: FakeStation
    ) -> None:
        """And nothing under it where nothing was seen."""
        shade, sun = found()
        put(station, shade, replace(sun, horizon_s=np.where(shade.valid, 0.0, np.nan).astype("f4")))
        for lead_s, drawn in ((0.0, 1.0), (600.0, 1.0)):
            picture = decoded(client.get("/api/forecast.png", params={"lead_s": lead_s}).content)
            cells = (picture[..., 3] > 0).reshape(3, 8, 4, 8).mean(axis=(1, 3))
            assert (cells[:2] == drawn).all()
            assert (cells[2] == 0.25).all()
            greys = (picture[..., :3] == 120).all(axis=2).reshape(3, 8, 4, 8).mean(axis=(1, 3))
            assert (greys[:2] == (0.25 if lead_s else 0.0)).all()

    @pytest.mark.parametrize(
        ("east_m", "north_m", "light"),
        [
            (2.0, -2.0, "shade"),
            (14.0, -2.0, "sun"),
            (2.0, -10.0, "unknown"),
            (-9.0, -2.0, "unknown"),
        ],
    )
    def test_the_light_at_a_place_is_that_of_its_cell(
        self, client: Client, station: FakeStation, east_m: float, north_m: float, light: str
    ) -> None:
        ((lon, lat), _) = ring((east_m, north_m))
        path = f"/api/sun-at?latitude_deg={lat}&longitude_deg={lon}"
        assert client.get(path).status_code == 404
        put(station, *found())
        answer = client.get(path).json()
        assert (answer["number"], answer["light"]) == (1, light)
        # Nothing is known of the shadows' motion.
        assert (answer["known_ahead_s"], answer["change_after_s"]) == (0.0, None)

    def test_times_at_a_place_count_from_now(self, client: Client, station: FakeStation) -> None:
        shade, sun = found()
        coming = replace(
            sun, velocity_mps=(0.4, 0.0), horizon_s=np.where(shade.valid, 60.0, 0.0).astype("f4")
        )
        put(station, shade, coming)
        ((lon, lat), _) = ring((14.0, -2.0))
        path = f"/api/sun-at?latitude_deg={lat}&longitude_deg={lon}"
        first = client.get(path).json()
        assert first["change_chance"] > 0.5
        assert first["change_early_s"] <= first["change_after_s"] <= first["change_late_s"] <= 60.0
        station.now_ns += 4_000_000_000
        later = client.get(path).json()
        for name in ("change_after_s", "known_ahead_s"):
            assert first[name] - later[name] == pytest.approx(4.0)

    def test_without_a_place_upwind_the_answer_states_why(
        self, client: Client, station: FakeStation
    ) -> None:
        answer = client.get("/api/upwind-place").json()
        assert answer["place"] is None
        assert "expected " in answer["reason"]
        unknown = client.get("/api/upwind-place?region=moon").json()
        assert "expected a survey region of the site" in unknown["reason"]

    @pytest.mark.parametrize("authority", ["-1", "nan", "soon"])
    def test_a_lead_that_is_none_is_refused(self, client: Client, authority: str) -> None:
        assert client.get(f"/api/forecast.png?lead_s={authority}").status_code == 422


class TestCells:
    def test_unknown_light_is_drawn_neither_as_sun_nor_as_shade(self) -> None:
        state = np.array([[0, 1, 1, 2]], np.uint8)
        inside, known = np.ones((1, 4), np.bool_), np.array([[False, True, False, True]])
        values = decoded(cells_values_png(state, inside, known))
        assert values[0, :, 0].tolist() == [0, 128, 64, 255]
        picture = decoded(cells_png(state, inside, known)).reshape(8, 4, 8, 4)
        drawn = picture[..., 3] > 0
        assert drawn.mean(axis=(0, 2)).tolist() == [0.0, 3 / 8, 2 / 8, 1.0]
        unknown = picture[:, 2][drawn[:, 2]]
        assert (unknown[:, 0] == unknown[:, 2]).all(), "unknown is grey"


class TestSideStep:
    def test_without_an_imaging_drone_it_is_refused_and_audited(
        self, client: Client, station: FakeStation
    ) -> None:
        answer = client.post("/api/side-step", json={}).json()
        assert answer == {
            "accepted": False,
            "rule": "side_step",
            "reason": "the site has no imaging drone",
        }
        assert client.get("/api/state").json()["side_step"] is None

    def test_a_survey_allows_it_only_when_asked(self, client: Client) -> None:
        plain = client.post("/api/surveys", json=ASKED).json()["survey"]
        allowing = {"side_step_allowed": True, "upwind_allowed": True}
        allowed = client.post("/api/surveys", json={**ASKED, **allowing}).json()
        assert plain["side_step_allowed"] is False
        assert plain["upwind_allowed"] is False
        assert allowed["survey"]["side_step_allowed"] is True
        assert allowed["survey"]["upwind_allowed"] is True


class TestRelief:
    def test_without_an_imaging_drone_it_is_refused_and_audited(self, client: Client) -> None:
        answer = client.post("/api/imager-relief", json={"serial": "A", "spare": "B"}).json()
        assert answer == {
            "accepted": False,
            "rule": "imager_relief",
            "reason": "A is no imaging drone of the site: expected none: the site has no imaging "
            "drone",
        }
        assert client.get("/api/state").json()["imager_relief"] is None

    def test_a_survey_allows_it_only_when_asked(self, client: Client) -> None:
        plain = client.post("/api/surveys", json=ASKED).json()["survey"]
        allowed = client.post("/api/surveys", json={**ASKED, "relief_allowed": True}).json()
        assert (plain["relief_allowed"], plain["spare_serial"]) == (False, None)
        assert allowed["survey"]["relief_allowed"] is True
        assert allowed["survey"]["light"] is None

    def test_a_spare_that_is_no_imaging_drone_is_refused(self, client: Client) -> None:
        answer = client.post("/api/surveys", json={**ASKED, "spare_serial": "X"}).json()
        assert answer["accepted"] is False
        assert answer["reason"] == "'X' is no imaging drone of the site; available: none"


IN_VIEW = {"sun": 0.4, "shade": 0.4, "unknown": 0.2}
"""Of `found`, with the last row seen by half."""


def decoded(data: bytes) -> np.ndarray:
    return cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)


def found() -> tuple[ShadeMap, SunForecast]:
    """Shade in the west, sun in the east, nothing known of the last row."""
    grid = GroundGrid(FRAME, 0.0, 0.0, 4.0, 3, 4)
    valid = np.ones((3, 4), dtype=np.bool_)
    valid[2] = False
    light = np.where(np.arange(4) < 2, np.float32(0.0), np.float32(1.0)) * np.ones(
        (3, 1), np.float32
    )
    light = np.where(valid, light, np.float32(np.nan)).astype(np.float32)
    ones = np.ones((3, 4), np.float32)
    shade = ShadeMap(grid, 0, ("IMAGER",), light, valid, ones, ones)
    return shade, persisting(shade, 0.5, ForecastSettings())


def put(
    station: FakeStation, shade: ShadeMap, sun: SunForecast, seen: np.ndarray | None = None
) -> None:
    """As if the worker had read them from a frame."""
    driver = station.driver
    driver.worker = None
    driver.station, _ = on_ground_image(driver.station, ground_image(1))
    job = driver.station.shade.job_id
    assert job is not None
    own = SeenShade(shade, shade.valid if seen is None else seen)
    read = ShadeRead("", DetectionState(), ForecastState(), own, (own, sun))
    driver.handle(JobDone(job, READ_SHADE, read))


def test_a_rejected_frame_is_no_map(client: Client, station: FakeStation) -> None:
    driver = station.driver
    driver.worker = None
    driver.station, _ = on_ground_image(driver.station, ground_image(1))
    rejected = RejectedFrame(1, FrameFault.BLACK, "expected a picture, got black")
    read = ShadeRead("", DetectionState(), ForecastState(), rejected)
    driver.handle(JobDone(driver.station.shade.job_id or 0, READ_SHADE, read))
    assert client.get("/api/shade.png").status_code == 404
    assert driver.station.shade.frames_rejected == 1
