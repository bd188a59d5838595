"""Base maps: pictures of the ground from files, below everything that is drawn on the map."""

from pydantic import Field

from recon.api.schema.message import Message


class MapCoverageView(Message):
    """What a map shows of the site at one zoom level."""

    zoom: int
    share: float = Field(description="of the boundary with a margin, 0 to 1")
    metres_per_pixel: float


class BaseMapView(Message):
    """A map file; with a `problem` it has no tiles to show."""

    name: str = Field(description="of the file")
    title: str
    kind: str = Field(description="MBTiles, PMTiles or GeoTIFF; empty with a problem")
    size_bytes: int
    version: str = Field(description="changes with the file; tiles asked for with it are kept")
    attribution: str
    min_zoom: int
    max_zoom: int
    tile_px: int
    west_deg: float
    south_deg: float
    east_deg: float
    north_deg: float
    covers: MapCoverageView | None = Field(
        description="the finest level that shows all of the site, else the most of it"
    )
    coverage: list[MapCoverageView] = Field(description="by zoom level, the coarsest first")
    problem: str | None = Field(description="why it is not shown")


class BaseMapsView(Message):
    """The base maps of the site's folder."""

    maps: list[BaseMapView]
    note: str | None = Field(description="why there is no map, and what to do")
