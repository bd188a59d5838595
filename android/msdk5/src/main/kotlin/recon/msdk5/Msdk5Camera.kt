package recon.msdk5

import dji.sdk.keyvalue.key.CameraKey
import dji.sdk.keyvalue.key.KeyTools
import dji.sdk.keyvalue.value.camera.CameraWhiteBalanceInfo
import dji.sdk.keyvalue.value.camera.CameraWhiteBalanceMode
import dji.v5.manager.interfaces.IKeyManager

/** The camera by DJI's keys: one call for each call, and no decision. */
internal class Msdk5Camera(private val manager: IKeyManager, private val keys: Msdk5Keys) {

    fun lockExposure(isLocked: Boolean, done: Done) = keys.setOfLens(CameraKey.KeyAELockEnabled, isLocked, done)

    fun setWhiteBalance(wanted: WhiteBalance, done: Done) {
        val mode = CameraWhiteBalanceMode.valueOf(wanted.mode)
        keys.setOfLens(CameraKey.KeyWhiteBalance, CameraWhiteBalanceInfo(mode, wanted.temperature), done)
    }

    fun onEvent(listener: ((CameraEvent) -> Unit)?) {
        manager.cancelListen(this)
        if (listener == null) return
        manager.listen(KeyTools.createKey(CameraKey.KeyIsShootingPhoto), this) { _, isShooting ->
            if (isShooting == true) listener(CameraEvent.Shutter)
        }
        // Listening begins with the newest file of before.
        manager.listen(KeyTools.createKey(CameraKey.KeyNewlyGeneratedMediaFile), this) { old, file ->
            if (old != null && file != null) {
                listener(CameraEvent.StoredFile(file.type?.name, file.dir_no, file.file_no))
            }
        }
    }

    /** What of the camera changes seldom, beside the readings of the rest. */
    fun addedTo(readings: DjiReadings): DjiReadings {
        val storage = keys.value(CameraKey.KeyCameraStorageInfos)?.currentCameraStorageInfo
        val balance = keys.valueOfLens(CameraKey.KeyWhiteBalance)
        return readings.copy(
            storageLeftMb = storage?.storageLeftCapacity,
            storageLeftPhotos = storage?.availablePhotoCount,
            cameraMode = keys.value(CameraKey.KeyCameraMode)?.name,
            photoIntervalS = keys.value(CameraKey.KeyPhotoIntervalShootSettings)?.interval,
            isExposureLocked = keys.valueOfLens(CameraKey.KeyAELockEnabled),
            exposureMode = keys.valueOfLens(CameraKey.KeyExposureMode)?.name,
            whiteBalance = balance?.whiteBalanceMode?.let { WhiteBalance(it.name, balance.colorTemperature) },
            tellsFiles = keys.isSupported(CameraKey.KeyNewlyGeneratedMediaFile),
            takesExposureLock = keys.isSupportedByLens(CameraKey.KeyAELockEnabled),
        )
    }
}
