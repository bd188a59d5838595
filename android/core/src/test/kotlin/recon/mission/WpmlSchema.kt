package recon.mission

import org.w3c.dom.Element

/** One element's rule in DJI's WPML reference. */
class Rule(val isRequired: Boolean, val isRepeated: Boolean = false, val accepts: (String) -> Boolean)

private fun oneOf(vararg values: String) = Rule(true) { it in values }
private fun number(low: Double, high: Double, isRequired: Boolean = true) =
    Rule(isRequired) { (it.toDoubleOrNull() ?: Double.NaN) in low..high }
private fun flag() = oneOf("0", "1")
private fun index() = Rule(true) { it.toIntOrNull() in 0..65_535 }
private fun parent(isRequired: Boolean = true, isRepeated: Boolean = false) = Rule(isRequired, isRepeated) { true }

private val HEADING = mapOf(
    "waypointHeadingMode" to oneOf("followWayline", "manually", "fixed", "smoothTransition", "towardPOI"),
    "waypointHeadingPathMode" to oneOf("clockwise", "counterClockwise", "followBadArc"),
)
private val TURN_MODES = oneOf(
    "coordinateTurn",
    "toPointAndStopWithDiscontinuityCurvature",
    "toPointAndStopWithContinuityCurvature",
    "toPointAndPassWithContinuityCurvature",
)
private val PLACEMARK = mapOf(
    "Point" to parent(),
    "index" to index(),
    "waypointSpeed" to number(1.0, 15.0),
    "waypointTurnParam" to parent(),
    "useStraightLine" to flag(),
    "actionGroup" to parent(isRequired = false, isRepeated = true),
)

/**
 * The elements of DJI's WPML that a waypoint mission may have, by their parent, with the ranges of the
 * reference (template.kml, waylines.wpml and common elements). Written from the reference, not from the writer.
 */
fun wpmlRules(isTemplate: Boolean): Map<String, Map<String, Rule>> = mapOf(
    "kml" to mapOf("Document" to parent()),
    "Document" to mapOf("missionConfig" to parent(), "Folder" to parent()) +
        if (isTemplate) mapOf(
            "author" to Rule(false) { it.isNotEmpty() },
            "createTime" to Rule(false) { it.toLongOrNull() != null },
            "updateTime" to Rule(false) { it.toLongOrNull() != null },
        ) else emptyMap(),
    "missionConfig" to mapOf(
        "flyToWaylineMode" to oneOf("safely", "pointToPoint"),
        "finishAction" to oneOf("goHome", "noAction", "autoLand", "gotoFirstWaypoint"),
        "exitOnRCLost" to oneOf("goContinue", "executeLostAction"),
        "executeRCLostAction" to oneOf("goBack", "landing", "hover"),
        "takeOffSecurityHeight" to number(1.2, 1_500.0),
        "globalTransitionalSpeed" to number(1.0, 15.0),
        "globalRTHHeight" to number(2.0, 1_500.0, isRequired = false),
        "droneInfo" to parent(isRequired = false),
        "payloadInfo" to parent(isRequired = false),
    ),
    "payloadInfo" to mapOf("payloadEnumValue" to index(), "payloadPositionIndex" to number(0.0, 2.0)),
    "droneInfo" to mapOf("droneEnumValue" to index(), "droneSubEnumValue" to index()),
    "Folder" to if (isTemplate) mapOf(
        "templateType" to oneOf("waypoint"),
        "templateId" to index(),
        "waylineCoordinateSysParam" to parent(),
        "autoFlightSpeed" to number(1.0, 15.0),
        "gimbalPitchMode" to oneOf("manual", "usePointSetting"),
        "globalHeight" to number(-200.0, 1_500.0),
        "globalWaypointHeadingParam" to parent(),
        "globalWaypointTurnMode" to TURN_MODES,
        "globalUseStraightLine" to flag(),
        "Placemark" to parent(isRepeated = true),
    ) else mapOf(
        "templateId" to index(),
        "executeHeightMode" to oneOf("WGS84", "relativeToStartPoint", "realTimeFollowSurface"),
        "waylineId" to index(),
        "autoFlightSpeed" to number(1.0, 15.0),
        "Placemark" to parent(isRepeated = true),
    ),
    "waylineCoordinateSysParam" to mapOf(
        "coordinateMode" to oneOf("WGS84"),
        "heightMode" to oneOf("EGM96", "relativeToStartPoint", "aboveGroundLevel", "realTimeFollowSurface"),
    ),
    "Placemark" to PLACEMARK + if (isTemplate) mapOf(
        "height" to number(-200.0, 1_500.0, isRequired = false),
        "useGlobalHeight" to flag(),
        "useGlobalSpeed" to flag(),
        "useGlobalHeadingParam" to flag(),
        "useGlobalTurnParam" to flag(),
    ) else mapOf("executeHeight" to number(-200.0, 1_500.0), "waypointHeadingParam" to parent()),
    "Point" to mapOf("coordinates" to Rule(true) { Regex("""-?\d+\.\d+,-?\d+\.\d+""").matches(it) }),
    "waypointHeadingParam" to HEADING,
    "globalWaypointHeadingParam" to HEADING,
    "waypointTurnParam" to mapOf("waypointTurnMode" to TURN_MODES, "waypointTurnDampingDist" to number(0.0, 1_000.0)),
    "actionGroup" to mapOf(
        "actionGroupId" to index(),
        "actionGroupStartIndex" to index(),
        "actionGroupEndIndex" to index(),
        "actionGroupMode" to oneOf("sequence"),
        "actionTrigger" to parent(),
        "action" to parent(isRepeated = true),
    ),
    "actionTrigger" to mapOf(
        "actionTriggerType" to oneOf("reachPoint", "betweenAdjacentPoints", "multipleTiming", "multipleDistance"),
        "actionTriggerParam" to number(0.001, 10_000.0, isRequired = false),
    ),
    "action" to mapOf(
        "actionId" to index(),
        "actionActuatorFunc" to oneOf("hover", "gimbalRotate", "takePhoto"),
        "actionActuatorFuncParam" to parent(),
    ),
    "hover" to mapOf("hoverTime" to Rule(true) { (it.toDoubleOrNull() ?: -1.0) > 0.0 }),
    "takePhoto" to mapOf(
        "payloadPositionIndex" to index(),
        "fileSuffix" to Rule(true) { it.isNotEmpty() },
        "payloadLensIndex" to Rule(false) { it in setOf("wide", "zoom", "ir", "narrow_band", "visable") },
        "useGlobalPayloadLensIndex" to Rule(false) { it in setOf("0", "1") },
    ),
    "gimbalRotate" to mapOf(
        "gimbalHeadingYawBase" to oneOf("north"),
        "gimbalRotateMode" to oneOf("absoluteAngle"),
        "gimbalPitchRotateEnable" to flag(),
        "gimbalPitchRotateAngle" to number(-120.0, 90.0),
        "gimbalRollRotateEnable" to flag(),
        "gimbalRollRotateAngle" to number(-90.0, 90.0),
        "gimbalYawRotateEnable" to flag(),
        "gimbalYawRotateAngle" to number(-180.0, 180.0),
        "gimbalRotateTimeEnable" to flag(),
        "gimbalRotateTime" to number(0.0, 100.0),
        "payloadPositionIndex" to index(),
    ),
)

/** What in a file breaks the rules; empty when nothing does. */
fun wpmlViolations(root: Element, isTemplate: Boolean): List<String> {
    val rules = wpmlRules(isTemplate)
    fun check(element: Element): List<String> {
        val nodes = (0 until element.childNodes.length).map { element.childNodes.item(it) }
        val children = nodes.filterIsInstance<Element>()
        val own = rules[ruleName(element, children)]
            ?: return if (children.isEmpty()) emptyList() else listOf(element.tagName)
        val unknown = children.filter { it.localName !in own }.map { "unknown ${it.tagName} in ${element.tagName}" }
        val missing = own.filter { (name, rule) -> rule.isRequired && children.none { it.localName == name } }
            .map { "${element.tagName} lacks ${it.key}" }
        val repeated = children.groupBy { it.localName }
            .filter { (name, found) -> found.size > 1 && own[name]?.isRepeated == false }.map { "repeated ${it.key}" }
        val wrong = children.filter { own[it.localName]?.accepts?.invoke(it.textContent.trim()) == false }
            .map { "${it.tagName} is ${it.textContent}" }
        return unknown + missing + repeated + wrong + children.flatMap(::check)
    }
    return check(root)
}

/** The parameters of an action are those of its function. */
private fun ruleName(element: Element, children: List<Element>): String =
    when {
        element.localName != "actionActuatorFuncParam" -> element.localName
        children.any { it.localName == "hoverTime" } -> "hover"
        children.any { it.localName == "fileSuffix" } -> "takePhoto"
        else -> "gimbalRotate"
    }
