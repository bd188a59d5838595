package recon.aircraft

/**
 * Zero of a waypoint's altitude in this app; the station's `waypoint_altitude` must be the same.
 *
 * The only place where altitudes change their reference: the aircraft speaks of heights above takeoff
 * throughout (docs/icd.md, "Waypoint").
 */
enum class AltitudeReference(val shownName: String) {
    /** Revision of October 2021: height above the takeoff point. */
    TAKEOFF("takeoff"),

    /** First revision: WGS84 altitude, from which the app subtracts that of the takeoff point. */
    WGS84("wgs84"),
    ;

    /** Height above takeoff of a waypoint, metres; null when the altitude of the takeoff point is unknown. */
    fun heightAboveTakeoffM(altitudeM: Double, takeoffAltitudeM: Double?): Double? = when (this) {
        TAKEOFF -> altitudeM
        WGS84 -> takeoffAltitudeM?.let { altitudeM - it }
    }
}

/**
 * WGS84 altitude for telemetry, metres; NaN while the takeoff point's altitude is unknown. The same
 * number is added here and subtracted from waypoints, so that its error cancels.
 */
fun AircraftState.altitudeM(): Double = takeoffAltitudeM?.let { it + heightAboveTakeoffM } ?: Double.NaN
