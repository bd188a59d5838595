"""A simulated survey with its flight record and the photos on the drones' cards, with known truth.

The whole station flies in virtual time and is recorded as a real one is. Each survey drone's camera
looks straight down, its top to the front, and takes a photo each interval while it is at height,
also in turns and on the way. Photos are rendered from the same land, sky and light as the imaging
drone's frames. What a card holds is as bad as a real one: whole seconds by a clock that is wrong,
positions with errors of their own, and no attitude.
"""

from dataclasses import dataclass
from math import radians, tan
from pathlib import Path
from random import Random

import numpy as np
import numpy.typing as npt
from PIL import ExifTags, Image
from PIL.TiffImagePlugin import IFDRational
from tests.replay.record_flight import recording

from recon.camera import OmnidirectionalCamera, TelemetryReference, mounted_pose
from recon.geo import point_from_enu
from recon.model.event import ClockRead
from recon.model.geo import LocalFrame
from recon.model.imagery import CameraPose, GroundImage, RgbImage
from recon.model.shade import ShadeMap
from recon.model.survey import SurveyCamera
from recon.model.units import NS_PER_S
from recon.record.mcap.tracks import utc_text
from recon.score.ideal_detection import IdealDetection
from recon.score.run import StationRun
from recon.score.scenario import Scenario
from recon.score.scenario_conditions import conditions_of
from recon.score.scenario_sky import sky_of
from recon.score.true_frames import FleetFrames
from recon.score.true_paths import phases_s
from recon.sim.camera.field import FieldRenderer
from recon.sim.camera.frames import CameraView
from recon.sim.camera.settings import CameraSettings
from recon.sim.flight.estimate import GaussMarkov
from recon.sim.world import Sky
from recon.station.imaging.shade import READ_SHADE

SIZE_PX = (456, 342)
"""Of the rendered photos, columns and rows: a twelfth of a survey camera's."""
AT_HEIGHT_SHARE = 0.9
"""Of the survey's height: lower photos are of takeoffs and landings."""

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class TruePhoto:
    """One photo as it truly was taken: time since the run's start, pose in the site's frame."""

    name: str
    serial: str
    at_s: float
    pose: CameraPose


@dataclass(frozen=True, slots=True, eq=False)
class SurveyFlown:
    """A recorded flight and its photos."""

    scenario: Scenario
    seed: int
    sky: Sky
    record: Path
    photos: tuple[TruePhoto, ...]
    camera: SurveyCamera
    epoch_ns: int


class ExactDetection(IdealDetection):
    """The true sky at the time and on the ground that a shade map states: maps without errors."""

    def _shade(self, image: GroundImage) -> ShadeMap:
        sun = self._sky.on_grid(image.grid, image.captured_at_ns / NS_PER_S)
        transmittance = np.where(image.valid, sun, np.nan).astype(np.float32)
        sure = image.valid.astype(np.float32)
        return ShadeMap(
            image.grid,
            image.captured_at_ns,
            (image.serial,),
            transmittance,
            image.valid,
            sure,
            sure,
        )


def fly(
    scenario: Scenario, seed: int, folder: Path, limit_s: float = 3600.0, *, is_exact: bool = False
) -> SurveyFlown:
    """Fly a scenario's survey to its end or for so long, and record it into a folder.

    `is_exact` replaces the maps of ideal detection, which are projected by telemetry, by true ones.
    """
    run = StationRun(scenario, seed)
    sky = sky_of(scenario, seed)
    if is_exact:
        jobs = run.driver.jobs
        assert jobs is not None
        jobs.replace(READ_SHADE, ExactDetection(scenario, sky, FleetFrames({})).read)
    epoch_ns = round(sky.settings.sun.start_utc_s * NS_PER_S)
    driver = run.driver
    yaws: dict[str, list[float]] = {path.app.settings.serial: [] for path in run.drones}
    times_s: list[float] = []
    with recording(driver, scenario.site, folder) as record:
        driver.tap = None  # What links carry would only cost time here.
        driver.handle(ClockRead(epoch_ns + driver.now_ns))
        while run.now_s < limit_s and not _is_over(run):
            run.advance_a_second()
            times_s.append(run.now_s)
            for path in run.drones:
                yaws[path.app.settings.serial].append(path.app.aircraft.motion.yaw_deg)
    photos = tuple(_photos(run, times_s, yaws))
    return SurveyFlown(scenario, seed, sky, record.path, photos, scenario.survey.camera, epoch_ns)


def _is_over(run: StationRun) -> bool:
    record = run.record
    return record is not None and record.is_over and not any(p.is_up[-1] for p in run.drones)


def _photos(run: StationRun, times_s: list[float], yaws: dict[str, list[float]]) -> list[TruePhoto]:
    """Return the photos of all drones in the order of time."""
    survey, frame = run.scenario.survey, run.scenario.frame
    interval_s = survey.camera.interval_s
    phases = phases_s(run.seed, [p.app.settings.serial for p in run.drones], interval_s)
    found: list[TruePhoto] = []
    for path, phase_s in zip(run.drones, phases, strict=True):
        serial = path.app.settings.serial
        at_s = np.arange(phase_s, path.at_s[-1], interval_s)
        places = path.at(at_s)
        turned = np.unwrap(np.deg2rad(yaws[serial]))
        yaw_deg = np.rad2deg(np.interp(at_s, times_s, turned))
        high = places[:, 2] - path.home_m[2] >= AT_HEIGHT_SHARE * survey.height_above_takeoff_m
        for moment, place, heading in zip(at_s[high], places[high], yaw_deg[high], strict=True):
            number = len(found) + 1
            name = f"{serial}_{number:04d}.JPG"
            pose = _pose(frame, place, float(heading))
            found.append(TruePhoto(name, serial, float(moment), pose))
    return sorted(found, key=lambda photo: photo.at_s)


def _pose(frame: LocalFrame, place_m: FloatArray, yaw_deg: float) -> CameraPose:
    point = point_from_enu(frame, place_m)
    telemetry = TelemetryReference(
        point.latitude_deg, point.longitude_deg, float(place_m[2]), yaw_deg
    )
    return mounted_pose(telemetry, place_m)


def pinhole(camera: SurveyCamera, cols: int, rows: int) -> OmnidirectionalCamera:
    """Return a lens without distortion of that field across, in the renderer's model."""
    focal_px = cols / 2.0 / tan(radians(camera.across_deg / 2.0))
    largest = np.arctan(np.hypot(cols, rows) / 2.0 / focal_px)
    angles = np.linspace(0.0, 1.05 * largest, 200)
    inverse = np.polynomial.polynomial.Polynomial.fit(
        angles - np.pi / 2.0, focal_px * np.tan(angles), 10, domain=[]
    )
    return OmnidirectionalCamera(
        direct=(-focal_px,),
        inverse=tuple(inverse.coef.tolist()),
        centre_row_px=(rows - 1) / 2.0,
        centre_col_px=(cols - 1) / 2.0,
        affine_c=1.0,
        affine_d=0.0,
        affine_e=0.0,
        rows=rows,
        cols=cols,
    )


@dataclass(slots=True)
class Card:
    """Writes the photos of a flight as their cameras do."""

    flown: SurveyFlown
    folder: Path
    clock_ahead_s: float = 0.0
    """Of the cameras before UTC."""
    is_rendered: bool = True
    gnss_drift_m: float = 0.7

    def write(self, every: int = 1) -> list[Path]:
        """Write every Nth photo of each drone; return their files."""
        self.folder.mkdir(parents=True, exist_ok=True)
        flown = self.flown
        conditions = conditions_of(flown.scenario, flown.seed)
        cols, rows = SIZE_PX
        renderer = FieldRenderer(
            pinhole(flown.camera, cols, rows),
            seed=flown.seed,
            sky=flown.sky,
            imager=CameraSettings.perfect(),
            light=conditions.light,
        )
        errors = {p.serial: _GnssError(self.gnss_drift_m, p.serial) for p in flown.photos}
        counts: dict[str, int] = {}
        paths = []
        for number, photo in enumerate(flown.photos):
            error_m = errors[photo.serial].at(photo.at_s)
            counts[photo.serial] = counts.get(photo.serial, -1) + 1
            if counts[photo.serial] % every:
                continue
            if self.is_rendered:
                pixels = renderer.render(CameraView(photo.at_s, number, photo.pose))
            else:
                pixels = np.full((rows, cols, 3), 120, dtype=np.uint8)
            path = self.folder / photo.name
            self._write_one(path, photo, pixels, error_m)
            paths.append(path)
        return paths

    def _write_one(
        self, path: Path, photo: TruePhoto, pixels: RgbImage, error_m: FloatArray
    ) -> None:
        flown = self.flown
        place = photo.pose.position_enu_m + np.append(error_m, 0.0)
        point = point_from_enu(flown.scenario.frame, place)
        shown_ns = flown.epoch_ns + round((photo.at_s + self.clock_ahead_s) * NS_PER_S)
        exif = Image.Exif()
        exif[ExifTags.Base.Make] = "Simulated"
        exif[ExifTags.Base.Model] = "Survey camera"
        details = exif.get_ifd(ExifTags.IFD.Exif)
        shown = utc_text(shown_ns)
        details[ExifTags.Base.DateTimeOriginal] = f"{shown[:10]} {shown[11:19]}".replace("-", ":")
        details[ExifTags.Base.BodySerialNumber] = f"CAM-{photo.serial}"
        details[ExifTags.Base.FocalLengthIn35mmFilm] = 28
        wide = tan(radians(flown.camera.across_deg / 2.0))
        details[ExifTags.Base.FocalLength] = _rational(8.8)
        # A sensor as wide as gives the field: readers take it before the rounded equivalent.
        across_mm = 2.0 * 8.8 * wide
        details[ExifTags.Base.FocalPlaneXResolution] = _rational(SIZE_PX[0] / across_mm)
        details[ExifTags.Base.FocalPlaneResolutionUnit] = 4
        gps = exif.get_ifd(ExifTags.IFD.GPSInfo)
        gps[ExifTags.GPS.GPSLatitudeRef] = "N" if point.latitude_deg >= 0 else "S"
        gps[ExifTags.GPS.GPSLatitude] = _dms(point.latitude_deg)
        gps[ExifTags.GPS.GPSLongitudeRef] = "E" if point.longitude_deg >= 0 else "W"
        gps[ExifTags.GPS.GPSLongitude] = _dms(point.longitude_deg)
        gps[ExifTags.GPS.GPSAltitude] = _rational(point.ellipsoid_height_m + 23.0)
        Image.fromarray(pixels).save(path, quality=88, exif=exif)


def _rational(value: float) -> IFDRational:
    return IFDRational(round(value * 1e6), 1_000_000)


def _dms(degrees: float) -> tuple[IFDRational, ...]:
    whole, minutes = divmod(abs(degrees) * 60.0, 60.0)
    parts = (int(whole), int(minutes), (minutes - int(minutes)) * 60.0)
    return tuple(_rational(part) for part in parts)


class _GnssError:
    """The error of the positions on one card: slow and fast parts, east and north."""

    def __init__(self, drift_m: float, name: str) -> None:
        self._random, self._at_s = Random(f"{name}/gnss"), 0.0
        self._slow = [GaussMarkov(drift_m, 400.0, drift_m) for _ in range(2)]
        self._fast = [GaussMarkov(0.15, 5.0) for _ in range(2)]

    def at(self, at_s: float) -> FloatArray:
        step_s, self._at_s = at_s - self._at_s, at_s
        return np.array(
            [
                slow.step(step_s, self._random) + fast.step(step_s, self._random)
                for slow, fast in zip(self._slow, self._fast, strict=True)
            ]
        )


def true_ground_m(photo: TruePhoto, camera: SurveyCamera, cols: int, rows: int) -> FloatArray:
    """Return where each pixel of a photo truly lies on level ground, (rows, cols, 2) in metres."""
    focal_px = cols / 2.0 / tan(radians(camera.across_deg / 2.0))
    right, down = np.meshgrid(
        (np.arange(cols) - (cols - 1) / 2.0) / focal_px,
        (np.arange(rows) - (rows - 1) / 2.0) / focal_px,
    )
    rays = np.stack([right, down, np.ones_like(right)], axis=-1) @ photo.pose.rotation_enu_camera.T
    place = photo.pose.position_enu_m
    ground: FloatArray = place[:2] + rays[..., :2] * (place[2] / -rays[..., 2])[..., np.newaxis]
    return ground


def true_sunlit(
    flown: SurveyFlown, photo: TruePhoto, cols: int = 114, rows: int = 86
) -> FloatArray:
    """Return the true transmittance on a photo's pixels, (rows, cols)."""
    ground = true_ground_m(photo, flown.camera, cols, rows)
    found = flown.sky.transmittance(ground[..., 0], ground[..., 1], photo.at_s)
    return found.astype(np.float64)
