"""The mosaic in sun: each ground pixel from a photo in which it was in sun, most from above.

cameras (pose, lens) + ground (heights) + light (shade maps at a photo's time)
  -> choice of a photo for each cell -> windows of pixels -> cloud-optimised rasters, report
"""

from recon.product.mosaic.build import MosaicBuild, MosaicReport, MosaicSettings
from recon.product.mosaic.cameras import Camera, Lens, camera_of_view
from recon.product.mosaic.choice import Choice, ChoiceSettings, Light, PlacedPhoto
from recon.product.mosaic.ground import Ground, LevelGround, SiteGround
from recon.product.mosaic.odm import OdmRun, opened_odm
from recon.product.mosaic.pixels import Band, read_jpeg
from recon.product.mosaic.place import placed_photos, plan_of, preview_cameras

__all__ = [
    "Band",
    "Camera",
    "Choice",
    "ChoiceSettings",
    "Ground",
    "Lens",
    "LevelGround",
    "Light",
    "MosaicBuild",
    "MosaicReport",
    "MosaicSettings",
    "OdmRun",
    "PlacedPhoto",
    "SiteGround",
    "camera_of_view",
    "opened_odm",
    "placed_photos",
    "plan_of",
    "preview_cameras",
    "read_jpeg",
]
