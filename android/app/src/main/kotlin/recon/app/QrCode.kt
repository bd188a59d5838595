package recon.app

import com.google.zxing.BarcodeFormat
import com.google.zxing.BinaryBitmap
import com.google.zxing.DecodeHintType
import com.google.zxing.PlanarYUVLuminanceSource
import com.google.zxing.ReaderException
import com.google.zxing.common.HybridBinarizer
import com.google.zxing.qrcode.QRCodeReader

private val HINTS = mapOf(
    DecodeHintType.POSSIBLE_FORMATS to listOf(BarcodeFormat.QR_CODE),
    DecodeHintType.TRY_HARDER to true,
)

/**
 * The text of a QR code in a picture, or null without one. [luma] holds one byte a pixel, its rows
 * [rowStride] bytes apart.
 */
fun qrTextOf(luma: ByteArray, rowStride: Int, width: Int, height: Int): String? {
    // The last row of a camera's plane may end without its padding.
    val rows = if (luma.size >= rowStride * height) luma else luma.copyOf(rowStride * height)
    val source = PlanarYUVLuminanceSource(rows, rowStride, height, 0, 0, width, height, false)
    return try {
        QRCodeReader().decode(BinaryBitmap(HybridBinarizer(source)), HINTS).text
    } catch (_: ReaderException) {
        null
    }
}
