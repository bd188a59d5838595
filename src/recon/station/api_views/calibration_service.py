"""An imaging drone's camera placed by control points that a person marks on one of its frames.

The frame is kept with the telemetry at its capture, one for each imaging drone. Points are solved
as often as they change; accepted, they are saved in the site's folder and in force with the next
frame.
"""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from recon.api import schema
from recon.camera import ControlPoint, PoseSolution, TelemetryReference, jpeg_size
from recon.camera.omnidirectional import scale_between
from recon.geo import enu_from_geo
from recon.model.command import Refusal
from recon.model.errors import ReconError, SiteError
from recon.model.geo import LatLon
from recon.model.imagery import Frame
from recon.model.person import Person
from recon.site.calibration import MarkedPoints, solved, stage_calibration, surveyed_points
from recon.site.drawing import StagedSite
from recon.station.api_views import outcome_of
from recon.station.api_views.edited_site import EditedSite
from recon.station.imaging.frames import SAMPLE_NEAR_S, sample_at

RULE = "calibration"
NO_FRAME = "Freeze a frame of the imaging drone first"


@dataclass(frozen=True, slots=True, eq=False)
class _Frozen:
    frame: Frame
    telemetry: TelemetryReference
    size_px: tuple[int, int]


@dataclass(slots=True)
class CalibrationService:
    """Frozen frames, and the points marked on them."""

    edited: EditedSite
    newest: Callable[[str], Frame | None]
    """A vehicle's newest frame, with its pixels."""
    _frozen: dict[str, _Frozen] = field(default_factory=dict)
    """Frozen frames of the site's few imaging drones, by serial."""

    async def freeze(self, serial: str) -> schema.FrozenFrameView:
        """Keep the newest frame of an imaging drone."""
        edited = self.edited
        imager = edited.driver.station.imaging.imagers.get(serial)
        if imager is None or serial not in edited.site.imagers:
            return _not_frozen(f"{serial} is no imaging drone of this site")
        frame = self.newest(serial)
        if frame is None:
            return _not_frozen("No frame of the imaging drone yet; switch its camera on")
        sample = sample_at(imager.samples, frame.captured_at_ns)
        if sample is None:
            return _not_frozen(
                f"No telemetry of the imaging drone within {SAMPLE_NEAR_S:g} s of its newest "
                "frame; try again when both arrive"
            )
        try:
            frozen = _Frozen(frame, sample.telemetry, _size_px(frame))
            surveyed = await asyncio.to_thread(_surveyed, edited.folder, serial)
        except ReconError as problem:
            return _not_frozen(str(problem))
        self._frozen[serial] = frozen
        return schema.FrozenFrameView(
            accepted=True,
            reason=None,
            frame_id=frame.id,
            cols=frozen.size_px[0],
            rows=frozen.size_px[1],
            latitude_deg=sample.telemetry.latitude_deg,
            longitude_deg=sample.telemetry.longitude_deg,
            surveyed=surveyed,
        )

    def frame(self, serial: str) -> Frame | None:
        """Return the kept frame of an imaging drone."""
        frozen = self._frozen.get(serial)
        return None if frozen is None else frozen.frame

    async def fit(self, asked: schema.CalibrationRequest) -> schema.CalibrationView:
        """Return the camera's pose by these points, or why they give none; nothing is saved."""
        try:
            marked = self._marked(asked)
            solution = await asyncio.to_thread(solved, self.edited.site, marked)
        except ReconError as problem:
            return _refused(Refusal(RULE, str(problem)))
        return self._solved(marked, solution)

    async def accept(self, asked: schema.CalibrationRequest, by: Person) -> schema.CalibrationView:
        """Save the points in the site's folder, and place the next frames by them."""
        fit = await self.fit(asked)
        if not fit.accepted:
            return fit
        marked = self._marked(asked)

        def stage(path: Path) -> StagedSite:
            return stage_calibration(path, marked)

        async with self.edited.turn:
            change = await self.edited.change(None, stage, by)
        return fit if change.refusal is None else _refused(change.refusal)

    def _marked(self, asked: schema.CalibrationRequest) -> MarkedPoints:
        """Return the points of a request, with the ground's height where none is given."""
        frozen = self._frozen.get(asked.serial)
        if frozen is None or asked.serial not in self.edited.site.imagers:
            raise SiteError(NO_FRAME)
        if frozen.frame.id != asked.frame_id:
            raise SiteError("Another frame was frozen meanwhile, perhaps on another screen")
        points = tuple(_point(self.edited, each) for each in asked.points)
        return MarkedPoints(asked.serial, points, frozen.size_px, frozen.telemetry)

    def _solved(self, marked: MarkedPoints, solution: PoseSolution) -> schema.CalibrationView:
        camera = self.edited.site.imagers[marked.serial].camera
        # Residuals are at the lens's size; the person marks on the frame's.
        scale = 1.0 / scale_between(marked.image_size_px, (camera.cols, camera.rows))
        residuals = [
            schema.PointResidualView(
                name=each.name,
                col_px=each.col_px * scale,
                row_px=each.row_px * scale,
                ground_m=each.ground_m if np.isfinite(each.ground_m) else None,
            )
            for each in solution.residuals
        ]
        return schema.CalibrationView(
            **outcome_of(None),
            rms_px=solution.rms_px * scale,
            residuals=residuals,
            height_above_ground_m=solution.height_above_ground_m,
            tilt_deg=solution.tilt_deg,
        )


def _point(edited: EditedSite, view: schema.ControlPointView) -> ControlPoint:
    if view.col_px is None or view.row_px is None:
        raise SiteError(f"control point {view.name}: mark it on the frame, or delete it")
    place = LatLon(view.latitude_deg, view.longitude_deg)
    if not place.is_valid():
        raise SiteError(f"control point {view.name}: expected a latitude and longitude in degrees")
    altitude_m = view.altitude_m
    if altitude_m is None:
        altitude_m = _ground_m(edited, view)
    return ControlPoint(
        view.name, view.col_px, view.row_px, view.latitude_deg, view.longitude_deg, altitude_m
    )


def _ground_m(edited: EditedSite, view: schema.ControlPointView) -> float:
    """Return the ground's height above the ellipsoid; raises `SiteError` where none is known."""
    frame, airspace = edited.site.frame, edited.driver.station.airspace
    assert frame is not None, "a site with an imaging drone has an origin"
    origin_m = frame.origin.ellipsoid_height_m
    place_m = enu_from_geo(frame, view.latitude_deg, view.longitude_deg, origin_m)[:, :2]
    height_m = float(airspace.ground_up_m(place_m)[0])
    if not np.isfinite(height_m):
        raise SiteError(f"control point {view.name}: no ground height is known there; enter it")
    return origin_m + height_m


def _surveyed(folder: Path | None, serial: str) -> list[schema.ControlPointView]:
    points = () if folder is None else surveyed_points(folder, serial)
    return [
        schema.ControlPointView(
            name=each.name,
            latitude_deg=each.latitude_deg,
            longitude_deg=each.longitude_deg,
            altitude_m=each.ellipsoid_height_m,
        )
        for each in points
    ]


def _size_px(frame: Frame) -> tuple[int, int]:
    """Return columns and rows."""
    if frame.rgb is not None:
        return frame.rgb.shape[1], frame.rgb.shape[0]
    assert frame.jpeg is not None, "a frame has pixels"
    rows, cols = jpeg_size(frame.jpeg)
    return cols, rows


def _not_frozen(reason: str) -> schema.FrozenFrameView:
    return schema.FrozenFrameView(
        accepted=False,
        reason=reason,
        frame_id=None,
        cols=0,
        rows=0,
        latitude_deg=None,
        longitude_deg=None,
        surveyed=[],
    )


def _refused(refusal: Refusal) -> schema.CalibrationView:
    return schema.CalibrationView(
        **outcome_of(refusal),
        rms_px=None,
        residuals=[],
        height_above_ground_m=None,
        tilt_deg=None,
    )
