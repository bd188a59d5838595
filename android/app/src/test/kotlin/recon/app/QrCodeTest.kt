package recon.app

import com.google.zxing.BarcodeFormat
import com.google.zxing.qrcode.QRCodeWriter
import net.jqwik.api.ForAll
import net.jqwik.api.Property
import net.jqwik.api.constraints.Size
import java.util.Random
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertNull

private const val WIDTH = 640
private const val HEIGHT = 480

class QrCodeTest {

    @Test
    fun `a code is read upright, on its side, and in a noisy picture whose rows are padded`() {
        val text = "recon://192.168.8.20:3001"
        for (turned in listOf(false, true)) {
            assertEquals(text, qrTextOf(picture(text, turned, stride = WIDTH), WIDTH, WIDTH, HEIGHT))
            val padded = picture(text, turned, stride = 704)
            assertEquals(text, qrTextOf(padded, 704, WIDTH, HEIGHT))
            // Cameras leave the padding of the last row out.
            assertEquals(text, qrTextOf(padded.copyOf(padded.size - 64), 704, WIDTH, HEIGHT))
        }
    }

    @Test
    fun `a picture without a code has no text`() {
        assertNull(qrTextOf(ByteArray(WIDTH * HEIGHT), WIDTH, WIDTH, HEIGHT))
    }

    @Property(tries = 100)
    fun `any picture is read without an exception`(@ForAll @Size(10_000) luma: ByteArray) {
        qrTextOf(luma, 100, 100, 100)
    }

    /** A grey picture with the code a little off its middle. */
    private fun picture(text: String, isTurned: Boolean, stride: Int): ByteArray {
        val code = QRCodeWriter().encode(text, BarcodeFormat.QR_CODE, 300, 300)
        val random = Random(1)
        val luma = ByteArray(stride * HEIGHT) { (110 + random.nextInt(30)).toByte() }
        for (row in 0 until 300) for (column in 0 until 300) {
            val isDark = if (isTurned) code[row, 299 - column] else code[column, row]
            luma[(row + 70) * stride + column + 190] = ((if (isDark) 40 else 200) + random.nextInt(30)).toByte()
        }
        return luma
    }
}
