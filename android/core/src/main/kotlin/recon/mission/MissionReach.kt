package recon.mission

import recon.aircraft.AircraftState
import recon.aircraft.MissionPlan
import recon.geo.distanceM

private const val FARTHEST_START_M = 10_000.0
private const val M_PER_KM = 1_000.0

/**
 * Why an aircraft where it is, and as it is set, would not fly a plan, or null. DJI's aircraft accept such
 * missions and drop them without a word.
 */
fun reachProblem(plan: MissionPlan, state: AircraftState): String? {
    val first = plan.points.first().position
    val startM = state.position?.let { distanceM(it, 0.0, first, 0.0) } ?: 0.0
    if (startM > FARTHEST_START_M) {
        return "The first waypoint is ${km(startM)} from the aircraft, at most ${km(FARTHEST_START_M)} can be flown: " +
            "is the station's site where the aircraft is?"
    }
    return heightProblem(plan, state) ?: distanceProblem(plan, state)
}

private fun heightProblem(plan: MissionPlan, state: AircraftState): String? {
    val mostM = state.facts.maxHeightM ?: return null
    val index = plan.points.indexOfFirst { it.heightAboveTakeoffM > mostM + MissionLimits.TOLERANCE }
    if (index < 0) return null
    return "Waypoint ${index + 1} is ${shown(plan.points[index].heightAboveTakeoffM)} m above takeoff, and the " +
        "aircraft's maximum height is set to ${shown(mostM)} m: raise it in DJI's app, or plan lower"
}

private fun distanceProblem(plan: MissionPlan, state: AircraftState): String? {
    val mostM = state.facts.maxDistanceM ?: return null
    val home = state.facts.home ?: return null
    val distancesM = plan.points.map { distanceM(home, 0.0, it.position, 0.0) }
    val index = distancesM.indexOfFirst { it > mostM }
    if (index < 0) return null
    return "Waypoint ${index + 1} is ${km(distancesM[index])} from the home point, and the aircraft's maximum " +
        "distance is set to ${km(mostM)}: raise it in DJI's app, or plan nearer"
}

private fun km(metres: Double): String = "%.1f km".format(java.util.Locale.ROOT, metres / M_PER_KM)
