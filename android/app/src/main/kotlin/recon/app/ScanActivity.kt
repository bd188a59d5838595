package recon.app

import android.Manifest
import android.app.Activity
import android.content.Intent
import android.content.pm.PackageManager
import android.graphics.ImageFormat
import android.graphics.SurfaceTexture
import android.hardware.camera2.CameraAccessException
import android.hardware.camera2.CameraCaptureSession
import android.hardware.camera2.CameraCharacteristics
import android.hardware.camera2.CameraDevice
import android.hardware.camera2.CameraManager
import android.hardware.camera2.CaptureRequest
import android.media.Image
import android.media.ImageReader
import android.net.Uri
import android.os.Bundle
import android.os.Handler
import android.os.HandlerThread
import android.view.Surface
import android.view.TextureView
import android.view.View
import android.widget.TextView

/** Reads the console's QR code with the camera; its result's data is the code's text. Upright only. */
class ScanActivity : Activity(), TextureView.SurfaceTextureListener {
    private val cameras by lazy { getSystemService(CameraManager::class.java) }
    private val preview by lazy { findViewById<TextureView>(R.id.preview) }
    private val thread = HandlerThread("scan")
    private val handler by lazy { Handler(thread.looper) }
    private val pictures = ImageReader.newInstance(WIDTH, HEIGHT, ImageFormat.YUV_420_888, 2)
    private var camera: CameraDevice? = null

    override fun onCreate(savedInstanceState: Bundle?) {
        super.onCreate(savedInstanceState)
        setContentView(R.layout.scan)
        findViewById<View>(R.id.cancel).setOnClickListener { finish() }
        thread.start()
        pictures.setOnImageAvailableListener({ reader -> reader.acquireLatestImage()?.use(::look) }, handler)
        preview.surfaceTextureListener = this
        if (!isAllowed()) requestPermissions(arrayOf(Manifest.permission.CAMERA), 0)
    }

    override fun onRequestPermissionsResult(code: Int, names: Array<String>, results: IntArray) {
        if (!isAllowed()) showNoCamera() else if (preview.isAvailable) open()
    }

    override fun onSurfaceTextureAvailable(surface: SurfaceTexture, width: Int, height: Int) {
        if (isAllowed()) open()
    }

    override fun onSurfaceTextureSizeChanged(surface: SurfaceTexture, width: Int, height: Int) = Unit

    override fun onSurfaceTextureDestroyed(surface: SurfaceTexture): Boolean = true

    override fun onSurfaceTextureUpdated(surface: SurfaceTexture) = Unit

    override fun onStop() {
        super.onStop()
        camera?.close()
        camera = null
        // A scan that was left is begun anew from the first screen.
        finish()
    }

    override fun onDestroy() {
        super.onDestroy()
        pictures.close()
        thread.quitSafely()
    }

    private fun isAllowed() = checkSelfPermission(Manifest.permission.CAMERA) == PackageManager.PERMISSION_GRANTED

    private fun open() {
        try {
            val id = cameras.cameraIdList.firstOrNull(::isBackCamera) ?: return showNoCamera()
            cameras.openCamera(id, Opened(), handler)
        } catch (_: CameraAccessException) {
            showNoCamera()
        } catch (_: SecurityException) {
            showNoCamera()
        }
    }

    private fun isBackCamera(id: String): Boolean =
        cameras.getCameraCharacteristics(id).get(CameraCharacteristics.LENS_FACING) ==
            CameraCharacteristics.LENS_FACING_BACK

    private fun showNoCamera() {
        findViewById<TextView>(R.id.hint).setText(R.string.no_camera)
    }

    private fun look(image: Image) {
        val plane = image.planes[0]
        val luma = ByteArray(plane.buffer.remaining()).also { plane.buffer.get(it) }
        val text = qrTextOf(luma, plane.rowStride, image.width, image.height) ?: return
        runOnUiThread {
            setResult(RESULT_OK, Intent().setData(Uri.parse(text)))
            finish()
        }
    }

    private inner class Opened : CameraDevice.StateCallback() {
        override fun onOpened(opened: CameraDevice) {
            val texture = preview.surfaceTexture
            if (isFinishing || texture == null) return opened.close()
            camera = opened
            texture.setDefaultBufferSize(WIDTH, HEIGHT)
            val surfaces = listOf(Surface(texture), pictures.surface)
            @Suppress("DEPRECATION")
            opened.createCaptureSession(surfaces, Session(opened, surfaces), handler)
        }

        override fun onDisconnected(lost: CameraDevice) = lost.close()

        override fun onError(failed: CameraDevice, code: Int) {
            failed.close()
            runOnUiThread(::showNoCamera)
        }
    }

    private inner class Session(
        private val opened: CameraDevice,
        private val surfaces: List<Surface>,
    ) : CameraCaptureSession.StateCallback() {
        override fun onConfigured(session: CameraCaptureSession) = try {
            repeatRequest(session)
        } catch (_: CameraAccessException) {
            runOnUiThread(::showNoCamera)
        } catch (_: IllegalStateException) {
            // The screen was left meanwhile: the camera is closed.
        }

        private fun repeatRequest(session: CameraCaptureSession) {
            val request = opened.createCaptureRequest(CameraDevice.TEMPLATE_PREVIEW)
            surfaces.forEach(request::addTarget)
            request.set(CaptureRequest.CONTROL_AF_MODE, CaptureRequest.CONTROL_AF_MODE_CONTINUOUS_PICTURE)
            session.setRepeatingRequest(request.build(), null, handler)
        }

        override fun onConfigureFailed(session: CameraCaptureSession) = runOnUiThread(::showNoCamera)
    }

    private companion object {
        /** Every camera has this size for previews. */
        const val WIDTH = 640
        const val HEIGHT = 480
    }
}
