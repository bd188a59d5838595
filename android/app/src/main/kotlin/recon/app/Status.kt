package recon.app

import recon.aircraft.AircraftState
import recon.aircraft.AltitudeReference
import recon.aircraft.BatteryWarning
import recon.aircraft.Capability
import recon.aircraft.ModelFunction
import recon.aircraft.functionWords
import recon.aircraft.has
import recon.session.CompanionSession
import recon.session.HoverOnGround
import recon.session.LinkLossAction
import kotlin.math.roundToInt

/** How a row of the screen is marked; its words state the same. */
enum class Level { NORMAL, CAUTION, PROBLEM }

data class Row(val words: String, val level: Level = Level.NORMAL)

/** The words of the screen. */
data class Status(
    val link: Row,
    val aircraft: Row,
    /** What the aircraft can do, as it answers, or as is expected of its model. */
    val functions: Row,
    val control: Row,
    val altitudeReference: Row,
    val missionOnLinkLoss: Row,
    /** Null for the usual setting: hover is ignored on the ground. */
    val hoverOnGround: Row?,
    val lastOrder: Row,
    val isReleased: Boolean,
    /** Whether the aircraft flies something for the station. */
    val isFlyingForStation: Boolean,
)

/** The screen's words for a session at a time of its clock. */
fun statusOf(session: CompanionSession, nowNs: Long): Status = Status(
    link = if (session.isLinkOpen) Row("Connected") else Row("No station", Level.PROBLEM),
    aircraft = aircraftRow(session.state, nowNs - session.settings.stateTimeoutNs),
    functions = functionsRow(session.state),
    control = controlRow(session),
    altitudeReference = altitudeRow(session.settings.altitudeReference),
    missionOnLinkLoss = linkLossRow(session.settings.missionOnLinkLoss),
    hoverOnGround = Row("Takes off", Level.CAUTION).takeIf { session.settings.hoverOnGround == HoverOnGround.TAKEOFF },
    lastOrder = Row(session.lastOrder.ifEmpty { "None yet" }),
    isReleased = session.isReleased,
    isFlyingForStation = session.hasMission || session.hasStick,
)

private fun aircraftRow(state: AircraftState?, staleBeforeNs: Long): Row {
    if (state == null) return Row("No aircraft", Level.PROBLEM)
    val name = state.serial ?: "Serial unknown"
    if (state.updatedNs < staleBeforeNs) return Row("$name: telemetry lost", Level.PROBLEM)
    val flight = if (state.isOnGround) "on the ground" else "flying, ${state.heightAboveTakeoffM.roundToInt()} m"
    val battery = state.batteryPercent?.let { "battery $it %" } ?: "battery unknown"
    return Row("$name: $flight, $battery", batteryLevel(state.batteryWarning))
}

private fun functionsRow(state: AircraftState?): Row {
    if (state == null) return Row("-")
    val isLimited = state.has(ModelFunction.MISSIONS) == Capability.UNSUPPORTED
    return Row(functionWords(state), if (isLimited) Level.CAUTION else Level.NORMAL)
}

private fun batteryLevel(warning: BatteryWarning): Level = when (warning) {
    BatteryWarning.NONE -> Level.NORMAL
    BatteryWarning.LOW -> Level.CAUTION
    BatteryWarning.SERIOUS -> Level.PROBLEM
}

private fun controlRow(session: CompanionSession): Row = when {
    session.isReleased -> Row("Pilot: released", Level.CAUTION)
    session.hasStick -> Row("Station: virtual stick")
    session.hasMission -> Row("Station: mission")
    session.isLinkOpen -> Row("Station")
    else -> Row("Pilot: no station")
}

private fun altitudeRow(reference: AltitudeReference): Row = when (reference) {
    AltitudeReference.TAKEOFF -> Row("Above takeoff")
    AltitudeReference.WGS84 -> Row("WGS84", Level.CAUTION)
}

private fun linkLossRow(action: LinkLossAction): Row = when (action) {
    LinkLossAction.CONTINUE -> Row("Continue", Level.CAUTION)
    LinkLossAction.HOLD -> Row("Hold")
    LinkLossAction.RETURN -> Row("Return")
}
