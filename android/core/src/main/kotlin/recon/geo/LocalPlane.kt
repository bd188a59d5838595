package recon.geo

import kotlin.math.cos
import kotlin.math.sin
import kotlin.math.sqrt

private const val EQUATOR_RADIUS_M = 6_378_137.0
private const val ECCENTRICITY_SQUARED = 6.69437999014e-3

/** A plane touching the WGS84 ellipsoid at [origin]: good to a centimetre within 5 km. */
class LocalPlane(private val origin: LatLon) {
    private val northMPerDeg: Double
    private val eastMPerDeg: Double

    init {
        val latitude = Math.toRadians(origin.latitudeDeg)
        val w = 1.0 - ECCENTRICITY_SQUARED * sin(latitude) * sin(latitude)
        northMPerDeg = Math.toRadians(EQUATOR_RADIUS_M * (1.0 - ECCENTRICITY_SQUARED) / (w * sqrt(w)))
        eastMPerDeg = Math.toRadians(EQUATOR_RADIUS_M * cos(latitude) / sqrt(w))
    }

    /** Metres north of the origin. */
    fun northM(position: LatLon): Double = (position.latitudeDeg - origin.latitudeDeg) * northMPerDeg

    /** Metres east of the origin. */
    fun eastM(position: LatLon): Double = (position.longitudeDeg - origin.longitudeDeg) * eastMPerDeg

    fun position(northM: Double, eastM: Double): LatLon =
        LatLon(origin.latitudeDeg + northM / northMPerDeg, origin.longitudeDeg + eastM / eastMPerDeg)
}

/** Straight distance between two positions with heights above one datum, metres. */
fun distanceM(a: LatLon, aHeightM: Double, b: LatLon, bHeightM: Double): Double {
    val plane = LocalPlane(a)
    val north = plane.northM(b)
    val east = plane.eastM(b)
    val up = bHeightM - aHeightM
    return sqrt(north * north + east * east + up * up)
}
