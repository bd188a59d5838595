package recon.msdk5

import dji.sdk.keyvalue.key.BatteryKey
import dji.sdk.keyvalue.key.CameraKey
import dji.sdk.keyvalue.key.DJIActionKeyInfo
import dji.sdk.keyvalue.key.FlightControllerKey
import dji.sdk.keyvalue.key.GimbalKey
import dji.sdk.keyvalue.key.KeyTools
import dji.sdk.keyvalue.key.ProductKey
import dji.sdk.keyvalue.value.common.ComponentIndexType
import dji.sdk.keyvalue.value.common.EmptyMsg
import dji.sdk.keyvalue.value.flightcontroller.FlightCoordinateSystem
import dji.sdk.keyvalue.value.flightcontroller.RollPitchControlMode
import dji.sdk.keyvalue.value.flightcontroller.VerticalControlMode
import dji.sdk.keyvalue.value.flightcontroller.VirtualStickFlightControlParam
import dji.sdk.keyvalue.value.flightcontroller.YawControlMode
import dji.v5.common.callback.CommonCallbacks
import dji.v5.common.error.IDJIError
import dji.v5.manager.KeyManager
import dji.v5.manager.aircraft.virtualstick.VirtualStickManager
import dji.v5.manager.aircraft.waypoint3.WaylineExecutingInfoListener
import dji.v5.manager.aircraft.waypoint3.WaypointMissionManager
import dji.v5.manager.aircraft.waypoint3.model.WaylineExecutingInfo
import dji.v5.manager.datacenter.MediaDataCenter
import dji.v5.manager.interfaces.ICameraStreamManager
import java.io.File

/**
 * DJI's Mobile SDK 5.18.0 behind [DjiSdk]: one call for each call, and no decision. Compiled and linked
 * against DJI's signatures; never run, because the SDK runs only on a phone with an aircraft.
 *
 * Made after the SDK has registered. [folder] holds the mission files, which [check] judges.
 */
class Msdk5(private val folder: File, private val check: (File) -> FileCheck, private val clockNs: () -> Long) :
    DjiSdk, AutoCloseable {
    private val manager = KeyManager.getInstance()
    private val keys = Msdk5Keys(manager)
    private val camera = Msdk5Camera(manager, keys)
    private val missions = WaypointMissionManager.getInstance()
    private val sticks = VirtualStickManager.getInstance()
    private val streams: ICameraStreamManager = MediaDataCenter.getInstance().cameraStreamManager
    private var frames: ICameraStreamManager.CameraFrameListener? = null

    @Volatile
    private var updatedNs: Long? = null

    @Volatile
    private var missionState: String? = null

    @Volatile
    private var missionName: String? = null

    @Volatile
    private var hasCamera: Boolean? = null

    private val executing = object : WaylineExecutingInfoListener {
        override fun onWaylineExecutingInfoUpdate(info: WaylineExecutingInfo?) {
            missionName = info?.missionFileName?.removeSuffix(".kmz")?.ifBlank { null }
        }

        override fun onWaylineExecutingInterruptReasonUpdate(error: IDJIError?) = Unit
    }

    init {
        sticks.init()
        missions.init()
        val attitude = KeyTools.createKey(FlightControllerKey.KeyAircraftAttitude)
        manager.listen(attitude, this) { _, _ -> updatedNs = clockNs() }
        missions.addWaypointMissionExecuteStateListener { missionState = it?.name }
        missions.addWaylineExecutingInfoListener(executing)
        streams.addAvailableCameraUpdatedListener { hasCamera = it.isNotEmpty() }
    }

    override fun close() {
        manager.cancelListen(this)
        missions.clearAllWaypointMissionExecuteStateListener()
        missions.clearAllWaylineExecutingInfoListener()
        onFrame(null)
        onCamera(null)
    }

    override fun snapshot(): DjiSnapshot? {
        val location = keys.value(FlightControllerKey.KeyAircraftLocation3D)
        val velocity = keys.value(FlightControllerKey.KeyAircraftVelocity)
        val attitude = keys.value(FlightControllerKey.KeyAircraftAttitude)
        return DjiSnapshot(
            updatedNs = updatedNs ?: return null,
            serial = keys.value(FlightControllerKey.KeySerialNumber),
            isFlying = keys.value(FlightControllerKey.KeyIsFlying),
            flightMode = keys.value(FlightControllerKey.KeyFCFlightMode)?.name,
            latitudeDeg = location?.latitude,
            longitudeDeg = location?.longitude,
            altitudeM = location?.altitude,
            takeoffAltitudeM = keys.value(FlightControllerKey.KeyTakeoffLocationAltitude),
            velocityNorthMps = velocity?.x,
            velocityEastMps = velocity?.y,
            velocityDownMps = velocity?.z,
            yawDeg = attitude?.yaw,
            pitchDeg = attitude?.pitch,
            rollDeg = attitude?.roll,
            satellites = keys.value(FlightControllerKey.KeyGPSSatelliteCount),
            gpsLevel = keys.value(FlightControllerKey.KeyGPSSignalLevel)?.name,
            isNearHeightLimit = keys.value(FlightControllerKey.KeyIsNearHeightLimit),
            isNearDistanceLimit = keys.value(FlightControllerKey.KeyIsNearDistanceLimit),
            batteryPercent = keys.value(BatteryKey.KeyChargeRemainingInPercent),
            isLowBattery = keys.value(FlightControllerKey.KeyIsLowBatteryWarning),
            isSeriousLowBattery = keys.value(FlightControllerKey.KeyIsSeriousLowBatteryWarning),
            windWarning = keys.value(FlightControllerKey.KeyWindWarning)?.name,
            isLandingConfirmationNeeded = keys.value(FlightControllerKey.KeyIsLandingConfirmationNeeded),
            goHomeHeightM = keys.value(FlightControllerKey.KeyGoHomeHeight),
            failsafe = keys.value(FlightControllerKey.KeyFailsafeAction)?.name,
            isVirtualStickSupported = keys.isSupported(FlightControllerKey.KeyVirtualStickEnabled),
            isVirtualStickEnabled = keys.value(FlightControllerKey.KeyVirtualStickEnabled),
            missionState = missionState,
            missionName = missionName,
            hasCamera = hasCamera,
            product = keys.value(ProductKey.KeyProductType)?.name,
            camera = keys.value(CameraKey.KeyCameraType)?.name,
            gimbalPitchDeg = keys.value(GimbalKey.KeyGimbalAttitude)?.pitch,
        )
    }

    override fun perform(action: FlightAction, done: Done) {
        val key = when (action) {
            FlightAction.START_TAKEOFF -> FlightControllerKey.KeyStartTakeoff
            FlightAction.STOP_TAKEOFF -> FlightControllerKey.KeyStopTakeoff
            FlightAction.START_AUTO_LANDING -> FlightControllerKey.KeyStartAutoLanding
            FlightAction.STOP_AUTO_LANDING -> FlightControllerKey.KeyStopAutoLanding
            FlightAction.CONFIRM_LANDING -> FlightControllerKey.KeyConfirmLanding
            FlightAction.START_GO_HOME -> FlightControllerKey.KeyStartGoHome
            FlightAction.STOP_GO_HOME -> FlightControllerKey.KeyStopGoHome
        }
        perform(key, done)
    }

    override fun enableVirtualStick(done: Done) {
        sticks.enableVirtualStick(keys.completion { error ->
            if (error == null) sticks.setVirtualStickAdvancedModeEnabled(true)
            done(error)
        })
    }

    override fun disableVirtualStick(done: Done) = sticks.disableVirtualStick(keys.completion(done))

    override fun sendStick(stick: DjiStick) {
        val frame = if (stick.isBodyFrame) FlightCoordinateSystem.BODY else FlightCoordinateSystem.GROUND
        sticks.sendVirtualStickAdvancedParam(
            VirtualStickFlightControlParam(
                stick.pitchMps,
                stick.rollMps,
                stick.yawDeg,
                stick.verticalMps,
                VerticalControlMode.VELOCITY,
                RollPitchControlMode.VELOCITY,
                YawControlMode.ANGLE,
                frame,
            ),
        )
    }

    override fun checkMission(name: String, kmz: ByteArray): FileCheck = check(fileOf(name, kmz))

    override fun pushMission(name: String, kmz: ByteArray, done: Done) {
        missions.pushKMZFileToAircraft(
            fileOf(name, kmz).path,
            object : CommonCallbacks.CompletionCallbackWithProgress<Double> {
                override fun onProgressUpdate(progress: Double?) = Unit

                override fun onSuccess() = done(null)

                override fun onFailure(error: IDJIError) = done(Msdk5Keys.errorOf(error))
            },
        )
    }

    override fun startMission(name: String, done: Done) = missions.startMission(name, keys.completion(done))

    override fun pauseMission(done: Done) = missions.pauseMission(keys.completion(done))

    override fun readings(): DjiReadings = camera.addedTo(msdk5Readings(keys))

    override fun lockExposure(isLocked: Boolean, done: Done) = camera.lockExposure(isLocked, done)

    override fun setWhiteBalance(wanted: WhiteBalance, done: Done) = camera.setWhiteBalance(wanted, done)

    override fun onCamera(listener: ((CameraEvent) -> Unit)?) = camera.onEvent(listener)

    override fun stopMission(name: String, done: Done) = missions.stopMission(name, keys.completion(done))

    override fun onFrame(listener: ((ByteArray, Int, Int) -> Unit)?) {
        frames?.let(streams::removeFrameListener)
        frames = listener?.let { frameListener(it) }?.also {
            streams.addFrameListener(ComponentIndexType.LEFT_OR_MAIN, ICameraStreamManager.FrameFormat.NV21, it)
        }
    }

    private fun frameListener(listener: (ByteArray, Int, Int) -> Unit) =
        ICameraStreamManager.CameraFrameListener { data, offset, length, width, height, _ ->
            // Copied: the SDK reuses its buffer for the next frame.
            listener(data.copyOfRange(offset, offset + length), width, height)
        }

    private fun fileOf(name: String, kmz: ByteArray) = File(folder, "$name.kmz").apply { writeBytes(kmz) }

    private fun perform(key: DJIActionKeyInfo<EmptyMsg, EmptyMsg>, done: Done) {
        manager.performAction(
            KeyTools.createKey(key),
            object : CommonCallbacks.CompletionCallbackWithParam<EmptyMsg> {
                override fun onSuccess(result: EmptyMsg?) = done(null)

                override fun onFailure(error: IDJIError) = done(Msdk5Keys.errorOf(error))
            },
        )
    }
}
