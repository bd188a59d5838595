"""A flight as one NetCDF-4 file by CF-1.11, for xarray, QGIS, ncview and GDAL.

Maps, forecasts and the survey share one grid in the site's map projection, row 0 north. Tracks are
a group of their own, a ragged array of trajectories: a file's feature type covers all of its data,
and a group's covers the group alone.
"""

from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from recon.geo import cell_centres_m, sun_position
from recon.model.errors import RecordError
from recon.model.extras import from_extra
from recon.model.geo import GroundGrid, LatLon
from recon.model.units import NS_PER_S
from recon.product.cf_file import CRS, CfFile, characters
from recon.product.flight import FULL, UNKNOWN, FlightData
from recon.product.recorded_states import RecordedForecast, RecordedState, recorded_states
from recon.record.mcap.mcap_read import Opener, opened
from recon.record.raster.geotiff import projected_crs

if TYPE_CHECKING:
    import netCDF4

FORECAST_EVERY_NS = 2 * NS_PER_S
"""Least time between two forecasts, which are most of a file: shadows move two cells in it."""


def write_netcdf(flight: FlightData, out: Path, open_record: Opener = opened) -> None:
    """Write a flight to a new file, whole or not at all.

    Raises `RecordError` without shade maps or for a damaged record, and OSError.
    """
    with from_extra("netcdf", "NetCDF"):
        import netCDF4

    if flight.grid is None or not flight.maps:
        raise RecordError(
            f"{flight.path}: expected a flight with shade maps, got none: no imaging drone, or no "
            "frame of it could be used"
        )
    part = out.with_name(f".{out.name}.new")
    try:
        with netCDF4.Dataset(part, "w", format="NETCDF4") as file:
            _FlightFile(file, flight, flight.grid).write(open_record)
        part.replace(out)
    except RuntimeError as problem:
        raise RecordError(
            f"{out}: expected to write NetCDF, got: {problem}; is there room?"
        ) from None
    finally:
        part.unlink(missing_ok=True)


class _FlightFile:
    """The variables of a file being written."""

    def __init__(self, file: "netCDF4.Dataset", flight: FlightData, grid: GroundGrid) -> None:
        self._file, self._flight, self._grid = file, flight, grid
        epoch_ns = flight.span_ns[0] // NS_PER_S * NS_PER_S
        epoch_utc = flight.utc(epoch_ns).removesuffix("Z").replace("T", " ")
        self._cf = CfFile(file, grid, epoch_ns, epoch_utc)
        self._surveys: list[str] = []
        self._forecasts = self._states = 0
        self._forecast_due_ns = -(2**62)

    def write(self, open_record: Opener) -> None:
        """Write all that the flight and its record hold."""
        self._about()
        self._place()
        self._maps()
        self._sun()
        self._tracks(self._file.createGroup("tracks"))
        self._declare_states()
        for each in recorded_states(self._flight.path, self._grid, open_record):
            if isinstance(each, RecordedForecast):
                self._add_forecast(each)
            else:
                self._add_state(each)

    def _about(self) -> None:
        flight, made = self._flight, f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ}"
        about = {
            "Conventions": "CF-1.11",
            "title": f"Shade, forecasts and tracks of the flight {flight.path.stem}",
            "source": "images and telemetry of drones",
            "history": f"{made} Recon {version('recon-gcs')}: recon export {flight.path.name}",
        }
        if flight.scenario:
            about["source"] = f"simulated drones, scenario {flight.scenario}"
        if flight.trouble:
            about["comment"] = f"The record ends early: {flight.trouble}"
        self._file.setncatts(about)

    def _place(self) -> None:
        import pyproj

        crs = self._file.createVariable(CRS, "i4")
        crs.setncatts(pyproj.CRS.from_wkt(projected_crs(self._grid.frame)).to_cf())
        for name, values in zip(("x", "y"), cell_centres_m(self._grid), strict=True):
            self._cf.axis(name, values, "m", f"projection_{name}_coordinate", axis=name.upper())

    def _maps(self) -> None:
        maps = self._flight.maps
        self._cf.times("time", [each.at_ns for each in maps])
        sun = self._cf.cells(
            "transmittance",
            ("time",),
            "share of direct sunlight that reaches the ground past clouds",
            fill=UNKNOWN,
            scale_factor=np.float32(1.0 / FULL),
            ancillary_variables="confidence",
        )
        sure = self._cf.cells(
            "confidence",
            ("time",),
            "confidence of transmittance",
            scale_factor=np.float32(1.0 / 255.0),
        )
        for number, each in enumerate(maps):
            sun[number], sure[number] = each.sun, each.confidence

    def _sun(self) -> None:
        """Write the sun's position at the maps' times; NaN where the time of day is unknown."""
        flight, place = self._flight, _place_of(self._flight)
        at_s = [(each.at_ns + flight.utc_ahead_ns) / NS_PER_S for each in flight.maps]
        found = np.full((len(at_s), 2), np.nan)
        if flight.utc_ahead_ns:
            suns = [sun_position(place, each) for each in at_s]
            found = np.array([(each.azimuth_deg, each.elevation_deg) for each in suns])
        for values, what in zip(found.T, ("azimuth", "elevation"), strict=True):
            name = f"solar_{what}_angle"
            self._cf.numbers(name, ("time",), "degree", standard_name=name)[:] = values

    def _tracks(self, group: "netCDF4.Group") -> None:
        flight = self._flight
        tracks = list(flight.tracks.values())
        group.featureType = "trajectory"
        group.createDimension("vehicle", len(tracks))
        group.createDimension("sample", sum(len(each.at_ns) for each in tracks))
        serials = [each.serial for each in tracks]
        self._cf.texts("serial", "vehicle", "serial number", group)[:] = characters(serials)
        group["serial"].cf_role = "trajectory_id"
        names = [flight.names.get(each, each) for each in serials]
        self._cf.texts("vehicle_name", "vehicle", "name of the vehicle", group)[:] = characters(
            names
        )
        count = group.createVariable("sample_count", "i4", ("vehicle",))
        count.setncatts({"long_name": "samples of each vehicle", "sample_dimension": "sample"})
        count[:] = [len(each.at_ns) for each in tracks]
        points_m = np.concatenate([np.column_stack([t.east_m, t.north_m]) for t in tracks])
        place = np.array(flight.lon_lat(points_m)).reshape(-1, 2)
        self._cf.times("sample_time", np.concatenate([t.at_ns for t in tracks]), group, "sample")
        for values, about in (
            (place[:, 0], ("longitude", "degrees_east", {"standard_name": "longitude"})),
            (place[:, 1], ("latitude", "degrees_north", {"standard_name": "latitude"})),
            (points_m[:, 0], ("sample_x", "m", {"standard_name": "projection_x_coordinate"})),
            (points_m[:, 1], ("sample_y", "m", {"standard_name": "projection_y_coordinate"})),
        ):
            self._cf.numbers(about[0], ("sample",), about[1], group, **about[2])[:] = values
        at = {"coordinates": "sample_time latitude longitude sample_x sample_y"}
        height = {"long_name": "height above takeoff", **at, "grid_mapping": CRS}
        yaw = {"standard_name": "platform_orientation", **at, "grid_mapping": CRS}
        self._cf.numbers("height", ("sample",), "m", group, **height)[:] = np.concatenate(
            [each.height_m for each in tracks]
        )
        self._cf.numbers("heading", ("sample",), "degree", group, **yaw)[:] = np.concatenate(
            [each.yaw_deg for each in tracks]
        )

    def _declare_states(self) -> None:
        self._cf.times("state_time", None)
        for axis in ("east", "north"):
            what = f"velocity of the clouds' shadows, {axis}ward, as estimated in flight"
            self._cf.numbers(f"shadow_velocity_{axis}", ("state_time",), "m s-1", long_name=what)
        self._file.createDimension("survey", None)
        self._cf.texts("survey_name", "survey", "name of the survey and its number")
        self._cf.cells(
            "survey_state",
            ("survey", "state_time"),
            "ground photographed by the survey",
            fill=UNKNOWN,
            flag_values=np.array([0, 1, 2], np.uint8),
            flag_meanings="not_yet in_shade in_sun",
            coordinates="survey_name",
        )

    def _add_state(self, state: RecordedState) -> None:
        number, self._states = self._states, self._states + 1
        self._file["state_time"][number] = self._cf.seconds(state.at_ns)
        east_north = state.velocity_mps or (np.nan, np.nan)
        for axis, value in zip(("east", "north"), east_north, strict=True):
            self._file[f"shadow_velocity_{axis}"][number] = value
        for name, cells in state.surveys.items():
            if name not in self._surveys:
                self._file["survey_name"][len(self._surveys)] = characters([name])[0]
                self._surveys.append(name)
            self._file["survey_state"][self._surveys.index(name), number] = cells

    def _add_forecast(self, forecast: RecordedForecast) -> None:
        """Write a forecast; some are excluded: those with other lead times than the first, and
        those issued within `FORECAST_EVERY_NS` after one."""
        file, issued = self._file, "forecast_reference_time"
        if forecast.issued_at_ns < self._forecast_due_ns:
            return
        if not self._forecasts:
            self._cf.times(issued, None, standard_name=issued)
            self._cf.axis("lead", forecast.lead_s, "s", "forecast_period")
            valid = file.createVariable("valid_time", "f8", (issued, "lead"))
            valid.setncatts(self._cf.time_attributes("time"))
            self._cf.cells(
                "sun_probability",
                (issued, "lead"),
                "probability that the place is in sun at the valid time",
                scale_factor=np.float32(1.0 / 255.0),
                coordinates="valid_time",
            )
        if not np.array_equal(file["lead"][:], forecast.lead_s):
            return
        self._forecast_due_ns = forecast.issued_at_ns + FORECAST_EVERY_NS
        number, self._forecasts = self._forecasts, self._forecasts + 1
        issued_s = self._cf.seconds(forecast.issued_at_ns)
        file[issued][number] = issued_s
        file["valid_time"][number] = issued_s + forecast.lead_s
        file["sun_probability"][number] = forecast.probability


def _place_of(flight: FlightData) -> LatLon:
    origin = flight.frame.origin
    return LatLon(origin.latitude_deg, origin.longitude_deg)
