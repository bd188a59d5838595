"""Flown regions on the command line: which one is meant, from which day on, and their table."""

from datetime import date

from recon.cli.output import print_line, print_table
from recon.client import ClientError
from recon.client.surveys import FlownRegionList, FlownRegionStatus
from recon.model.survey import height_text
from recon.model.units import HECTARE_M2

TODAY = "today"


class FlownRegionError(ClientError):
    """No flown region is meant, or no day."""


def region_asked(known: FlownRegionList, asked: str) -> FlownRegionStatus:
    """Return the region of an id, or of a name the one flown last; raises `FlownRegionError`."""
    for region in known.regions:
        if asked in (region.id, region.region):
            return region
    names = ", ".join(dict.fromkeys(region.region for region in known.regions)) or "none"
    raise FlownRegionError(f"Region {asked!a} was not surveyed yet; available: {names}")


def since_day(known: FlownRegionList, asked: str | None) -> date | None:
    """Return the day from which on cells are left out; raises `FlownRegionError`."""
    if asked is None or asked == TODAY:
        return known.today if asked == TODAY else None
    try:
        return date.fromisoformat(asked)
    except ValueError:
        raise FlownRegionError(
            f"--since: expected a day such as {known.today}, or today; got {asked!a}"
        ) from None


def print_flown_regions(known: FlownRegionList) -> None:
    """Print the flown regions, a line for each day under each."""
    rows = [
        (
            region.region,
            region.id,
            height_text(region.height_above_takeoff_m, region.height_above_ground_m),
            "simulated" if region.is_simulated else "",
            f"{_ha(region.left_m2)} of {_ha(region.reached_m2)} left",
            region.refusal or "; ".join(region.changes),
        )
        for region in known.regions
    ]
    columns = ("region", "id", "height", "drones", "left", "changed")
    print_table("flown regions", columns, rows)
    days = [
        (region.region, region.id, each.day.isoformat(), _ha(each.imaged_m2), _ha(each.in_sun_m2))
        for region in known.regions
        for each in region.days
    ]
    if days:
        print_table("days", ("region", "id", "day", "imaged", "in sun"), days)
    for sentence in known.unreadable:
        print_line(sentence)


def _ha(area_m2: float) -> str:
    return f"{area_m2 / HECTARE_M2:.2f} ha"
