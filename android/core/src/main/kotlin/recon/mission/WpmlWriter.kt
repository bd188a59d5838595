package recon.mission

import org.w3c.dom.Element
import recon.aircraft.DroneNumber
import recon.aircraft.MissionPlan
import recon.aircraft.PlanPoint
import java.util.Locale

/** What a mission file states beside the plan. */
data class WpmlOptions(
    val createdMs: Long,
    val drone: DroneNumber? = null,
    /** The aircraft's own setting, above takeoff: the file leaves it as it is. Null: unknown. */
    val goHomeHeightM: Double? = null,
)

/**
 * The two files of a waypoint mission in DJI's WPML: the template that a person may edit, and the wayline
 * that the aircraft flies. Heights are relative to the takeoff point (`relativeToStartPoint`). The station
 * writes the same documents for plans that other apps fly; `vectors/wpml/` holds what both must produce.
 *
 * The plan must be one that `planProblem` accepts.
 */
class WpmlWriter(private val plan: MissionPlan, private val options: WpmlOptions) {

    private val isLevel = plan.points.maxOf { it.heightAboveTakeoffM } - plan.points.minOf { it.heightAboveTakeoffM } <
        LEVEL_WITHIN_M

    /** The waypoints with actions, in order: their groups are counted without gaps. */
    private val withActions = plan.points.indices.filter { index ->
        plan.points[index].let { it.loiterS != null || it.gimbalPitchDeg != null }
    }

    fun template(): ByteArray = kmlFile {
        add("wpml:author", "Recon")
        add("wpml:createTime", "${options.createdMs}")
        add("wpml:updateTime", "${options.createdMs}")
        missionConfig()
        add("Folder") {
            add("wpml:templateType", "waypoint")
            add("wpml:templateId", "0")
            add("wpml:waylineCoordinateSysParam") {
                add("wpml:coordinateMode", "WGS84")
                add("wpml:heightMode", HEIGHT_MODE)
            }
            add("wpml:autoFlightSpeed", number(plan.points.first().speedMps))
            add("wpml:gimbalPitchMode", "manual")
            add("wpml:globalHeight", number(plan.points.first().heightAboveTakeoffM))
            add("wpml:globalWaypointHeadingParam") { heading() }
            add("wpml:globalWaypointTurnMode", turnMode(0))
            add("wpml:globalUseStraightLine", "1")
            plan.points.forEachIndexed { index, point -> templatePlacemark(index, point) }
        }
    }

    fun waylines(): ByteArray = kmlFile {
        missionConfig()
        add("Folder") {
            add("wpml:templateId", "0")
            add("wpml:executeHeightMode", HEIGHT_MODE)
            add("wpml:waylineId", "0")
            add("wpml:autoFlightSpeed", number(plan.points.first().speedMps))
            plan.points.forEachIndexed { index, point -> waylinePlacemark(index, point) }
        }
    }

    private fun Element.missionConfig() = add("wpml:missionConfig") {
        add("wpml:flyToWaylineMode", "safely")
        add("wpml:finishAction", if (plan.landsAtEnd) "autoLand" else "noAction")
        // Without its controller it flies home and not the rest of the mission: no pilot could stop it.
        add("wpml:exitOnRCLost", "executeLostAction")
        add("wpml:executeRCLostAction", "goBack")
        val firstM = plan.points.first().heightAboveTakeoffM
        add("wpml:takeOffSecurityHeight", number(firstM.coerceIn(LOWEST_TAKEOFF_M, HIGHEST_TAKEOFF_M)))
        add("wpml:globalTransitionalSpeed", number(plan.points.first().speedMps))
        options.goHomeHeightM?.let { add("wpml:globalRTHHeight", number(it)) }
        options.drone?.let { drone(it) }
    }

    private fun Element.drone(drone: DroneNumber) {
        add("wpml:droneInfo") {
            add("wpml:droneEnumValue", "${drone.enumValue}")
            add("wpml:droneSubEnumValue", "${drone.subEnumValue}")
        }
        drone.camera?.let { camera ->
            add("wpml:payloadInfo") {
                add("wpml:payloadEnumValue", "${camera.enumValue}")
                add("wpml:payloadPositionIndex", "0")
            }
        }
    }

    private fun Element.templatePlacemark(index: Int, point: PlanPoint) = add("Placemark") {
        position(index, point)
        // Not its ellipsoidHeight: that of the takeoff point is not known here.
        if (!isLevel) add("wpml:height", number(point.heightAboveTakeoffM))
        add("wpml:useGlobalHeight", if (isLevel) "1" else "0")
        add("wpml:useGlobalSpeed", "0")
        add("wpml:waypointSpeed", number(point.speedMps))
        add("wpml:useGlobalHeadingParam", "1")
        add("wpml:useGlobalTurnParam", "0")
        turn(index, point)
        add("wpml:useStraightLine", "1")
        actions(index, point)
    }

    private fun Element.waylinePlacemark(index: Int, point: PlanPoint) = add("Placemark") {
        position(index, point)
        add("wpml:executeHeight", number(point.heightAboveTakeoffM))
        add("wpml:waypointSpeed", number(point.speedMps))
        add("wpml:waypointHeadingParam") { heading() }
        turn(index, point)
        add("wpml:useStraightLine", "1")
        actions(index, point)
    }

    private fun Element.position(index: Int, point: PlanPoint) {
        val place = point.position
        add("Point") { add("coordinates", "${degrees(place.longitudeDeg)},${degrees(place.latitudeDeg)}") }
        add("wpml:index", "$index")
    }

    private fun Element.heading() {
        add("wpml:waypointHeadingMode", "followWayline")
        add("wpml:waypointHeadingPathMode", "followBadArc")
    }

    private fun Element.turn(index: Int, point: PlanPoint) = add("wpml:waypointTurnParam") {
        add("wpml:waypointTurnMode", turnMode(index))
        add("wpml:waypointTurnDampingDist", number(if (cutsCorner(index)) point.cornerRadiusM else 0.0))
    }

    private fun turnMode(index: Int) = if (cutsCorner(index)) COORDINATED else STOPPING

    /** First and last waypoint have no corner to cut. */
    private fun cutsCorner(index: Int) = plan.isCurved && index in 1 until plan.points.lastIndex

    /** The actions of a waypoint; the photos begin at the first, once the gimbal is turned. */
    private fun Element.actions(index: Int, point: PlanPoint) {
        val before = withActions.count { it < index }
        val everyS = plan.photoEveryS
        if (index in withActions) actionGroup(if (everyS == null || index == 0) before else before + 1, index, index) {
            trigger("reachPoint")
            point.gimbalPitchDeg?.let { gimbal(it) }
            point.loiterS?.let { loiter(it, id = if (point.gimbalPitchDeg == null) 0 else 1) }
        }
        if (index == 0 && everyS != null) actionGroup(withActions.count { it == 0 }, 0, plan.points.lastIndex) {
            trigger("multipleTiming", everyS)
            photo()
        }
    }

    private fun Element.actionGroup(id: Int, first: Int, last: Int, content: Element.() -> Unit) =
        add("wpml:actionGroup") {
            add("wpml:actionGroupId", "$id")
            add("wpml:actionGroupStartIndex", "$first")
            add("wpml:actionGroupEndIndex", "$last")
            add("wpml:actionGroupMode", "sequence")
            content()
        }

    private fun Element.trigger(type: String, everyS: Double? = null) = add("wpml:actionTrigger") {
        add("wpml:actionTriggerType", type)
        everyS?.let { add("wpml:actionTriggerParam", number(it)) }
    }

    private fun Element.photo() = action(0, "takePhoto") {
        add("wpml:payloadPositionIndex", "0")
        add("wpml:fileSuffix", "recon")
        options.drone?.camera?.let {
            add("wpml:payloadLensIndex", it.lens)
            add("wpml:useGlobalPayloadLensIndex", "0")
        }
    }

    private fun Element.gimbal(pitchDeg: Double) = action(0, "gimbalRotate") {
        add("wpml:gimbalHeadingYawBase", "north")
        add("wpml:gimbalRotateMode", "absoluteAngle")
        add("wpml:gimbalPitchRotateEnable", "1")
        add("wpml:gimbalPitchRotateAngle", number(pitchDeg))
        add("wpml:gimbalRollRotateEnable", "0")
        add("wpml:gimbalRollRotateAngle", "0")
        add("wpml:gimbalYawRotateEnable", "0")
        add("wpml:gimbalYawRotateAngle", "0")
        add("wpml:gimbalRotateTimeEnable", "0")
        add("wpml:gimbalRotateTime", "0")
        add("wpml:payloadPositionIndex", "0")
    }

    private fun Element.loiter(seconds: Double, id: Int) = action(id, "hover") {
        add("wpml:hoverTime", number(seconds))
    }

    private fun Element.action(id: Int, function: String, parameters: Element.() -> Unit) = add("wpml:action") {
        add("wpml:actionId", "$id")
        add("wpml:actionActuatorFunc", function)
        add("wpml:actionActuatorFuncParam", content = parameters)
    }

    internal companion object {
        const val HEIGHT_MODE = "relativeToStartPoint"
        const val COORDINATED = "coordinateTurn"
        const val STOPPING = "toPointAndStopWithDiscontinuityCurvature"
        private const val LOWEST_TAKEOFF_M = 1.2
        private const val HIGHEST_TAKEOFF_M = 1_500.0
        private const val LEVEL_WITHIN_M = 0.01

        /** Millimetres, or thousandths of a second or degree. */
        fun number(value: Double): String = "%.3f".format(Locale.ROOT, value)

        /** A millimetre on the ground. */
        fun degrees(value: Double): String = "%.8f".format(Locale.ROOT, value)
    }
}
