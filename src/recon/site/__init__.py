"""A site's folder: the place, the eye above it, the vehicles known there."""

from recon.site.demo_folder import demo_site_folder
from recon.site.errors import SiteError
from recon.site.load import load_site
from recon.site.report import pose_report, site_report
from recon.site.site import Imager, Layers, Site, default_site

__all__ = [
    "Imager",
    "Layers",
    "Site",
    "SiteError",
    "default_site",
    "demo_site_folder",
    "load_site",
    "pose_report",
    "site_report",
]
