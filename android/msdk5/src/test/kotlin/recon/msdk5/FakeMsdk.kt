package recon.msdk5

import recon.aircraft.AircraftCommand
import java.util.PriorityQueue
import java.util.concurrent.Executors
import java.util.concurrent.Future
import kotlin.random.Random
import kotlin.reflect.KClass

/**
 * DJI's SDK and an aircraft behind it, by a clock of its own, as documents and public threads describe them:
 * calls are refused by the aircraft's state, with DJI's codes; callbacks come at once, late, twice, never, and
 * from another thread; the aircraft disconnects in between; upload succeeds and the start fails.
 */
class FakeMsdk(private val random: Random, private val aircraft: FakeAircraft) : DjiSdk {
    private class Event(val dueNs: Long, val order: Long, val run: () -> Unit)

    private val events = PriorityQueue<Event>(compareBy({ it.dueNs }, { it.order }))
    private var count = 0L
    private var camera: ((CameraEvent) -> Unit)? = null
    var nowNs = 0L
        private set

    /** Whether calls have random fates; else each is answered soon by what the aircraft makes of it. */
    var isTroubled = true
    var isConnected = true

    /** Told of each call that moves the aircraft, before it has an effect: the class of its command. */
    var onMove: (KClass<out AircraftCommand>) -> Unit = {}

    /** Lets time pass, with DJI's callbacks on a thread of DJI's. */
    fun advance(toNs: Long) {
        while (true) {
            val next = events.peek()?.takeIf { it.dueNs <= toNs } ?: break
            events.remove()
            nowNs = maxOf(nowNs, next.dueNs)
            onAnotherThread(next.run)
        }
        nowNs = toNs
    }

    fun at(delayNs: Long, run: () -> Unit) {
        events += Event(nowNs + delayNs, count++, run)
    }

    fun tellCamera(event: CameraEvent) {
        camera?.invoke(event)
    }

    override fun snapshot(): DjiSnapshot? = aircraft.snapshot(nowNs, isConnected)

    override fun readings(): DjiReadings = aircraft.readings()

    override fun perform(action: FlightAction, done: Done) {
        MOVES[action]?.let(onMove)
        call(done) { aircraft.perform(action) }
    }

    override fun enableVirtualStick(done: Done) = call(done) { aircraft.enableSticks() }

    override fun disableVirtualStick(done: Done) = call(done) { null.also { aircraft.hasSticks = false } }

    override fun sendStick(stick: DjiStick) {
        if (isConnected) aircraft.sticks += nowNs to stick
    }

    override fun checkMission(name: String, kmz: ByteArray): FileCheck =
        if (isTroubled && random.nextInt(10) == 0) FileCheck.Faulty(listOf(-10)) else FileCheck.Passed

    override fun pushMission(name: String, kmz: ByteArray, done: Done) = call(done) { aircraft.upload(name, kmz) }

    override fun startMission(name: String, done: Done) {
        onMove(AircraftCommand.FlyMission::class)
        call(done) { aircraft.start(name) }
    }

    override fun stopMission(name: String, done: Done) = call(done) { aircraft.stop(name) }

    override fun pauseMission(done: Done) = call(done) { aircraft.stop(aircraft.mission) }

    override fun lockExposure(isLocked: Boolean, done: Done) =
        call(done) { null.also { aircraft.isExposureLocked = isLocked } }

    override fun setWhiteBalance(wanted: WhiteBalance, done: Done) =
        call(done) { null.also { aircraft.balance = wanted } }

    override fun onCamera(listener: ((CameraEvent) -> Unit)?) {
        camera = listener
    }

    override fun onFrame(listener: ((ByteArray, Int, Int) -> Unit)?) = Unit

    private fun call(done: Done, effect: () -> DjiError?) {
        val soonNs = random.nextLong(5 * MS, 300 * MS)
        when (if (isTroubled) random.nextInt(20) else LATER) {
            0 -> at(soonNs) { effect() }
            1 -> Unit
            2 -> at(soonNs) { done(DjiError(CODES.random(random), "as in a public thread")) }
            3 -> at(soonNs) { effect().let { error -> repeat(2) { done(error) } } }
            4 -> done(reached(effect))
            5 -> at(random.nextLong(2_000 * MS, 30_000 * MS)) { done(reached(effect)) }
            6 -> at(soonNs) { reached(effect).let { error -> at(random.nextLong(5_000 * MS)) { done(error) } } }
            else -> at(soonNs) { done(reached(effect)) }
        }
    }

    private fun reached(effect: () -> DjiError?): DjiError? =
        if (isConnected) effect() else DjiError("DISCONNECTED", "no aircraft")

    private fun onAnotherThread(run: () -> Unit) {
        val ended: Future<*> = DJI.submit(run)
        ended.get()
    }

    private companion object {
        const val MS = 1_000_000L
        const val LATER = 19
        val DJI = Executors.newSingleThreadExecutor { Thread(it, "dji").apply { isDaemon = true } }!!
        val MOVES = mapOf(
            FlightAction.START_GO_HOME to AircraftCommand.GoHome::class,
            FlightAction.START_AUTO_LANDING to AircraftCommand.Land::class,
        )
        val CODES = listOf(
            "WPMZ_FILE_LOAD_ERROR", "SEND_PACK_TIMEOUT", "REQUEST_HANDLER_NOT_FOUND", "SYSTEM_BUSY", "GPS_INVALID",
            "CANNOT_STOP_WAYLINE_WHEN_WAYLINE_NOT_RUNNING", "KEY_MISS_EXECUTION_FUNCTION", "TRAJ_INIT_FAIL",
        )
    }
}

/** The aircraft: what it does, and what it is. */
class FakeAircraft(private val random: Random) {
    var serial = "A-1"
    var product = "DJI_MAVIC_3_ENTERPRISE_SERIES"
    var camera = "M3E"
    var mode = "GPS_ATTI"
    var hasSticks = false
    var isFlyingMission = false
    var mission = ""
    var storageLeft = 1_000
    var latitudeDeg = 45.0
    var isExposureLocked = false
    var balance = WhiteBalance("AUTO", 56)
    val sticks = mutableListOf<Pair<Long, DjiStick>>()
    val files = mutableMapOf<String, ByteArray>()
    private var updatedNs = 0L

    /** Whether it moves by anything but its pilot. */
    val isMoving: Boolean get() = isFlyingMission || hasSticks || mode != "GPS_ATTI"

    fun snapshot(nowNs: Long, isConnected: Boolean): DjiSnapshot {
        if (isConnected) updatedNs = nowNs
        return FLYING.copy(
            updatedNs = updatedNs, serial = serial, product = product, camera = camera, flightMode = shownMode(),
            latitudeDeg = latitudeDeg, isVirtualStickEnabled = hasSticks, missionName = mission.ifEmpty { null },
            missionState = if (isFlyingMission) "EXECUTING" else "READY", gimbalPitchDeg = -90.0,
        )
    }

    fun readings() = DjiReadings(
        heightLimitM = if (serial == "A-1") 120 else 60, storageLeftPhotos = storageLeft, tellsFiles = true,
        takesExposureLock = true, whiteBalance = balance, isExposureLocked = isExposureLocked,
    )

    fun perform(action: FlightAction): DjiError? {
        when (action) {
            FlightAction.START_GO_HOME -> movedBy("GO_HOME")
            FlightAction.START_AUTO_LANDING -> movedBy("AUTO_LANDING")
            FlightAction.STOP_GO_HOME, FlightAction.STOP_AUTO_LANDING -> {
                if (mode == "GPS_ATTI") return DjiError("EXECUTION_FAILED", "nothing to stop")
                mode = "GPS_ATTI"
            }
            else -> Unit
        }
        return null
    }

    fun enableSticks(): DjiError? {
        if (isFlyingMission || mode != "GPS_ATTI") return DjiError("CANNOT_START_TASK", "the aircraft is busy")
        hasSticks = true
        return null
    }

    fun upload(name: String, kmz: ByteArray): DjiError? {
        if (isFlyingMission) return DjiError("CANT_EXCUTE_IN_CURRENT_STATUS", "a mission runs")
        files[name] = kmz
        return null
    }

    fun start(name: String): DjiError? {
        if (name !in files) return DjiError("MISSION_ID_NOT_EXIST", "no such file")
        val isLoaded = product != "DJI_MINI_4_PRO" || random.nextInt(3) > 0
        if (!isLoaded) return DjiError("WPMZ_FILE_LOAD_ERROR", "check the file")
        if (hasSticks || mode != "GPS_ATTI") return DjiError("CANT_EXCUTE_IN_CURRENT_STATUS", "busy")
        isFlyingMission = true
        mission = name
        return null
    }

    fun stop(name: String): DjiError? {
        if (!isFlyingMission || name != mission) {
            return DjiError("CANNOT_STOP_WAYLINE_WHEN_WAYLINE_NOT_RUNNING", "not running")
        }
        isFlyingMission = false
        return null
    }

    private fun movedBy(next: String) {
        isFlyingMission = false
        hasSticks = false
        mode = next
    }

    private fun shownMode() = if (isFlyingMission) "NAVI_GO" else if (hasSticks) "JOYSTICK" else mode
}
