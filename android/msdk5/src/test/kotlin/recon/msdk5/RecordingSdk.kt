package recon.msdk5

/** DJI's SDK as the adapter sees it: records every call, and answers at once or when the test does. */
class RecordingSdk : DjiSdk {
    val calls = mutableListOf<String>()
    val sticks = mutableListOf<DjiStick>()
    val files = mutableListOf<ByteArray>()
    var frames: ((ByteArray, Int, Int) -> Unit)? = null
    var camera: ((CameraEvent) -> Unit)? = null
    var snapshot: DjiSnapshot? = FLYING
    var readings = DjiReadings()
    var readingsCount = 0

    /** DJI's error for calls that begin with a text; the others succeed. */
    val errors = mutableMapOf<String, DjiError>()

    /** What DJI's checker says of mission files. */
    var check: FileCheck = FileCheck.Passed

    /** Collected instead of answered. */
    var waiting: MutableList<Done>? = null

    override fun snapshot() = snapshot

    override fun perform(action: FlightAction, done: Done) = record(action.name, done)

    override fun enableVirtualStick(done: Done) = record("enable sticks", done)

    override fun disableVirtualStick(done: Done) = record("disable sticks", done)

    override fun sendStick(stick: DjiStick) {
        calls += "stick"
        sticks += stick
    }

    override fun checkMission(name: String, kmz: ByteArray): FileCheck = check

    override fun pushMission(name: String, kmz: ByteArray, done: Done) {
        files += kmz
        record("push $name", done)
    }

    override fun startMission(name: String, done: Done) = record("start $name", done)

    override fun stopMission(name: String, done: Done) = record("stop $name", done)

    override fun pauseMission(done: Done) = record("pause", done)

    override fun readings() = readings.also { readingsCount++ }

    override fun lockExposure(isLocked: Boolean, done: Done) = record("lock exposure $isLocked", done)

    override fun setWhiteBalance(wanted: WhiteBalance, done: Done) =
        record("white balance ${wanted.mode} ${wanted.temperature}", done)

    override fun onCamera(listener: ((CameraEvent) -> Unit)?) {
        camera = listener
    }

    override fun onFrame(listener: ((ByteArray, Int, Int) -> Unit)?) {
        frames = listener
    }

    private fun record(call: String, done: Done) {
        calls += call
        waiting?.let { it += done; return }
        done(errors.entries.firstOrNull { call.startsWith(it.key) }?.value)
    }
}

/** A real aircraft's values while it hovers at 20 m. */
val FLYING = DjiSnapshot(
    updatedNs = 5,
    serial = "1581F5BKD22BJ00A",
    isFlying = true,
    flightMode = "GPS_ATTI",
    latitudeDeg = 45.0,
    longitudeDeg = -93.0,
    altitudeM = 20.0,
    takeoffAltitudeM = 280.0,
    velocityNorthMps = 1.0,
    velocityEastMps = 2.0,
    velocityDownMps = -0.5,
    yawDeg = 90.0,
    pitchDeg = 1.0,
    rollDeg = -1.0,
    satellites = 17,
    gpsLevel = "LEVEL_5",
    batteryPercent = 80,
    windWarning = "LEVEL_1",
    goHomeHeightM = 40,
    failsafe = "GOHOME",
    isVirtualStickSupported = true,
    isVirtualStickEnabled = false,
    missionState = "READY",
    hasCamera = true,
    product = "DJI_MAVIC_3_ENTERPRISE_SERIES",
    camera = "M3E",
)
