package recon.aircraft

/** The frame as red, green, blue rows from the upper left, without padding (BT.601, full range). */
fun VideoFrame.toRgb(): ByteArray {
    val rgb = ByteArray(width * height * 3)
    var out = 0
    for (row in 0 until height) {
        val chromaRow = width * height + row / 2 * width
        for (col in 0 until width) {
            val luma = unsigned(row * width + col)
            val chroma = chromaRow + (col and 1.inv())
            val v = unsigned(chroma) - 128
            val u = unsigned(chroma + 1) - 128
            rgb[out++] = clipped(luma + 1.402 * v)
            rgb[out++] = clipped(luma - 0.344136 * u - 0.714136 * v)
            rgb[out++] = clipped(luma + 1.772 * u)
        }
    }
    return rgb
}

private fun VideoFrame.unsigned(index: Int): Int = nv21[index].toInt() and 0xFF

private fun clipped(value: Double): Byte = (value + 0.5).toInt().coerceIn(0, 255).toByte()
