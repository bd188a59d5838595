package recon.app

import android.content.BroadcastReceiver
import android.content.Context
import android.content.Intent
import android.content.IntentFilter
import android.os.BatteryManager
import android.os.Build
import android.os.PowerManager
import recon.session.Severity

/** A sentence about the phone, when its state has become worse. */
data class PhoneWarning(val severity: Severity, val text: String)

/** Battery and heat of the phone: each step downwards is reported once, until it has recovered. */
class PhoneState {
    private var batteryStep = 0
    private var heatStep = 0

    /** [percent] of the charge, 0 to 100. */
    fun battery(percent: Int, isCharging: Boolean): PhoneWarning? {
        val step = if (isCharging) 0 else BATTERY_STEPS.count { percent <= it }
        val isWorse = step > batteryStep
        batteryStep = step
        if (!isWorse) return null
        val severity = if (step == BATTERY_STEPS.size) Severity.ERROR else Severity.WARNING
        return PhoneWarning(severity, "Phone battery $percent %: land or connect a charger before it ends")
    }

    /** [status] as in `PowerManager`: 0 none, 2 moderate, 3 severe, 4 critical. */
    fun thermal(status: Int): PhoneWarning? {
        val step = HEAT_STEPS.count { status >= it }
        val isWorse = step > heatStep
        heatStep = step
        return if (!isWorse) null else HEAT_WARNINGS[step - 1]
    }

    private companion object {
        val BATTERY_STEPS = listOf(20, 10, 5)
        val HEAT_STEPS = listOf(PowerManager.THERMAL_STATUS_MODERATE, PowerManager.THERMAL_STATUS_SEVERE)
        val HEAT_WARNINGS = listOf(
            PhoneWarning(Severity.WARNING, "Phone is hot: keep it in shade"),
            PhoneWarning(Severity.ERROR, "Phone is very hot and may shut down: land, and cool it"),
        )
    }
}

/** Passes the phone's battery and heat to a [PhoneState], and its warnings to [report]. */
class PhoneMonitor(private val context: Context, private val report: (PhoneWarning) -> Unit) {
    private val state = PhoneState()
    private val power = context.getSystemService(PowerManager::class.java)
    private val battery = object : BroadcastReceiver() {
        override fun onReceive(context: Context, intent: Intent) = batteryChanged(intent)
    }

    /** The listener; Android 8 does not have its type. */
    private var heat: Any? = null

    fun start() {
        // The broadcast is sticky: the first one comes at once.
        context.registerReceiver(battery, IntentFilter(Intent.ACTION_BATTERY_CHANGED))
        if (Build.VERSION.SDK_INT >= Build.VERSION_CODES.Q) listenToHeat()
    }

    @NewerAndroid
    private fun listenToHeat() {
        val listener = PowerManager.OnThermalStatusChangedListener { state.thermal(it)?.let(report) }
        power.addThermalStatusListener(listener)
        heat = listener
    }

    @NewerAndroid
    fun stop() {
        context.unregisterReceiver(battery)
        val listener = heat as? PowerManager.OnThermalStatusChangedListener ?: return
        power.removeThermalStatusListener(listener)
    }

    private fun batteryChanged(intent: Intent) {
        val level = intent.getIntExtra(BatteryManager.EXTRA_LEVEL, -1)
        val scale = intent.getIntExtra(BatteryManager.EXTRA_SCALE, -1)
        if (level < 0 || scale <= 0) return
        val isCharging = intent.getIntExtra(BatteryManager.EXTRA_PLUGGED, 0) != 0
        state.battery(100 * level / scale, isCharging)?.let(report)
    }
}
