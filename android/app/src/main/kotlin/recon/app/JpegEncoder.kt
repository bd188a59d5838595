package recon.app

import android.graphics.ImageFormat
import android.graphics.Rect
import android.graphics.YuvImage
import recon.aircraft.VideoFrame
import recon.link.FrameEncoder
import recon.wire.Bytes
import recon.wire.CompressedImage
import recon.wire.Packet
import java.io.ByteArrayOutputStream

/** PID 5 of the later revisions: the frame as a JPEG file, by Android's encoder. */
object JpegEncoder : FrameEncoder {
    override fun encode(frame: VideoFrame, targetFpsHz: Float, quality: Int): Packet {
        val image = YuvImage(frame.nv21, ImageFormat.NV21, frame.width, frame.height, null)
        val file = ByteArrayOutputStream()
        image.compressToJpeg(Rect(0, 0, frame.width, frame.height), quality, file)
        return CompressedImage(targetFpsHz, Bytes.copyOf(file.toByteArray()))
    }
}
