package recon.app

import android.content.SharedPreferences
import recon.aircraft.AltitudeReference
import recon.session.HoverOnGround
import recon.session.LinkLossAction
import recon.session.SessionSettings
import java.util.Locale
import kotlin.random.Random

/** What outlives the process. */
class AppSettings(private val stored: SharedPreferences) {
    /** As it was typed or scanned. */
    var address: String
        get() = stored.getString("address", "").orEmpty()
        set(value) = stored.edit().putString("address", value).apply()

    var altitudeReference: AltitudeReference
        get() = choice("altitude_reference", AltitudeReference.TAKEOFF)
        set(value) = store("altitude_reference", value)

    var missionOnLinkLoss: LinkLossAction
        get() = choice("mission_on_link_loss", LinkLossAction.HOLD)
        set(value) = store("mission_on_link_loss", value)

    var hoverOnGround: HoverOnGround
        get() = choice("hover_on_ground", HoverOnGround.IGNORE)
        set(value) = store("hover_on_ground", value)

    /** Control that was released stays released when Android ends and restarts the process. */
    var isReleased: Boolean
        get() = stored.getBoolean("is_released", false)
        // commit: the next thing that happens may be the end of the process.
        set(value) = Unit.also { stored.edit().putBoolean("is_released", value).commit() }

    /** Serial of this phone's simulated aircraft: two phones must not report the same. */
    val simulatedSerial: String
        get() = stored.getString("simulated_serial", null) ?: newSerial()

    fun session(appName: String, startedS: Long) =
        SessionSettings(altitudeReference, missionOnLinkLoss, hoverOnGround, appName, startedS)

    private fun newSerial(): String = String.format(Locale.ROOT, "SIM-%04X", Random.nextInt(0x10000)).also {
        stored.edit().putString("simulated_serial", it).apply()
    }

    private inline fun <reified T : Enum<T>> choice(key: String, preset: T): T =
        enumValues<T>().find { it.name == stored.getString(key, null) } ?: preset

    private fun store(key: String, value: Enum<*>) = stored.edit().putString(key, value.name).apply()
}
