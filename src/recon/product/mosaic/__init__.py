"""The mosaic in sun: each ground pixel from a photo in which it was in sun, most from above.

cameras (pose, lens) + ground (heights) + light (shade maps at a photo's time)
  -> choice of a photo for each cell -> windows of pixels -> cloud-optimised rasters, report
"""

from recon.product.mosaic.build import MosaicBuild, MosaicReport, MosaicSettings
from recon.product.mosaic.cameras import Camera, PhotoLens, camera_of_view
from recon.product.mosaic.choice import ChoiceSettings, Light, PixelChoice, PlacedPhoto
from recon.product.mosaic.ground import LevelGround, MosaicGround, SiteGround
from recon.product.mosaic.odm import OdmRun, opened_odm
from recon.product.mosaic.pixels import MosaicBand, read_jpeg
from recon.product.mosaic.place import placed_photos, plan_of, preview_cameras

__all__ = [
    "Camera",
    "ChoiceSettings",
    "LevelGround",
    "Light",
    "MosaicBand",
    "MosaicBuild",
    "MosaicGround",
    "MosaicReport",
    "MosaicSettings",
    "OdmRun",
    "PhotoLens",
    "PixelChoice",
    "PlacedPhoto",
    "SiteGround",
    "camera_of_view",
    "opened_odm",
    "placed_photos",
    "plan_of",
    "preview_cameras",
    "read_jpeg",
]
