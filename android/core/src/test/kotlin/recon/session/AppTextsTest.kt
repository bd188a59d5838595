package recon.session

import com.google.gson.JsonObject
import com.google.gson.JsonParser
import com.google.gson.Strictness
import com.google.gson.stream.JsonReader
import net.jqwik.api.ForAll
import net.jqwik.api.Property
import recon.aircraft.AircraftFacts
import recon.aircraft.Attitude
import recon.aircraft.CameraMode
import recon.aircraft.Capabilities
import recon.aircraft.Capability
import recon.aircraft.Failsafe
import recon.aircraft.ReleasedPhoto
import recon.aircraft.RtkState
import recon.geo.LatLon
import java.io.File
import java.io.StringReader
import kotlin.random.Random
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertTrue

/** The texts of `recon 1`, against the vectors and the tables of the interface document. */
class AppTextsTest {

    @Test
    fun `all facts are written as the document's vector has them`() {
        val facts = AircraftFacts(
            home = LatLon(41.9876543, -93.654321), maxHeightM = 120.0, maxDistanceM = 2_000.0, model = "Mavic 3M",
            firmware = "01.01.0300", batteryCellsV = listOf(3.912, 3.905, 3.911, 3.908), batteryTemperatureC = 31.5,
            rtk = RtkState.FIXED, storageLeftMb = 58_211, storageLeftPhotos = 7_104,
            gimbal = Attitude(181.5, -90.0, 0.1), cameraMode = CameraMode.INTERVAL, photoIntervalS = 2.0,
            isExposureLocked = true, isWhiteBalanceLocked = true, reportsPhotos = true, locksCamera = true,
            djiCheck = "registered with DJI", isDjiCheckPassed = true,
        )
        val can = Capabilities(Capability.SUPPORTED, goHomeHeightM = 60.0, failsafe = Failsafe.GO_HOME)
        val state = hovering().copy(facts = facts, capabilities = can)
        val written = objectOf(factsText(state, "Recon 1.0", PhotoSeries(1_700_000_000, 41, null)))
        val expected = VALID["facts_all"].asJsonObject["means"].asJsonObject.deepCopy()
        // A mission's packet has 99 waypoints at most, whatever the aircraft takes.
        expected.addProperty("max_waypoints", 99)
        assertEquals(expected.keySet(), written.keySet())
        for (key in expected.keySet()) {
            val (a, b) = expected[key] to written[key]
            val isNumber = a.isJsonPrimitive && a.asJsonPrimitive.isNumber
            if (isNumber) assertEquals(a.asDouble, b.asDouble, 1e-9, key) else assertEquals(a, b, key)
        }
    }

    @Property(tries = 200)
    fun `whatever the aircraft reports, a text keeps the document's bounds`(@ForAll seed: Int) {
        val random = Random(seed)
        val can = Capabilities(goHomeHeightM = odd(random))
        val state = hovering().copy(facts = drawnFacts(random), capabilities = can)
        val facts = factsText(state, drawnName(random), PhotoSeries(random.nextLong(), random.nextLong(-5, 5), null))
        val photos = List(random.nextInt(1, 17)) { NumberedPhoto(7, it + 1L, drawnPhoto(random)) }
        val outcome = Outcome("hover", random.nextBoolean(), drawnName(random), drawnName(random), random.nextInt())
        val photosText = photosText(photos, drawnName(random), nowNs = 10 * SECOND)
        for (text in listOf(facts, outcomeText(outcome))) assertKept(text)
        for (photo in assertKept(photosText)["photos"].asJsonArray) assertBounded("A photo", photo.asJsonObject)
        assertTrue(photosText.encodeToByteArray().size <= 2 * LONGEST_APP_TEXT_BYTES)
        assertTrue(facts.encodeToByteArray().size <= LONGEST_APP_TEXT_BYTES, "${facts.length}")
    }

    private fun assertKept(text: String): JsonObject {
        assertEquals(text, String(text.encodeToByteArray(), Charsets.UTF_8))
        val read = objectOf(text)
        assertBounded(TABLES.getValue(read["kind"].asString), read)
        return read
    }

    private fun assertBounded(table: String, read: JsonObject) {
        val rules = rulesOf(table)
        for ((key, value) in read.entrySet()) {
            val rule = rules[key] ?: continue
            val bounds = Regex("""(-?\\d+) to (-?\\d+)""").find(rule)?.destructured
            val isNumber = rule.startsWith("number") || rule.startsWith("whole")
            if (isNumber && bounds != null) {
                val (least, most) = bounds.toList().map { it.toDouble() }
                assertTrue(value.asDouble in least..most, "$key: $value, $rule")
                if (rule.startsWith("whole")) assertTrue('.' !in value.asString, "$key: $value")
            }
            if (rule.startsWith("text")) {
                assertTrue(value.asString.length <= rule.filter(Char::isDigit).toInt(), "$key: $value")
            }
        }
        assertTrue(read.keySet().all { it in rules || it == "kind" }, "$table: ${read.keySet()}")
    }

    /** The rows of a table of the document, by their keys: what stands in their second column. */
    private fun rulesOf(table: String): Map<String, String> =
        DOCUMENT.substringAfter("### $table\n").substringBefore("\n##").lines().filter { it.startsWith("| `") }
            .associate { row -> row.split("|").map { it.trim() }.let { it[1].trim('`') to it[2] } }

    companion object {
        private val VECTORS = File("../../vectors/app_texts/valid.json")
        private val VALID: JsonObject = JsonParser.parseString(VECTORS.readText()).asJsonObject
        private val DOCUMENT = File("../../docs/icd.md").readText()
        private val TABLES = mapOf("facts" to "Facts", "photos" to "Photos", "outcome" to "Outcomes")

        fun drawnFacts(random: Random) = AircraftFacts(
            home = LatLon(odd(random), odd(random)), maxHeightM = odd(random), maxDistanceM = odd(random),
            model = drawnName(random), firmware = drawnName(random),
            batteryCellsV = List(random.nextInt(60)) { if (random.nextInt(30) == 0) odd(random) else 3.9 },
            batteryTemperatureC = odd(random), rtk = RtkState.entries.random(random), storageLeftMb = random.nextInt(),
            storageLeftPhotos = random.nextInt(-3, 100), gimbal = Attitude(odd(random), odd(random), odd(random)),
            photoIntervalS = odd(random), djiCheck = drawnName(random),
        )

        fun drawnPhoto(random: Random) = ReleasedPhoto(
            random.nextLong(20 * SECOND), random.nextLong(), null, LatLon(odd(random), odd(random)), odd(random),
            odd(random), odd(random), drawnName(random),
        )

        private fun odd(random: Random): Double = when (random.nextInt(6)) {
            0 -> Double.NaN
            1 -> Double.NEGATIVE_INFINITY
            2 -> random.nextDouble(-1e300, 1e300)
            3 -> -0.0
            else -> random.nextDouble(-200.0, 200.0)
        }

        fun drawnName(random: Random) = String(CharArray(random.nextInt(300)) { random.nextInt(0x10000).toChar() })

        fun objectOf(text: String): JsonObject {
            assertTrue(text.startsWith("recon 1 {"), text.take(20))
            val reader = JsonReader(StringReader(text.removePrefix("recon 1 "))).apply { strictness = Strictness.STRICT }
            return JsonParser.parseReader(reader).asJsonObject
        }
    }
}
