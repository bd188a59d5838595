"""The gaps that the photos of a flight have shown, as cells of a surveyed region."""

from pathlib import Path

import numpy as np
import shapely  # type: ignore[import-untyped, unused-ignore]

from recon.geo import cell_centres_m, shape_of
from recon.model.arrays import BoolArray
from recon.model.errors import SiteError
from recon.model.flown_region import FlownRegion
from recon.model.geo import LocalFrame
from recon.site.geojson import read_features, regions_of


def gaps_in(file: Path | None, frame: LocalFrame | None) -> shapely.Geometry | None:
    """Return the ground of a file that `recon tag` has written, in east-north metres.

    None: there is no such file, or nothing in it is near. Reads the disk.
    """
    if file is None or frame is None:
        return None
    try:
        regions = [found for each in read_features(file) for found in regions_of(each, frame)]
    except SiteError:
        return None
    return shapely.union_all([shape_of(each) for each in regions]) if regions else None


def gap_cells(last: FlownRegion, gaps: shapely.Geometry) -> BoolArray:
    """Return (R, C): the reached cells of a region whose centres lie in gaps."""
    shapely.prepare(gaps)
    east_m, north_m = np.meshgrid(*cell_centres_m(last.grid))
    found: BoolArray = last.is_reached & shapely.contains_xy(gaps, east_m, north_m)
    return found
