"""Files that outlive the process: the audit, the recovery snapshot, ground images as GeoTIFF.

Formats, atomic writes and checks are here; what is written, and when, is decided by the station.
"""

from recon.model.errors import RecordError
from recon.record.geotiff import geotiff_bytes, write_ground_image

__all__ = ["RecordError", "geotiff_bytes", "write_ground_image"]
