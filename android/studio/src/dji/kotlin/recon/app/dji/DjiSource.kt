package recon.app.dji

import recon.aircraft.Aircraft
import recon.aircraft.AircraftCommand
import recon.aircraft.AircraftState
import recon.aircraft.Answer
import recon.aircraft.ReleasedPhoto
import recon.aircraft.VideoFrame
import recon.app.AircraftSource
import recon.session.Severity

/** What comes of DJI's registration; calls from any thread. */
interface RegistrationListener {
    fun registered()

    /** [reason] in DJI's words. */
    fun failed(reason: String)
}

/**
 * The aircraft of DJI's SDK.
 *
 * Theory of operation. *New*; [open] begins the registration, once for the life of the process:
 * *registering*. DJI's answer leads to *registered*, where [connect] makes the aircraft, or to *failed*,
 * with a sentence, from which the next [open] tries again: the first registration of a phone needs
 * internet. Until it is registered there is no state, and orders are refused.
 */
class DjiSource(
    private val register: (RegistrationListener) -> Unit,
    private val connect: () -> Aircraft,
) : AircraftSource {
    override val appName = "Recon companion for Android, DJI Mobile SDK 5"
    override val note = "Never flown: follow the first-flight protocol, docs/how-to/first-flight.md, propellers off."

    private val aircraft = RegisteredAircraft()
    private var isBegun = false

    @Synchronized
    override fun open(report: (Severity, String) -> Unit): Aircraft {
        if (!isBegun) {
            isBegun = true
            report(Severity.INFO, "Registering with DJI")
            register(Registration(report))
        }
        return aircraft
    }

    override fun close() = Unit

    private inner class Registration(private val report: (Severity, String) -> Unit) : RegistrationListener {
        override fun registered() {
            aircraft.connected(connect())
            report(Severity.INFO, "Registered with DJI: waiting for the aircraft")
        }

        override fun failed(reason: String) {
            synchronized(this@DjiSource) { isBegun = false }
            val todo = "connect the phone to the internet once, check the API key, then connect again"
            report(Severity.ERROR, "DJI's SDK is not registered: $reason; $todo")
        }
    }
}

/** No aircraft until there is one. */
private class RegisteredAircraft : Aircraft {
    @Volatile
    private var registered: Aircraft? = null
    private var listener: ((VideoFrame) -> Unit)? = null
    private var photoListener: ((ReleasedPhoto) -> Unit)? = null

    @Synchronized
    fun connected(aircraft: Aircraft) {
        registered = aircraft
        aircraft.onFrame(listener)
        aircraft.onPhoto(photoListener)
    }

    override fun state(): AircraftState? = registered?.state()

    override fun execute(command: AircraftCommand, answered: (Answer) -> Unit) {
        registered?.execute(command, answered) ?: answered(Answer.Refused("DJI's SDK is not registered yet"))
    }

    @Synchronized
    override fun onFrame(listener: ((VideoFrame) -> Unit)?) {
        this.listener = listener
        registered?.onFrame(listener)
    }

    @Synchronized
    override fun onPhoto(listener: ((ReleasedPhoto) -> Unit)?) {
        photoListener = listener
        registered?.onPhoto(listener)
    }
}
