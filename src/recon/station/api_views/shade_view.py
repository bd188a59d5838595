"""The state of shade detection and sun forecast, as the API sends it."""

import numpy as np

from recon.api import schema
from recon.model.shade import ShadeMap, SunForecast
from recon.model.units import ns_to_seconds
from recon.station.api_views.corners import corners_lon_lat
from recon.station.state.station import Station


def shade_view(station: Station, now_ns: int) -> schema.ShadeLineView | None:
    """Return the state of shade detection and forecast; None without an imaging drone."""
    if station.imaging.imager_serial is None:
        return None
    line, settings = station.shade, station.settings
    return schema.ShadeLineView(
        detection=settings.detection.method,
        forecaster=settings.forecast.method,
        frames_rejected=line.frames_rejected,
        frames_dropped=line.frames_dropped,
        rejected=None if line.rejected is None else line.rejected.reason,
        error=line.error,
        map=None if line.shade is None else _map(line.shade, line.number, now_ns),
        forecast=None if line.sun is None else _forecast(line.sun, line.number, now_ns),
    )


def _map(shade: ShadeMap, number: int, now_ns: int) -> schema.ShadeMapView:
    known = int(shade.valid.sum())
    return schema.ShadeMapView(
        number=number,
        captured_age_s=ns_to_seconds(now_ns - shade.captured_at_ns),
        known_share=known / shade.valid.size,
        sunlit_share=float(shade.is_sunlit.sum() / known) if known else None,
        mean_confidence=float(np.mean(shade.confidence[shade.valid])) if known else None,
        corners=corners_lon_lat(shade.grid),
        cell_m=shade.grid.cell_m,
        rows=shade.grid.rows,
        cols=shade.grid.cols,
    )


def _forecast(sun: SunForecast, number: int, now_ns: int) -> schema.ForecastView:
    east_mps, north_mps = sun.velocity_mps or (None, None)
    return schema.ForecastView(
        number=number,
        issued_age_s=ns_to_seconds(now_ns - sun.issued_at_ns),
        method=sun.method,
        lead_s=sun.lead_s.tolist(),
        predicted_share=[float((sun.horizon_s >= lead).mean()) for lead in sun.lead_s],
        prior_sunlit=sun.prior_sunlit,
        shadows_east_mps=east_mps,
        shadows_north_mps=north_mps,
        corners=corners_lon_lat(sun.grid),
        cell_m=sun.grid.cell_m,
        rows=sun.grid.rows,
        cols=sun.grid.cols,
    )
