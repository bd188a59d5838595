"""What is kept of a flight: ground images as GeoTIFF."""

from recon.record.errors import RecordError
from recon.record.geotiff import geotiff_bytes, write_ground_image

__all__ = ["RecordError", "geotiff_bytes", "write_ground_image"]
