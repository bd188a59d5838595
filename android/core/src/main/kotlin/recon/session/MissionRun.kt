package recon.session

import recon.aircraft.AircraftState
import recon.aircraft.FlightMode

/**
 * The one mission that the app flies for its station.
 *
 * Theory of operation.
 *
 *     none --(accepted)--> accepted --(state shows it)--> flown --(state shows it no longer)--> none
 *                             |                             |
 *                             +-(5 s)--> none, reported     +-(link lost for 5 s)--> setting: continue, hold, return
 *
 * DJI's aircraft drop some missions after accepting them; the station learns that by the report. Any
 * other order to move ends the mission here. The number of a mission counts from 1 and is in extended
 * telemetry while it is flown.
 */
class MissionRun(private val settings: SessionSettings) {
    /** The number of the newest mission that was accepted; 0 before the first. */
    var number = 0
        private set
    private var isAccepted = false
    private var isFlown = false
    private var startsByNs = Long.MAX_VALUE
    private var linkLossActsNs = Long.MAX_VALUE

    /** MissionID for telemetry: 0 unless state shows the mission. */
    fun idFor(state: AircraftState?): Int =
        if (isAccepted && state?.flightMode == FlightMode.WAYPOINT) number else 0

    val isRunning: Boolean get() = isAccepted

    val dueNs: Long get() = minOf(if (isFlown) Long.MAX_VALUE else startsByNs, linkLossActsNs)

    fun accepted(nowNs: Long) {
        number = number % 0xFFFF + 1
        isAccepted = true
        isFlown = false
        startsByNs = nowNs + settings.missionStartNs
    }

    /** Another order, the pilot or the aircraft has ended it. */
    fun ended() {
        isAccepted = false
        startsByNs = Long.MAX_VALUE
        linkLossActsNs = Long.MAX_VALUE
    }

    /** Takes the newest state. Modes may change to and fro while one mission replaces another. */
    fun observe(state: AircraftState, nowNs: Long) {
        if (!isAccepted) return
        if (state.flightMode == FlightMode.WAYPOINT) isFlown = true
        else if (isFlown && nowNs >= startsByNs) ended()
    }

    /** Whether an accepted mission has not started in time; it is then forgotten. */
    fun failedToStart(nowNs: Long): Boolean {
        if (isFlown || nowNs < startsByNs) return false
        ended()
        return true
    }

    fun linkLost(nowNs: Long) {
        if (settings.missionOnLinkLoss != LinkLossAction.CONTINUE) {
            linkLossActsNs = nowNs + settings.missionLinkLossDelayNs
        }
    }

    fun linkRestored() {
        linkLossActsNs = Long.MAX_VALUE
    }

    /** The action for a lost link that is due by [nowNs], once; null without one. */
    fun linkLossAction(nowNs: Long): LinkLossAction? {
        if (nowNs < linkLossActsNs) return null
        linkLossActsNs = Long.MAX_VALUE
        if (!isAccepted) return null
        ended()
        return settings.missionOnLinkLoss
    }
}
