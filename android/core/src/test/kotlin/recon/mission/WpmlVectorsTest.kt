package recon.mission

import com.google.gson.JsonElement
import com.google.gson.JsonObject
import com.google.gson.JsonParser
import org.w3c.dom.Element
import recon.aircraft.AIRCRAFT_MODELS
import recon.aircraft.CameraNumber
import recon.aircraft.DroneNumber
import recon.aircraft.MissionPlan
import recon.aircraft.ModelFunction
import recon.aircraft.PAYLOADS
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
        val missions = FOLDER.listFiles { file -> file.extension == "json" && file != NUMBERS }.orEmpty().sorted()
        assertTrue(missions.size >= 7)
        for (file in missions) {
            val stated = JsonParser.parseString(file.readText()).asJsonObject
            val plan = planOf(stated)
            assertNull(planProblem(plan))
            val aircraft = stated["aircraft"].takeUnless { it.isJsonNull }?.asString
            val options = WpmlOptions(
                stated["created_ms"].asLong,
                aircraft?.let { name -> AIRCRAFT_MODELS.single { it.name == (OF_DJI_FLY[name] ?: name) }.number },
                stated["go_home_height_m"].numberOrNull(),
            )
            val writer = WpmlWriter(plan, options)
            assertSame(file, "template.kml", writer.template())
            assertSame(file, "waylines.wpml", writer.waylines())
        }
    }

    @Test
    fun `DJI's numbers of each aircraft and camera are those of the station`() {
        val known = JsonParser.parseString(NUMBERS.readText()).asJsonObject
        val models = AIRCRAFT_MODELS.filter { it.number != null }
        val ofStation = known["aircraft"].asJsonObject.entrySet().associate { (name, each) ->
            (OF_DJI_FLY[name] ?: name) to each.asJsonObject
        }
        assertEquals(ofStation.keys, models.map { it.name }.toSet())
        for (model in models) {
            val expected = ofStation.getValue(model.name)
            assertEquals(expected["drone"].asJsonArray.map { it.asInt }, model.number!!.let(::numbersOf), model.name)
            assertEquals(cameraOf(expected["camera"]), model.number.camera, model.name)
            assertEquals(expected["takes_payloads"].asBoolean, model.takesPayloads, model.name)
            assertEquals(expected["photos"].asBoolean, model.has(ModelFunction.PHOTO_TIMER), model.name)
        }
        assertEquals(known["payloads"].asJsonObject.entrySet().associate { it.key to cameraOf(it.value)!! }, PAYLOADS)
    }

    private fun numbersOf(drone: DroneNumber) = listOf(drone.enumValue, drone.subEnumValue)

    private fun cameraOf(stated: JsonElement): CameraNumber? =
        if (stated.isJsonNull) null else stated.asJsonArray.let { CameraNumber(it[0].asInt, it[1].asString) }

    private fun planOf(stated: JsonObject) = MissionPlan(
        stated["waypoints"].asJsonArray.map { pointOf(it.asJsonObject) },
        isCurved = stated["curved"].asBoolean,
        landsAtEnd = stated["land_at_end"].asBoolean,
        photoEveryS = stated["photo_every_s"].numberOrNull(),
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
private val NUMBERS = FOLDER.resolve("aircraft.json")

/** The one aircraft of this app among those that DJI Fly flies. */
private val OF_DJI_FLY = mapOf("DJI Fly" to "Mini 4 Pro")
