"""Rasters: ground images, shade maps and forecasts as GeoTIFF, sunlit references, map folders."""
