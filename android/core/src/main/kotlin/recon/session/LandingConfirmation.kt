package recon.session

import recon.aircraft.AircraftState

/**
 * Confirms landings that the station ordered. DJI's aircraft stop at 0.3 m and wait for a person to
 * look at the ground; the station's order stands for that look. A landing that the pilot began is the
 * pilot's to confirm.
 */
class LandingConfirmation(settings: SessionSettings) {
    private var isOrdered = false
    private val cadence = Cadence(settings.landingConfirmationPeriodNs)

    /** Notes whether the order just accepted ends in a landing. */
    fun ordered(landsAtEnd: Boolean) {
        isOrdered = landsAtEnd
        cadence.stop()
    }

    /** Whether a confirmation is due by [nowNs], for this state. */
    fun isDue(state: AircraftState, nowNs: Long): Boolean {
        if (!isOrdered || !state.needsLandingConfirmation) {
            cadence.stop()
            return false
        }
        if (cadence.dueNs == Long.MAX_VALUE) cadence.startAt(nowNs)
        return cadence.isDue(nowNs)
    }
}
