package recon.companion

import recon.aircraft.VideoFrame
import recon.aircraft.toRgb
import recon.link.FrameEncoder
import recon.wire.Bytes
import recon.wire.CompressedImage
import recon.wire.Packet
import java.awt.image.BufferedImage
import java.awt.image.DataBufferByte
import java.io.ByteArrayOutputStream
import javax.imageio.IIOImage
import javax.imageio.ImageIO
import javax.imageio.ImageWriteParam

/** PID 5 of the later revisions: the frame as a JPEG file, by the Java runtime. */
object JpegEncoder : FrameEncoder {
    override fun encode(frame: VideoFrame, targetFpsHz: Float, quality: Int): Packet {
        val image = BufferedImage(frame.width, frame.height, BufferedImage.TYPE_3BYTE_BGR)
        val bgr = (image.raster.dataBuffer as DataBufferByte).data
        val rgb = frame.toRgb()
        for (at in rgb.indices step 3) {
            bgr[at] = rgb[at + 2]
            bgr[at + 1] = rgb[at + 1]
            bgr[at + 2] = rgb[at]
        }
        val file = ByteArrayOutputStream()
        val writer = ImageIO.getImageWritersByFormatName("jpeg").next()
        val options = writer.defaultWriteParam.apply {
            compressionMode = ImageWriteParam.MODE_EXPLICIT
            compressionQuality = quality / 100f
        }
        ImageIO.createImageOutputStream(file).use {
            writer.output = it
            writer.write(null, IIOImage(image, null, null), options)
        }
        writer.dispose()
        return CompressedImage(targetFpsHz, Bytes.copyOf(file.toByteArray()))
    }
}
