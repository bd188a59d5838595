package recon.session

import recon.aircraft.FlightMode
import recon.aircraft.StickSetpoint

/** What a stick stream asks for at a due time. */
sealed interface StickStep {
    data class Send(val setpoint: StickSetpoint) : StickStep

    /** Leave virtual stick: hover. */
    data object Release : StickStep

    data object PilotTookOver : StickStep
}

/**
 * The virtual stick between two commands of the station: repeats, and the dead-man (ICD 3.2.4).
 *
 * Theory of operation.
 *
 *     idle --(command)--> active --(timeout)--> neutral --(2 s)--> idle, with a hover
 *       ^                   |  ^                   |
 *       |                   |  +----(command)------+
 *       +--(stop, or the pilot leaves virtual stick)
 *
 * - *Active*: the setpoint goes to the aircraft ten times a second, because DJI's virtual stick needs
 *   5 to 25 Hz and the station may send less often.
 * - *Neutral*: the timeout, counted from the arrival of the last command, has passed. The same setpoint
 *   with zero velocity is sent, as the document asks. After 2 s a hover leaves virtual stick, so that
 *   the pilot's sticks work again.
 * - *Pilot*: once state has shown virtual stick, any other mode was chosen by the pilot or by the
 *   aircraft; repeating would take it back from them. Modes of the first second do not count: they may be
 *   those of a hover just before.
 */
class StickStream(private val settings: SessionSettings) {
    private sealed interface Phase {
        data object Idle : Phase

        data class Active(val setpoint: StickSetpoint, val timesOutNs: Long) : Phase

        data class Neutral(val setpoint: StickSetpoint, val releasesNs: Long) : Phase
    }

    private var phase: Phase = Phase.Idle
    private val cadence = Cadence(settings.stickPeriodNs)
    private var hasShownMode = false
    private var modeCountsNs = 0L

    val isIdle: Boolean get() = phase is Phase.Idle

    /** When [step] has something to do next. */
    val dueNs: Long
        get() = when (val now = phase) {
            is Phase.Idle -> Long.MAX_VALUE
            is Phase.Active -> minOf(cadence.dueNs, now.timesOutNs)
            is Phase.Neutral -> minOf(cadence.dueNs, now.releasesNs)
        }

    /** Starts or replaces the setpoint; the caller sends it now. */
    fun command(setpoint: StickSetpoint, timesOutNs: Long, nowNs: Long) {
        if (isIdle) {
            hasShownMode = false
            modeCountsNs = nowNs + settings.stickModeSettlesNs
        }
        phase = Phase.Active(setpoint, timesOutNs)
        cadence.startAt(nowNs + settings.stickPeriodNs)
    }

    fun stop() {
        phase = Phase.Idle
        cadence.stop()
    }

    /** The step that is due by [nowNs], or null. */
    fun step(nowNs: Long): StickStep? = when (val now = phase) {
        is Phase.Idle -> null
        is Phase.Active -> if (nowNs >= now.timesOutNs) neutral(now, nowNs) else repeated(now.setpoint, nowNs)
        is Phase.Neutral -> if (nowNs >= now.releasesNs) released() else repeated(now.setpoint, nowNs)
    }

    /** Takes the flight mode that the aircraft reports. */
    fun observe(mode: FlightMode, nowNs: Long): StickStep? {
        if (nowNs < modeCountsNs) return null
        if (mode == FlightMode.JOYSTICK) hasShownMode = true
        if (isIdle || mode == FlightMode.JOYSTICK || !hasShownMode) return null
        stop()
        return StickStep.PilotTookOver
    }

    private fun neutral(active: Phase.Active, nowNs: Long): StickStep {
        phase = Phase.Neutral(active.setpoint.stopped, nowNs + settings.stickNeutralNs)
        cadence.startAt(nowNs + settings.stickPeriodNs)
        return StickStep.Send(active.setpoint.stopped)
    }

    private fun repeated(setpoint: StickSetpoint, nowNs: Long): StickStep? =
        if (cadence.isDue(nowNs)) StickStep.Send(setpoint) else null

    private fun released(): StickStep {
        stop()
        return StickStep.Release
    }
}
