package recon.msdk5

import recon.aircraft.AircraftCommand
import recon.aircraft.Answer
import recon.aircraft.ReleasedPhoto
import recon.session.CompanionSession
import recon.session.Output
import recon.session.SessionSettings
import recon.wire.Acknowledgment
import recon.wire.CameraControl
import recon.wire.Deframer
import recon.wire.EmergencyCommand
import recon.wire.ExecuteWaypointMission
import recon.wire.MessageString
import recon.wire.Packet
import recon.wire.VirtualStickCommand
import recon.wire.Waypoint
import recon.wire.encode
import java.util.concurrent.ConcurrentLinkedQueue
import kotlin.math.abs
import kotlin.random.Random
import kotlin.reflect.KClass
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertTrue

/**
 * Random schedules of orders, photos, other aircraft and DJI's troubles: no order is lost, and no fact is
 * wrong. More of them: -Dfuzz.schedules=20000.
 */
class SchedulesTest {
    @Test
    fun `whatever DJI's SDK does, no order is lost and no fact is wrong`() {
        val schedules = System.getProperty("fuzz.schedules")?.toInt() ?: 200
        var photos = 0
        var texts = 0
        for (seed in 0 until schedules) {
            val world = World(Random(seed), seed)
            world.disturb(15_000)
            world.settle()
            world.judge()
            photos += world.photosTold
            texts += world.factsTold
        }
        println("$schedules schedules: $texts texts of facts, $photos photos, all as the aircraft had them")
        assertTrue(photos > schedules && texts > 10 * schedules)
    }
}

private const val MS = 1_000_000L
private const val STEP_MS = 50L

/** A session with the adapter, the fake SDK and a station, by one clock. */
private class World(private val random: Random, private val seed: Int) {
    private val aircraft = FakeAircraft(random)
    private val sdk = FakeMsdk(random, aircraft)
    private val adapter = Msdk5Aircraft(sdk, { sdk.nowNs }, { sdk.nowNs / MS })
    private val session = CompanionSession(SessionSettings(startedS = 1))
    private val station = Deframer()
    private val answers = ConcurrentLinkedQueue<() -> Unit>()
    private val shots = mutableListOf<Pair<Long, Double>>()
    private val told = mutableListOf<Pair<Long, Double>>()

    /** Storage left at each step: the counter falls as time passes. */
    private val storage = mutableListOf(0L to aircraft.storageLeft)
    private val answered = mutableSetOf<Long>()
    private var newest: Pair<Long, AircraftCommand>? = null
    private var files = 0
    private var ordered = 0
    private var acknowledged = 0
    private var lastMission: Boolean? = null
    var factsTold = 0
        private set
    val photosTold: Int get() = told.size

    init {
        sdk.onMove = ::judgeMove
        adapter.onPhoto { photo: ReleasedPhoto -> answers += { session.photoTaken(photo, sdk.nowNs) } }
        session.aircraftState(adapter.state(), 0)
        session.linkOpened(0)
        serve()
    }

    fun disturb(ms: Long) {
        var nextShotMs = random.nextLong(500, 3_000)
        for (step in 1..ms / STEP_MS) {
            if (random.nextInt(12) == 0) order(drawnOrder())
            if (random.nextInt(200) == 0) sdk.isConnected = !sdk.isConnected
            if (random.nextInt(250) == 0) otherAircraft()
            if (random.nextInt(100) == 0) aircraft.isFlyingMission = false
            if (step * STEP_MS >= nextShotMs) nextShotMs += 2_100 + random.nextLong(2_000).also { shoot() }
            pass(STEP_MS)
        }
    }

    /** DJI works as it should; every late callback comes, and a hover ends all that moves. */
    fun settle() {
        sdk.isTroubled = false
        sdk.isConnected = true
        pass(36_000, stepMs = 200)
        order(EmergencyCommand(EmergencyCommand.HOVER))
        pass(2_500)
        assertTrue(!aircraft.isMoving, "schedule $seed: after a hover it flies ${aircraft.mode}, ${aircraft.mission}")
        aircraft.sticks.clear()
        order(STICK)
        pass(1_500)
        assertTrue(aircraft.hasSticks && aircraft.sticks.any { it.second.rollMps > 0 }, "schedule $seed: no sticks")
        order(EmergencyCommand(EmergencyCommand.HOVER))
        pass(2_500)
        order(MISSION)
        pass(4_000)
        val isRefused = lastMission == false && aircraft.product == "DJI_MINI_4_PRO"
        assertTrue(aircraft.isFlyingMission || isRefused, "schedule $seed: a mission did not start")
        assertEquals(lastMission, aircraft.isFlyingMission, "schedule $seed: a mission's answer")
    }

    fun judge() {
        assertEquals(ordered, acknowledged, "schedule $seed: acknowledgments")
        assertEquals(shots.size, told.size, "schedule $seed: photos")
        for ((shot, report) in shots.zip(told)) {
            assertTrue(abs(shot.first - report.first) <= 2 * MS, "schedule $seed: a photo's time")
            assertEquals(shot.second, report.second, 1e-6, "schedule $seed: a photo's place")
        }
    }

    private fun drawnOrder(): Packet = when (random.nextInt(8)) {
        0 -> MISSION
        1, 2, 3 -> STICK
        4 -> EmergencyCommand(EmergencyCommand.LAND)
        5 -> EmergencyCommand(EmergencyCommand.RETURN_HOME)
        6 -> CameraControl(if (random.nextBoolean()) CameraControl.LOCK else CameraControl.UNLOCK, 0f)
        else -> EmergencyCommand(EmergencyCommand.HOVER)
    }

    private fun order(packet: Packet) {
        ordered++
        session.received(encode(packet), sdk.nowNs)
        serve()
    }

    private fun otherAircraft() {
        val (serial, product, camera) = MODELS.random(random)
        aircraft.serial = serial
        aircraft.product = product
        aircraft.camera = camera
    }

    /** One release: shutter, then its files, of which DJI may tell the second one too. */
    private fun shoot() {
        val isStored = random.nextInt(6) > 0
        val number = ++files
        sdk.tellCamera(CameraEvent.Shutter)
        if (!isStored) return
        shots += sdk.nowNs to aircraft.latitudeDeg
        val delayNs = random.nextLong(100 * MS, 1_500 * MS)
        sdk.at(delayNs) { sdk.tellCamera(CameraEvent.StoredFile("JPEG", 100, number)) }
        if (random.nextBoolean()) {
            sdk.at(delayNs + random.nextLong(900 * MS)) { sdk.tellCamera(CameraEvent.StoredFile("DNG", 100, number)) }
        }
    }

    private fun pass(ms: Long, stepMs: Long = STEP_MS) {
        repeat((ms / stepMs).toInt()) {
            aircraft.latitudeDeg += 1e-6
            if (random.nextInt(10) == 0) aircraft.storageLeft--
            storage += sdk.nowNs to aircraft.storageLeft
            sdk.advance(sdk.nowNs + stepMs * MS)
            session.aircraftState(adapter.state(), sdk.nowNs)
            serve()
        }
    }

    private fun serve() {
        while (true) {
            generateSequence { answers.poll() }.forEach { it() }
            val outputs = session.takeOutputs()
            outputs.filterIsInstance<Output.Execute>().forEach(::execute)
            val packet = session.nextToSend(sdk.nowNs)
            if (packet != null) received(packet)
            if (outputs.isEmpty() && packet == null && answers.isEmpty()) return
        }
    }

    private fun execute(call: Output.Execute) {
        val before = newest
        if (call.command.isMotion) newest = sdk.nowNs to call.command
        var isAtOnce = true
        adapter.execute(call.command) { answer ->
            // What is refused at once, such as a file with faults, leaves the order before as it is.
            if (isAtOnce && answer is Answer.Refused) newest = before
            answers += {
                assertTrue(answered.add(call.callId), "schedule $seed: ${call.command} is answered twice")
                session.answered(call.callId, answer, sdk.nowNs)
            }
        }
        isAtOnce = false
    }

    /** What moves the aircraft is the newest order, before its operator has read that it failed. */
    private fun judgeMove(kind: KClass<out AircraftCommand>) {
        val (issuedNs, command) = newest!!
        assertTrue(kind.isInstance(command), "schedule $seed: ${kind.simpleName} after $command")
        assertTrue(sdk.nowNs - issuedNs <= 20_000 * MS, "schedule $seed: $command is begun late")
    }

    private fun received(bytes: ByteArray) {
        session.packetSent(sdk.nowNs)
        station.push(bytes, sdk.nowNs)
        while (true) {
            when (val packet = station.poll()?.packet ?: break) {
                is Acknowledgment -> acknowledgedBy(packet)
                is MessageString -> if (packet.type == MessageString.DEBUG) read(String(packet.text.toByteArray()))
                else -> Unit
            }
        }
    }

    private fun acknowledgedBy(packet: Acknowledgment) {
        acknowledged++
        if (packet.sourcePid == ExecuteWaypointMission.PID) lastMission = packet.positive == 1
    }

    private fun read(text: String) {
        if ("\"kind\":\"facts\"" in text) judgeFacts(text)
        if ("\"kind\":\"photos\"" !in text) return
        for (photo in Regex("""\{"index".*?}""").findAll(text).map { it.value }) {
            val takenNs = sdk.nowNs - (numberOf(photo, "age_s")!! * 1e9).toLong()
            told += takenNs to numberOf(photo, "latitude_deg")!!
        }
    }

    /** A fact is what the aircraft had within the last second and a bit, and that of the aircraft connected. */
    private fun judgeFacts(text: String) {
        factsTold++
        val left = numberOf(text, "storage_left_photos")!!.toInt()
        val recent = storage.filter { sdk.nowNs - it.first <= 1_100 * MS }.map { it.second } + aircraft.storageLeft
        assertTrue(left in recent, "schedule $seed: storage $left, $recent")
        assertEquals(if (aircraft.serial == "A-1") 120.0 else 60.0, numberOf(text, "max_height_m"), "schedule $seed")
        val model = MODELS.first { it.first == aircraft.serial }.let { names.getValue(it.first) }
        assertTrue("\"model\":\"$model\"" in text, "schedule $seed: $text")
    }

    private fun numberOf(text: String, key: String): Double? =
        Regex("\"$key\":(-?[0-9.]+)").find(text)?.groupValues?.get(1)?.toDouble()

    private companion object {
        val MODELS = listOf(
            Triple("A-1", "DJI_MAVIC_3_ENTERPRISE_SERIES", "M3E"),
            Triple("B-2", "DJI_MINI_4_PRO", "DJI_MINI_4_PRO"),
            Triple("C-3", "DJI_MATRICE_4_SERIES", "M4T"),
        )
        val names = mapOf("A-1" to "Mavic 3E", "B-2" to "Mini 4 Pro", "C-3" to "Matrice 4T")
        val STICK = VirtualStickCommand(0, 0f, 2f, 0f, 20f, 1f)
        val MISSION = ExecuteWaypointMission(
            0, 0, List(2) { Waypoint(45.0 + it * 0.001, -93.0, 30.0, 0.2f, 5f, Float.NaN, Float.NaN) },
        )
    }
}
