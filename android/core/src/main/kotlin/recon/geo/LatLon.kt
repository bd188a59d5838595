package recon.geo

/** A WGS84 position, degrees. */
data class LatLon(val latitudeDeg: Double, val longitudeDeg: Double)
