"""A site's folder: origin, imaging drone, vehicles, layers, elevation; read and checked."""

from recon.model.errors import SiteError
from recon.site.load import demo_site_folder, load_site, own_folder
from recon.site.report import pose_report, site_report
from recon.site.site import Imager, Layers, Site, default_site
