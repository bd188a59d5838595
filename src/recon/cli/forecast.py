"""`recon forecast`: predicted sun from the newest of recorded maps."""

from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from recon.cli.output import print_line
from recon.cli.recorded_maps import (
    FolderArgument,
    RecordedMaps,
    ShadeOption,
    StepOption,
    SunOption,
    recorded_maps,
    refuse_used,
)
from recon.forecast import FORECASTERS, ForecastSettings, ForecastState
from recon.model.errors import RecordError
from recon.model.shade import SURE, SunForecast
from recon.record.raster.sun_geotiff import write_sun
from recon.score.table_rows import percent, plain, table

USUAL_LEADS = "15,30,60,120,300"


def forecast_command(
    folder: FolderArgument,
    out: Annotated[Path, typer.Option(help="New or empty folder for the GeoTIFFs.")],
    leads: Annotated[str, typer.Option(help="Seconds ahead, with commas.")] = USUAL_LEADS,
    method: Annotated[str, typer.Option(help="A forecast method.")] = "advection",
    step_s: StepOption = None,
    sun: SunOption = 1.0,
    shade: ShadeOption = 0.0,
) -> None:
    """Forecast the sun after the newest of recorded maps: a GeoTIFF for each lead."""
    if method not in FORECASTERS:
        raise RecordError(f"--method: expected {' or '.join(FORECASTERS)}, got {method}")
    leads_s = _leads_s(leads)
    refuse_used(out)
    recorded = recorded_maps(folder, step_s, sun, shade)
    found = _forecast(recorded, method, leads_s)
    _create(out)
    rows = [_written(out, recorded, found, lead_s) for lead_s in leads_s]
    _print(recorded, found, rows, out)


def _leads_s(text: str) -> tuple[float, ...]:
    try:
        leads_s = tuple(sorted({float(part) for part in text.split(",")}))
    except ValueError:
        leads_s = ()
    if not leads_s or not all(0.0 < each <= 86_400.0 for each in leads_s):
        raise RecordError(f"--leads: expected seconds with commas, as {USUAL_LEADS}, got {text!a}")
    return leads_s


def _forecast(recorded: RecordedMaps, method: str, leads_s: tuple[float, ...]) -> SunForecast:
    """Return the forecast of the newest map, its leads in the methods' time."""
    scaled = tuple(lead_s / recorded.time_scale for lead_s in leads_s)
    settings = ForecastSettings(method=method, lead_s=(0.0, *scaled))
    forecaster, state = FORECASTERS[method], ForecastState()
    for shade in recorded.maps():
        state = forecaster.observed(state, shade, settings)
    return forecaster.forecast(state, settings)


def _create(out: Path) -> None:
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise RecordError(
            f"{out}: expected a new folder, got: {problem.strerror or problem}"
        ) from problem


def _written(
    out: Path, recorded: RecordedMaps, found: SunForecast, lead_s: float
) -> tuple[str, ...]:
    scaled_s = lead_s / recorded.time_scale
    index = int(np.argmin(np.abs(found.lead_s - scaled_s)))
    probability = found.sun_probability[index].astype(np.float32) / np.float32(SURE)
    with np.errstate(invalid="ignore"):
        is_seen = found.horizon_s >= scaled_s
    path = out / f"sun-{lead_s:06.0f}s.tif"
    write_sun(path, recorded.files[-1], probability, is_seen)
    sunlit = float((probability >= 0.5).mean())
    return f"{lead_s:g}", percent(float(is_seen.mean())), percent(sunlit), path.name


def _print(
    recorded: RecordedMaps, found: SunForecast, rows: list[tuple[str, ...]], out: Path
) -> None:
    print_line(
        f"after {recorded.files[-1].name}, by {found.method} from {len(recorded.files)} maps"
    )
    if found.velocity_mps is not None:
        cells = np.array(found.velocity_mps) / found.grid.cell_m * recorded.step_s
        east, north = (each / recorded.time_scale for each in cells.tolist())
        moves = f"{plain(east)} cells right and {plain(-north)} down"
        print_line(f"shade moves {moves} in {recorded.step_s:g} s, the usual time between maps")
    head = ("lead, s", "clouds in view, %", "sun likelier, %", "file")
    for line in table(head, rows).splitlines():
        print_line(line)
    print_line(f"wrote {out}")
