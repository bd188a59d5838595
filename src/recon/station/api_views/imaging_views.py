"""Ground images, shade and the forecast of sun, as the API sends them."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Literal

import numpy as np

from recon.api import schema
from recon.forecast import next_change, right_shares
from recon.geo import cell_at, enu_from_point, geo_from_enu
from recon.guidance.upwind_place import UpwindPlace
from recon.guidance.upwind_proposal import SPEED_MPS, UpwindProposal
from recon.model.geo import GeoPoint, GroundGrid
from recon.model.shade import MaskMap, ShadeMap, SunForecast
from recon.site import Site
from recon.station.api_views.ages import since_s
from recon.station.imaging.mosaic import alignment_of, newest_images
from recon.station.imaging.upwind import proposed
from recon.station.state.imaging import ImagerFrames, ShadePipeline
from recon.station.state.station import Station


def ground_image_view(station: Station, now_ns: int) -> schema.GroundImageView | None:
    """Return the newest ground image's place and time; None before the first."""
    images = newest_images(station.imaging)
    if not images:
        return None
    image = alignment_of(images)
    serials = [each.serial for each in images]
    profiles = [station.fleet.profiles.get(serial) for serial in serials]
    return schema.GroundImageView(
        frame_id=images[0].frame_id,
        serials=serials,
        captured_age_s=since_s(image.captured_at_ns, now_ns),
        captured_sigma_s=max(0.25 if p is None else p.video_latency_sigma_s for p in profiles),
        registration=image.registration.value,
        registration_residual_m=image.registration_residual_m,
        exposure_locked=image.exposure_locked,
        reference=_reference_text(station.imaging.imagers[serials[0]]),
        corners=corners_lon_lat(image.grid),
        cell_m=image.grid.cell_m,
        rows=image.grid.rows,
        cols=image.grid.cols,
    )


def _reference_text(imager: ImagerFrames) -> str:
    if imager.is_placed_by_telemetry:
        return "telemetry and mount alone: the site has no control points"
    if imager.is_reference_assumed:
        return "first frame received in flight, used for the marked one"
    return "telemetry of the marked frame, from the site's folder"


def shade_view(station: Station, now_ns: int) -> schema.ShadeLineView | None:
    """Return the state of shade detection and forecast; None without an imaging drone."""
    if not station.imaging.imagers:
        return None
    line, settings = station.shade, station.settings
    memories = {s: each.sunlit for s, each in line.detections.items() if each.sunlit is not None}
    return schema.ShadeLineView(
        detection=settings.detection.method,
        forecaster=settings.forecast.method,
        frames_rejected=line.frames_rejected,
        frames_dropped=line.frames_dropped,
        rejected=_by_imager(station, {s: each.reason for s, each in line.rejected.items()}) or None,
        error=line.error,
        reference=_by_imager(station, {s: m.adopted.note for s, m in memories.items()}),
        lock_problem=_by_imager(station, {s: m.lock_problem for s, m in memories.items()}),
        map=None if line.shade is None else _map(line.shade, line.seen, line.number, now_ns),
        forecast=None if line.sun is None else _forecast(line.sun, line, now_ns),
    )


def _by_imager(station: Station, texts: Mapping[str, str]) -> str:
    """Return texts by serial as one, with the vehicles' names where there are several of them."""
    if len(station.imaging.imagers) == 1:
        return "".join(texts.values())
    vehicles = station.fleet.vehicles
    names = {s: vehicles[s].display_name if s in vehicles else s for s in texts}
    return "; ".join(f"{names[serial]}: {text}" for serial, text in texts.items() if text)


def _map(shade: ShadeMap, seen: MaskMap | None, number: int, now_ns: int) -> schema.ShadeMapView:
    known = int(shade.valid.sum())
    return schema.ShadeMapView(
        number=number,
        captured_age_s=since_s(shade.captured_at_ns, now_ns),
        known_share=known / shade.valid.size,
        sunlit_share=float(shade.is_sunlit.sum() / known) if known else None,
        in_view=_light_shares(shade, shade.valid if seen is None else seen | shade.valid),
        mean_confidence=float(np.mean(shade.confidence[shade.valid])) if known else None,
        corners=corners_lon_lat(shade.grid),
        cell_m=shade.grid.cell_m,
        rows=shade.grid.rows,
        cols=shade.grid.cols,
    )


def _light_shares(shade: ShadeMap, in_view: MaskMap) -> schema.LightSharesView | None:
    cells = int(in_view.sum())
    if cells == 0:
        return None
    sun, known = int(shade.is_sunlit.sum()), int(shade.valid.sum())
    return schema.LightSharesView(
        sun=sun / cells, shade=(known - sun) / cells, unknown=(cells - known) / cells
    )


@lru_cache(maxsize=2)
def _shares(sun: SunForecast) -> tuple[list[float], list[float]]:
    """Return the predicted and the sunlit shares by lead; ten states a second have one forecast."""
    predicted = [float((sun.horizon_s >= lead).mean()) for lead in sun.lead_s]
    return predicted, (sun.sun_probability.mean(axis=(1, 2)) / 255).tolist()


def _forecast(sun: SunForecast, line: ShadePipeline, now_ns: int) -> schema.ForecastView:
    east_mps, north_mps = sun.velocity_mps or (None, None)
    predicted, sunlit = _shares(sun)
    return schema.ForecastView(
        number=line.number,
        issued_age_s=since_s(sun.issued_at_ns, now_ns),
        method=sun.method,
        lead_s=sun.lead_s.tolist(),
        predicted_share=predicted,
        sun_share=sunlit,
        right=[
            schema.HindcastView(lead_s=lead_s, right_share=share)
            for lead_s, share in right_shares(line.forecast).items()
        ],
        prior_sunlit=sun.prior_sunlit,
        shadows_east_mps=east_mps,
        shadows_north_mps=north_mps,
        corners=corners_lon_lat(sun.grid),
        cell_m=sun.grid.cell_m,
        rows=sun.grid.rows,
        cols=sun.grid.cols,
    )


def sun_at_view(
    station: Station, place_deg: tuple[float, float], now_ns: int
) -> schema.SunAtView | None:
    """Return the light at a latitude and longitude and its next change; None before a map."""
    line = station.shade
    shade, sun = line.followed, line.sun
    if shade is None or sun is None:
        return None
    frame = shade.grid.frame
    ground = GeoPoint(*place_deg, frame.origin.ellipsoid_height_m)
    east_m, north_m, _up_m = enu_from_point(frame, ground).tolist()
    row, col = cell_at(shade.grid, east_m, north_m)
    is_on = 0 <= row < shade.grid.rows and 0 <= col < shade.grid.cols
    light: Literal["sun", "shade", "unknown"] = "unknown"
    if is_on and shade.valid[row, col]:
        light = "sun" if shade.is_sunlit[row, col] else "shade"
    change = next_change(shade, sun, np.array([(row, col)]), station.settings.forecast)
    age_s = since_s(shade.captured_at_ns, now_ns)
    after_s, early_s, late_s = (
        max(0.0, float(each[0]) - age_s) if change.is_predicted[0] else None
        for each in (change.after_s, change.early_s, change.late_s)
    )
    return schema.SunAtView(
        number=line.number,
        light=light,
        known_ahead_s=max(0.0, float(change.horizon_s[0]) - age_s),
        change_chance=float(change.chance[0]),
        change_after_s=after_s,
        change_early_s=early_s,
        change_late_s=late_s,
    )


def corners_lon_lat(grid: GroundGrid) -> list[tuple[float, float]]:
    """Return (longitude, latitude) of the outer corners NW, NE, SE, SW."""
    corners_enu_m = np.array(
        [
            (grid.west_m, grid.north_m, 0.0),
            (grid.east_m, grid.north_m, 0.0),
            (grid.east_m, grid.south_m, 0.0),
            (grid.west_m, grid.south_m, 0.0),
        ]
    )
    latitude_deg, longitude_deg, _height_m = geo_from_enu(grid.frame, corners_enu_m)
    return [(float(lon), float(lat)) for lon, lat in zip(longitude_deg, latitude_deg, strict=True)]


def upwind_view(
    station: Station, site: Site, serial: str | None, region: str | None, now_ns: int
) -> schema.UpwindView:
    """Return where an imaging drone sees most of a region's shade; else why none is known."""
    named = site.layers.survey_regions
    if region is not None and region not in named:
        known = ", ".join(named) or "none"
        reason = f"expected a survey region of the site ({known}), got {region}"
        return schema.UpwindView(place=None, reason=reason)
    running = [each.survey.region for each in station.surveys.records.values() if each.is_running]
    regions = [named[region]] if region is not None else running or list(named.values())
    found = proposed(station, regions, serial, now_ns)
    if isinstance(found, str):
        return schema.UpwindView(place=None, reason=found)
    return schema.UpwindView(place=upwind_place_view(found), reason="")


def upwind_place_view(found: UpwindProposal) -> schema.UpwindPlaceView:
    """Return a proposed place."""
    return schema.UpwindPlaceView(
        serial=found.serial,
        latitude_deg=found.place.latitude_deg,
        longitude_deg=found.place.longitude_deg,
        height_above_takeoff_m=found.height_above_takeoff_m,
        yaw_deg=found.yaw_deg,
        speed_mps=SPEED_MPS,
        distance_m=found.distance_m,
        takes_s=found.takes_s,
        here=_seen_from(found.here),
        there=_seen_from(found.there),
        sentence=found.sentence,
    )


def _seen_from(place: UpwindPlace) -> schema.SeenFromView:
    return schema.SeenFromView(
        now=place.predicted_at(0.0),
        in_30_s=place.predicted_at(30.0),
        in_60_s=place.predicted_at(60.0),
        in_90_s=place.predicted_at(90.0),
    )
