"""The archive that DJI's apps open: WPML's two documents under DJI's names."""

import io
import zipfile

from recon.plans.flight_plan import ExportedPlan
from recon.plans.wpml import WpmlOptions, template_kml, waylines_wpml

EARLIEST = (1980, 1, 1, 0, 0, 0)
"""The entries' time: the same flight gives the same bytes."""


def kmz_of(plan: ExportedPlan, options: WpmlOptions) -> bytes:
    """Return the mission file of a flight: template and wayline."""
    documents = {
        "wpmz/template.kml": template_kml(plan, options),
        "wpmz/waylines.wpml": waylines_wpml(plan, options),
    }
    return zip_of(documents)


def zip_of(files: dict[str, bytes]) -> bytes:
    """Return an archive of files by their names; the same files give the same bytes."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name, EARLIEST)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, data)
    return out.getvalue()
