package recon.mission

import net.jqwik.api.ForAll
import net.jqwik.api.Property
import recon.aircraft.CameraNumber
import recon.aircraft.DroneNumber
import recon.aircraft.MissionPlan
import recon.aircraft.PlanPoint
import recon.geo.LatLon
import recon.geo.LocalPlane
import java.io.ByteArrayInputStream
import java.io.ByteArrayOutputStream
import java.util.zip.ZipEntry
import java.util.zip.ZipInputStream
import java.util.zip.ZipOutputStream
import kotlin.math.abs
import kotlin.random.Random
import kotlin.test.Test
import kotlin.test.assertContentEquals
import kotlin.test.assertEquals
import kotlin.test.assertFailsWith
import kotlin.test.assertNull
import kotlin.test.assertTrue

private val OPTIONS = WpmlOptions(createdMs = 1_700_000_000_000, DroneNumber(77, 0, CameraNumber(66, "wide")), 45.0)

class KmzTest {

    @Property(tries = 100)
    fun `what is written is read back, to the millimetre`(@ForAll seed: Int) {
        val plan = drawnPlan(Random(seed))
        assertNull(planProblem(plan))
        val back = planOfKmz(kmzOf(plan, OPTIONS))
        assertEquals(plan.landsAtEnd, back.landsAtEnd)
        assertEquals(plan.isCurved && plan.points.size > 2, back.isCurved)
        assertEquals(plan.points.size, back.points.size)
        assertClose(plan.photoEveryS ?: -1.0, back.photoEveryS ?: -1.0, 1e-3)
        plan.points.zip(back.points).forEachIndexed { index, (a, b) ->
            assertClose(a.position.latitudeDeg, b.position.latitudeDeg, 1e-8)
            assertClose(a.position.longitudeDeg, b.position.longitudeDeg, 1e-8)
            assertClose(a.heightAboveTakeoffM, b.heightAboveTakeoffM, 1e-3)
            assertClose(a.speedMps, b.speedMps, 1e-3)
            assertClose(a.loiterS ?: -1.0, b.loiterS ?: -1.0, 1e-3)
            assertClose(a.gimbalPitchDeg ?: 1.0, b.gimbalPitchDeg ?: 1.0, 1e-3)
            if (plan.isCurved && index in 1 until plan.points.lastIndex) {
                assertClose(a.cornerRadiusM, b.cornerRadiusM, 1e-3)
            }
        }
    }

    @Property(tries = 100)
    fun `both files keep the rules of DJI's reference`(@ForAll seed: Int) {
        val random = Random(seed)
        val options = if (random.nextBoolean()) OPTIONS else WpmlOptions(0)
        val writer = WpmlWriter(drawnPlan(random), options)
        for ((file, isTemplate) in listOf(writer.template() to true, writer.waylines() to false)) {
            val root = parsedKml(file)
            assertEquals(emptyList(), wpmlViolations(root, isTemplate))
            val groups = root.getElementsByTagNameNS(WPML, "actionGroupId")
            assertEquals(List(groups.length) { "$it" }, List(groups.length) { groups.item(it).textContent })
        }
    }

    @Test
    fun `the archive holds the two files under DJI's names, and the same plan gives the same bytes`() {
        val plan = drawnPlan(Random(1))
        val kmz = kmzOf(plan, OPTIONS)
        val zip = ZipInputStream(ByteArrayInputStream(kmz))
        val names = generateSequence { zip.nextEntry }.map { it.name }.toList()
        assertEquals(listOf("wpmz/template.kml", "wpmz/waylines.wpml"), names)
        assertContentEquals(kmz, kmzOf(plan, OPTIONS))
    }

    @Test
    fun `a wayline has its coordinates as longitude, latitude and its heights above takeoff`() {
        val plan = MissionPlan(
            listOf(PlanPoint(LatLon(45.5, -93.25), 30.0, 5.0, 0.2), PlanPoint(LatLon(45.501, -93.25), 40.0, 5.0, 0.2)),
            isCurved = false,
            landsAtEnd = true,
        )
        val text = WpmlWriter(plan, OPTIONS).waylines().decodeToString()
        assertTrue("<coordinates>-93.25000000,45.50000000</coordinates>" in text)
        assertTrue("<wpml:executeHeight>40.000</wpml:executeHeight>" in text)
        assertTrue("<wpml:executeHeightMode>relativeToStartPoint</wpml:executeHeightMode>" in text)
        assertTrue("<wpml:finishAction>autoLand</wpml:finishAction>" in text)
        assertTrue("<wpml:droneEnumValue>77</wpml:droneEnumValue>" in text)
    }

    @Test
    fun `files from outside are refused with what was expected`() {
        assertRefused("Mission file must be a zip archive with wpmz/waylines.wpml", ByteArray(10))
        assertRefused("Mission file must be a zip archive with wpmz/waylines.wpml", zipped("other" to "x"))
        assertRefused("Mission file must be XML", zipped(WAYLINES to "not XML"))
        val withEntity = "<!DOCTYPE a [<!ENTITY b \"c\">]><a>&b;</a>"
        assertRefused("Mission file must have no DOCTYPE", zipped(WAYLINES to withEntity))
        assertRefused("kml must have one Document; got 0", zipped(WAYLINES to "<kml/>"))
        assertRefused("wpmz/waylines.wpml must have at most", zipped(WAYLINES to " ".repeat(5_000_000)))
        val entries = (0..100).map { "file $it" to "" }.toTypedArray()
        assertRefused("Mission file must have at most 100 entries", zipped(*entries))
    }

    @Test
    fun `a changed wayline is refused or read as what it states`() {
        val text = WpmlWriter(drawnPlan(Random(2)), OPTIONS).waylines().decodeToString()
        assertRefused("executeHeightMode must be", zipped(WAYLINES to text.replace("relativeToStartPoint", "WGS84")))
        assertRefused("A number was expected; got 'NaN'", zipped(WAYLINES to replaceFirstHeight(text, "NaN")))
        val three = text.replaceFirst(Regex("<coordinates>.*</coordinates>"), "<coordinates>1,2,3</coordinates>")
        assertRefused("coordinates must be longitude,latitude; got 1,2,3", zipped(WAYLINES to three))
    }

    @Property(tries = 200)
    fun `damaged archives raise nothing but a KMZ error`(@ForAll seed: Int) {
        val random = Random(seed)
        val kmz = kmzOf(drawnPlan(random), OPTIONS)
        repeat(3) { kmz[random.nextInt(kmz.size)] = random.nextInt().toByte() }
        try {
            assertTrue(planOfKmz(kmz).points.size < 200)
        } catch (error: KmzError) {
            assertTrue(' ' in error.message)
        }
    }

    private fun replaceFirstHeight(text: String, value: String) =
        text.replaceFirst(Regex("(<wpml:executeHeight>).*?<"), "$1$value<")

    private fun assertRefused(expected: String, kmz: ByteArray) {
        val message = assertFailsWith<KmzError> { planOfKmz(kmz) }.message
        assertTrue(message.startsWith(expected), message)
    }

    private fun assertClose(a: Double, b: Double, tolerance: Double) = assertTrue(abs(a - b) <= tolerance, "$a, $b")

    private fun zipped(vararg files: Pair<String, String>): ByteArray {
        val out = ByteArrayOutputStream()
        ZipOutputStream(out).use { zip ->
            for ((name, text) in files) {
                zip.putNextEntry(ZipEntry(name))
                zip.write(text.encodeToByteArray())
            }
        }
        return out.toByteArray()
    }
}

private const val WAYLINES = "wpmz/waylines.wpml"

/** A plan that DJI's missions accept: an outward spiral, so that no two points are close. */
fun drawnPlan(random: Random): MissionPlan {
    val isCurved = random.nextBoolean()
    val plane = LocalPlane(LatLon(random.nextDouble(-60.0, 60.0), random.nextDouble(-170.0, 170.0)))
    val points = List(random.nextInt(2, 30)) { index ->
        val radiusM = 30.0 + 15.0 * index
        val angle = index * 1.1
        PlanPoint(
            plane.position(radiusM * kotlin.math.cos(angle), radiusM * kotlin.math.sin(angle)),
            random.nextDouble(10.0, 100.0),
            random.nextDouble(1.0, 15.0),
            random.nextDouble(0.2, 10.0),
            loiterS = random.nextDouble(0.1, 30.0).takeIf { !isCurved && random.nextBoolean() },
            gimbalPitchDeg = random.nextDouble(-90.0, 0.0).takeIf { !isCurved && random.nextBoolean() },
        )
    }
    val photoEveryS = random.nextDouble(0.7, 10.0).takeIf { random.nextBoolean() }
    return MissionPlan(points, isCurved, landsAtEnd = random.nextBoolean(), photoEveryS)
}
