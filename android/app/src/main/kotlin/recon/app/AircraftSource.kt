package recon.app

import recon.aircraft.Aircraft
import recon.geo.LatLon
import recon.session.Severity
import recon.sim.SimulatedAircraft
import recon.sim.SimulatedSettings

/** Where the app gets its aircraft. */
interface AircraftSource {
    /** First in the app's introduction to the station. */
    val appName: String

    /** What a person must know about this build before anything else; shown on the first screen. */
    val note: String

    /**
     * The aircraft from now on; its state is null until one is connected. [report] takes sentences about
     * it for the person, from any thread.
     */
    fun open(report: (Severity, String) -> Unit): Aircraft

    /** The connection to the station has ended. */
    fun close()
}

/** The simulated aircraft: for practice, and to try the network. */
class SimulatedSource(private val serial: String) : AircraftSource {
    override val appName = "Recon companion for Android, simulated aircraft"
    override val note =
        "Practice build: simulated aircraft $serial. It lacks DJI's runtime: no real drone can be connected."

    private var aircraft: SimulatedAircraft? = null

    /** One aircraft for the life of the process: it goes on flying when the app connects anew. */
    override fun open(report: (Severity, String) -> Unit): Aircraft =
        aircraft ?: SimulatedAircraft(SimulatedSettings(serial, HOME, HOME_ALTITUDE_M)).also { aircraft = it }

    override fun close() {
        aircraft?.close()
    }

    private companion object {
        /** The field of the demonstration. */
        val HOME = LatLon(41.9012, -93.6034)
        const val HOME_ALTITUDE_M = 275.0
    }
}
