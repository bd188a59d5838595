package recon.mission

import com.google.gson.JsonElement
import com.google.gson.JsonObject
import com.google.gson.JsonParser
import org.w3c.dom.Element
import recon.aircraft.MissionPlan
import recon.aircraft.PlanPoint
import recon.geo.LatLon
import java.io.File
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertNull
import kotlin.test.assertTrue

/** The missions of `vectors/wpml/`: the station writes the same documents, element by element. */
class WpmlVectorsTest {

    @Test
    fun `both documents of every mission are those of the station`() {
        val missions = FOLDER.listFiles { file -> file.extension == "json" }.orEmpty().sorted()
        assertTrue(missions.size >= 5)
        for (file in missions) {
            val stated = JsonParser.parseString(file.readText()).asJsonObject
            val plan = planOf(stated)
            assertNull(planProblem(plan))
            val drone = stated["drone"].takeUnless { it.isJsonNull }?.asJsonArray
            val options = WpmlOptions(
                stated["created_ms"].asLong,
                drone?.let { DroneModel(it[0].asInt, it[1].asInt) },
            )
            val writer = WpmlWriter(plan, options)
            assertSame(file, "template.kml", writer.template())
            assertSame(file, "waylines.wpml", writer.waylines())
        }
    }

    private fun planOf(stated: JsonObject) = MissionPlan(
        stated["waypoints"].asJsonArray.map { pointOf(it.asJsonObject) },
        isCurved = stated["curved"].asBoolean,
        landsAtEnd = stated["land_at_end"].asBoolean,
    )

    private fun pointOf(waypoint: JsonObject) = PlanPoint(
        LatLon(waypoint["latitude_deg"].asDouble, waypoint["longitude_deg"].asDouble),
        waypoint["height_above_takeoff_m"].asDouble,
        waypoint["speed_mps"].asDouble,
        waypoint["corner_radius_m"].asDouble,
        loiterS = waypoint["loiter_s"].numberOrNull(),
        gimbalPitchDeg = waypoint["gimbal_pitch_deg"].numberOrNull(),
    )

    private fun JsonElement.numberOrNull() = if (isJsonNull) null else asDouble

    private fun assertSame(mission: File, document: String, written: ByteArray) {
        val expected = mission.resolveSibling("${mission.nameWithoutExtension}.$document").readBytes()
        assertEquals(elements(parsedKml(expected)), elements(parsedKml(written)), "${mission.name}, $document")
    }

    /** Each element's namespace, name and text, by its depth. */
    private fun elements(element: Element, depth: Int = 0): List<String> {
        val children = (0 until element.childNodes.length).map { element.childNodes.item(it) }.filterIsInstance<Element>()
        val text = if (children.isEmpty()) element.textContent.trim() else ""
        val own = "$depth ${element.namespaceURI} ${element.localName} $text"
        return listOf(own) + children.flatMap { elements(it, depth + 1) }
    }
}

private val FOLDER = File("../../vectors/wpml")
