"""Read a flight in xarray: its record becomes one NetCDF file of maps, forecasts and tracks.

Run: uv run python examples/11_read_a_flight.py             (a short recorded flight)
     uv run python examples/11_read_a_flight.py FLIGHT.mcap (your own)
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import xarray

from recon.product.flight_netcdf import write_netcdf
from recon.product.flight_reader import read_flight

RECORDED = Path(__file__).parents[1] / "tests/replay/flights/pictures.mcap"


def main() -> None:
    """Print what the maps show, a forecast, and how often each drone was seen."""
    record = Path(sys.argv[1]) if len(sys.argv) > 1 else RECORDED
    with TemporaryDirectory() as folder:
        path = Path(folder) / "flight.nc"
        write_netcdf(read_flight(record), path)
        with xarray.open_dataset(path) as flight:
            shown = flight.transmittance.notnull().mean(("y", "x"))
            print(f"{len(flight.time)} shade maps that show up to {float(shown.max()):.0%}")
            newest = flight.sun_probability.isel(forecast_reference_time=-1).sel(lead=30.0)
            print(f"sun expected half a minute later: {float(newest.mean()):.0%}")
        with xarray.open_dataset(path, group="tracks") as tracks:
            for name, count in zip(
                tracks.vehicle_name.values, tracks.sample_count.values, strict=True
            ):
                print(f"{name}: {count} positions")


if __name__ == "__main__":
    main()
