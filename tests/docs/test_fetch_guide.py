"""docs/how-to/fetch-before-leaving.md: its addresses name real tiles, numbers are the code's."""

import re
import shlex
import tomllib
from pathlib import Path

from recon.cli.elevation_fetch import LARGEST_TILE_BYTES
from recon.fetching.source_address import local_path
from recon.guidance.flying_hours import FlyingLimits, corner_deg
from recon.model.survey_camera import CAMERAS
from recon.site.elevation_tiles import DegreeTile, has_places, tile_address
from recon.site.load import read_fetch_table
from recon.site.new_site import NewSiteFields, make_site, point_above_sea_level
from recon.site.open_meteo import FARTHEST_DEG, MOST_HOURS
from recon.site.terrain_source import KNOWN, known_elevation

PAGE = (Path(__file__).parents[2] / "docs/how-to/fetch-before-leaving.md").read_text("utf-8")
BLOCKS = re.findall(r"^```(\w*)\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
COMMANDS = [
    shlex.split(line)
    for _, block in BLOCKS
    for line in block.splitlines()
    if line.startswith("recon site fetch")
]


def test_the_addresses_name_the_tiles_as_their_publishers_do() -> None:
    given = [words[words.index("--elevation") + 1] for words in COMMANDS if "--elevation" in words]
    copernicus, threedep, county = given
    assert tile_address(copernicus, DegreeTile(52, 13)).endswith(
        "/Copernicus_DSM_COG_10_N52_00_E013_00_DEM.tif"
    )
    assert "_S34_00_W071_00_" in tile_address(copernicus, DegreeTile(-34, -71))
    # 3DEP names a tile by its north-western corner.
    assert tile_address(threedep, DegreeTile(40, -112)).endswith("/n41w112/USGS_1_n41w112.tif")
    assert [known_elevation(each) is not None for each in given] == [True, True, False]
    assert local_path(county) is not None
    assert not has_places(county)


def test_the_table_for_the_sites_file_is_one(tmp_path: Path) -> None:
    (text,) = (block for language, block in BLOCKS if language == "toml")
    path = make_site(
        tmp_path,
        point_above_sea_level(50.0, 14.0, 200.0),
        NewSiteFields(name="x", drones=0, has_imager=False),
    )
    path.write_text(path.read_text() + text)
    table = read_fetch_table(tmp_path)
    assert table.elevation == tomllib.loads(text)["fetch"]["elevation"]
    assert table.elevation in PAGE.split("```toml")[0]
    assert table.weather is not None


def test_the_pages_numbers_and_notices_are_the_programs() -> None:
    plain = " ".join(PAGE.split())
    camera = CAMERAS["mavic3m"]
    limits = FlyingLimits(corner_deg(camera.across_deg, camera.along_deg))
    for text in (
        f"{LARGEST_TILE_BYTES // 1024**2} MiB",
        f"({FARTHEST_DEG:g} degrees) or of more than {MOST_HOURS} hours",
        f"{limits.lowest_sun_deg:g} degrees, unless `--lowest-sun`",
        f"no more than {100 * limits.most_cloud_share:g} %",
        f"{limits.corner_deg:.0f} degrees for the Mavic 3M, so with the sun above "
        f"{limits.highest_sun_deg:.0f}",
        *(model.zero for model in KNOWN),
        KNOWN[0].notice,
    ):
        assert text in plain, text
