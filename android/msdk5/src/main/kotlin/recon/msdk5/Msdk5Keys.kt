package recon.msdk5

import dji.sdk.keyvalue.key.DJIKey
import dji.sdk.keyvalue.key.DJIKeyInfo
import dji.sdk.keyvalue.key.KeyTools
import dji.sdk.keyvalue.value.common.CameraLensType
import dji.sdk.keyvalue.value.common.ComponentIndexType
import dji.v5.common.callback.CommonCallbacks
import dji.v5.common.error.IDJIError
import dji.v5.manager.interfaces.IKeyManager

/** DJI's keys and values in plain types. */
internal class Msdk5Keys(private val keys: IKeyManager) {
    fun <T> value(key: DJIKeyInfo<T>): T? = keys.getValue(KeyTools.createKey(key))

    /** Of the second battery, or another second part. */
    fun <T> valueOfSecond(key: DJIKeyInfo<T>): T? = keys.getValue(KeyTools.createKey(key, ComponentIndexType.RIGHT))

    fun <T> valueOfLens(key: DJIKeyInfo<T>): T? = lensKey(key)?.let { keys.getValue(it) }

    fun isSupported(key: DJIKeyInfo<*>): Boolean = keys.isKeySupported(KeyTools.createKey(key))

    fun isSupportedByLens(key: DJIKeyInfo<*>): Boolean = lensKey(key) != null

    fun <T> setOfLens(key: DJIKeyInfo<T>, value: T, done: Done) {
        val lens = lensKey(key) ?: return done(DjiError("KEY_NOT_SUPPORTED", "this camera does not know it"))
        keys.setValue(lens, value, completion(done))
    }

    /** Cameras with several lenses have a setting at their wide or colour lens, the others at the camera. */
    private fun <T> lensKey(key: DJIKeyInfo<T>): DJIKey<T>? {
        val ofCamera: DJIKey<T> = KeyTools.createKey(key)
        if (keys.isKeySupported(ofCamera)) return ofCamera
        return LENSES.map { KeyTools.createCameraKey(key, ComponentIndexType.LEFT_OR_MAIN, it) }
            .firstOrNull { keys.isKeySupported(it) }
    }

    fun completion(done: Done) = object : CommonCallbacks.CompletionCallback {
        override fun onSuccess() = done(null)

        override fun onFailure(error: IDJIError) = done(errorOf(error))
    }

    companion object {
        private val LENSES = listOf(CameraLensType.CAMERA_LENS_WIDE, CameraLensType.CAMERA_LENS_RGB)

        fun errorOf(error: IDJIError) =
            DjiError(error.errorCode() ?: "no code", error.description() ?: "no description")
    }
}
