package recon.session

import com.google.gson.JsonObject
import com.google.gson.JsonParser
import recon.aircraft.AircraftCommand
import recon.aircraft.AircraftFacts
import recon.aircraft.Answer
import recon.aircraft.MissionAction
import recon.aircraft.ReleasedPhoto
import recon.geo.LatLon
import recon.wire.Acknowledgment
import recon.wire.CameraControl
import recon.wire.MessageString
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertFalse
import kotlin.test.assertTrue

class ExtensionTest {
    private val harness = Harness(SessionSettings(startedS = 1_000))
    private val locking = hovering().copy(facts = AircraftFacts(locksCamera = true, maxHeightM = 120.0))

    @Test
    fun `facts come first after the serial, on a change at most once a second, and every 10 s`() {
        harness.connect()
        harness.pass(21 * SECOND)
        assertEquals(2, of("facts").size)
        harness.sent.clear()
        repeat(50) {
            harness.state = locking.copy(facts = AircraftFacts(storageLeftPhotos = it))
            harness.pass(100 * MS)
        }
        assertTrue(of("facts").size in 4..6, "${of("facts").size}")
        harness.closeLink()
        harness.sent.clear()
        harness.state = hovering().copy(serial = null)
        harness.pass(SECOND)
        harness.session.linkOpened(harness.nowNs)
        harness.pass(3 * SECOND)
        assertEquals(emptyList(), harness.appTexts)
        harness.state = locking
        harness.pass(10 * MS)
        assertEquals(120.0, of("facts").single()["max_height_m"].asDouble)
    }

    @Test
    fun `an aircraft that reports no more has no facts`() {
        harness.connect()
        harness.passInSilence(30 * SECOND)
        assertTrue(of("facts").size <= 1)
    }

    @Test
    fun `each photo is told once, with its place and age, at most 16 in a second`() {
        harness.connect()
        repeat(40) { take(it) }
        harness.pass(300 * MS)
        assertEquals(1, of("photos").size)
        harness.pass(3 * SECOND)
        assertEquals((1L..40).toList(), indexes())
        assertTrue(of("photos").all { it["series"].asLong == 1_000L && !it.has("serial") })
        val photo = of("photos").first()["photos"].asJsonArray.first().asJsonObject
        assertEquals(45.0, photo["latitude_deg"].asDouble)
        assertTrue(photo["age_s"].asDouble in 0.0..0.1)
        assertEquals(40, of("facts").last()["photo_count"].asLong)
    }

    @Test
    fun `photos of a lost link are told again, and those without one wait`() {
        harness.connect()
        take(0)
        harness.pass(SECOND)
        harness.closeLink()
        repeat(300) { take(1 + it) }
        harness.sent.clear()
        harness.session.linkOpened(harness.nowNs)
        harness.pass(20 * SECOND)
        // 256 wait at most: the first 45 are photos of unknown places.
        assertEquals((46L..301).toList(), indexes())
    }

    @Test
    fun `a photo of the last seconds before a link was lost is told again`() {
        harness.connect()
        take(0)
        harness.pass(12 * SECOND)
        take(1)
        harness.pass(SECOND)
        harness.closeLink()
        harness.sent.clear()
        harness.session.linkOpened(harness.nowNs)
        harness.pass(2 * SECOND)
        assertEquals(listOf(2L), indexes())
    }

    @Test
    fun `another aircraft begins a series of its own`() {
        harness.connect()
        take(0)
        take(1, serial = "OTHER")
        harness.pass(3 * SECOND)
        assertEquals(listOf(1_000L to 1L, 1_001L to 1L), of("photos").map {
            it["series"].asLong to it["photos"].asJsonArray.single().asJsonObject["index"].asLong
        })
        assertEquals("OTHER", of("photos").last()["serial"].asString)
    }

    @Test
    fun `a camera is locked by an order where the aircraft takes it, and the video stays as it was`() {
        harness.connect()
        harness.receive(CameraControl(CameraControl.LOCK, 0f))
        assertEquals("This aircraft's camera cannot be locked by the app", harness.messages.last())
        harness.state = locking
        harness.pass(10 * MS)
        harness.receive(CameraControl(CameraControl.LOCK, 0f), CameraControl(CameraControl.UNLOCK, 0f))
        assertEquals(listOf(true, false).map(AircraftCommand::LockCamera), harness.commands)
        assertEquals(listOf(0, 1, 1), harness.acknowledgments.map { it.positive })
        harness.pass(2 * SECOND)
        assertEquals(listOf("lock_camera", "unlock_camera"), of("outcome").map { it["action"].asString })
        assertTrue(of("facts").last()["orders"].asJsonArray.single().asString == "lock_camera")
    }

    @Test
    fun `a failed mission is told with its step and DJI's code, and as a sentence`() {
        harness.answers = Answer.Refused("Uploaded, but not started", "GPS_INVALID", MissionAction.START)
        harness.connect()
        harness.receive(mission(), HOVER)
        harness.pass(3 * SECOND)
        val (failed, hover) = of("outcome")
        assertEquals("mission_start" to "GPS_INVALID", failed["action"].asString to failed["code"].asString)
        assertFalse(failed["ok"].asBoolean)
        assertEquals("hover", hover["action"].asString)
        assertTrue("Mission refused by the aircraft: Uploaded, but not started" in harness.messages)
        assertEquals(Acknowledgment(0, 253), harness.acknowledgments.first())
    }

    @Test
    fun `each refused order has its outcome, told once while it waits, and what waits is bounded`() {
        harness.answers = Answer.Refused("no", "X")
        harness.connect()
        val video = CameraControl(1, 2f)
        harness.receive(RETURN, LAND, OrdersTest.STICK, video, HOVER, HOVER)
        harness.state = locking
        harness.pass(10 * MS)
        harness.receive(CameraControl(CameraControl.LOCK, 0f), CameraControl(CameraControl.UNLOCK, 0f))
        for (action in listOf(MissionAction.UPLOAD, MissionAction.LOAD)) {
            harness.answers = Answer.Refused("no", "X", action)
            harness.receive(mission())
        }
        harness.pass(20 * SECOND)
        val words = "go_home land virtual_stick video hover lock_camera unlock_camera mission_upload mission_load"
        assertEquals(words.split(" "), of("outcome").map { it["action"].asString })
        harness.sent.clear()
        repeat(100) { harness.answers = Answer.Refused("no $it").also { harness.receive(HOVER) } }
        harness.pass(110 * SECOND)
        assertTrue(of("outcome").size in 64..66, "${of("outcome").size}")
    }

    @Test
    fun `an aircraft that reports no more is told nothing of, and what waits is sent when it does`() {
        harness.connect()
        harness.passInSilence(3 * SECOND)
        harness.sent.clear()
        take(0)
        harness.passInSilence(3 * SECOND)
        assertEquals(emptyList(), indexes())
        harness.pass(2 * SECOND)
        assertEquals(listOf(1L), indexes())
        harness.closeLink()
        harness.session.photoTaken(ReleasedPhoto(0, 0), harness.nowNs)
        harness.session.linkOpened(harness.nowNs)
        harness.pass(2 * SECOND)
        // The first once more; one of an aircraft without a serial is of the series that runs.
        assertEquals(listOf(1L, 1L, 2L), indexes())
    }

    @Test
    fun `a mission that starts, or is accepted and never flown, is told`() {
        harness.connect()
        harness.receive(mission())
        harness.pass(6 * SECOND)
        val (started, not) = of("outcome")
        assertTrue(started["ok"].asBoolean)
        assertEquals(1, started["mission_id"].asInt)
        assertFalse(not["ok"].asBoolean)
        assertEquals("mission_start", not["action"].asString)
    }

    private fun take(count: Int, serial: String? = "1581F5BKD22BJ00A") = harness.session.photoTaken(
        ReleasedPhoto(harness.nowNs, 1_700_000_000_000 + count, serial, LatLon(45.0, -93.0), 20.0), harness.nowNs,
    )

    private fun indexes(): List<Long> =
        of("photos").flatMap { it["photos"].asJsonArray }.map { it.asJsonObject["index"].asLong }

    private fun of(kind: String): List<JsonObject> {
        assertTrue(harness.packets<MessageString>().none { it.type == MessageString.DEBUG && it.text.size > 4096 })
        return harness.appTexts.map { JsonParser.parseString(it.removePrefix("recon 1 ")).asJsonObject }
            .filter { it["kind"].asString == kind }
    }
}
