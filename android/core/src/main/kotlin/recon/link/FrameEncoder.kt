package recon.link

import recon.aircraft.VideoFrame
import recon.aircraft.toRgb
import recon.wire.Bytes
import recon.wire.Image
import recon.wire.Packet

/** Makes the image packet of a frame; runs on a thread of its own. */
fun interface FrameEncoder {
    /** [quality] is a JPEG file's, in percent. */
    fun encode(frame: VideoFrame, targetFpsHz: Float, quality: Int): Packet
}

/** PID 2 of the first revision: raw pixels. */
object RawFrameEncoder : FrameEncoder {
    override fun encode(frame: VideoFrame, targetFpsHz: Float, quality: Int): Packet =
        Image(targetFpsHz, frame.height, frame.width, Bytes.copyOf(frame.toRgb()))
}
