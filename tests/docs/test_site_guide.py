"""The guide to a site: its examples together are a site, its table of limits is the code's."""

import json
import re
import shutil
from dataclasses import asdict
from pathlib import Path

from recon.model.airspace import FlightLimits
from recon.model.vehicle import Failsafe
from recon.site import Site, demo_site_folder, load_site
from recon.site.report import site_report
from recon.site.schema import LimitsTable

GUIDE = Path(__file__).parents[2] / "docs/how-to/prepare-a-site.md"
TOML = re.compile(r"```toml\n(.*?)```", re.DOTALL)
SPARE = {
    "type": "Feature",
    "properties": {"name": "spare", "altitude_m": 275.0},
    "geometry": {"type": "Point", "coordinates": [-93.6028, 41.9012]},
}


def guides_site(folder: Path) -> Site:
    """Return the site of all the guide's examples, with the demonstration's files."""
    shutil.copytree(demo_site_folder(), folder, dirs_exist_ok=True)
    pads = {"type": "FeatureCollection", "features": [SPARE]}
    (folder / "landing_pads.geojson").write_text(json.dumps(pads), encoding="utf-8")
    blocks = TOML.findall(GUIDE.read_text(encoding="utf-8"))
    (folder / "site.toml").write_text("\n".join(blocks), encoding="utf-8")
    return load_site(folder)


def test_the_examples_together_are_a_site_without_warnings(tmp_path: Path) -> None:
    site = guides_site(tmp_path)
    (profile,) = site.profiles.values()
    assert (profile.failsafe, profile.endurance_s) == (Failsafe.GO_HOME, 1440.0)
    assert site.limits == FlightLimits(
        max_height_above_ground_m=130.0,
        max_distance_from_home_m=600.0,
        battery_reserve_fraction=0.3,
    )
    assert site.elevation is not None
    assert len(site.layers.files) == 5
    assert not any(line.startswith("warning") for line in site_report(site))


def test_the_table_of_limits_tells_every_default_and_range() -> None:
    rows = re.findall(
        r"^\| `(\w+)` \|.*\| ([\d.,]+) \| ([\d.,]+) to ([\d.,]+) \|$",
        GUIDE.read_text(encoding="utf-8"),
        re.MULTILINE,
    )
    stated = {key: tuple(float(n.replace(",", "")) for n in numbers) for key, *numbers in rows}
    defaults = asdict(FlightLimits())
    assert list(stated) == list(defaults)
    bounds = LimitsTable.__annotations__
    for key, (default, lowest, highest) in stated.items():
        meta = bounds[key].__args__[0].__metadata__[0]
        assert (default, lowest, highest) == (defaults[key], meta.ge, meta.le)
