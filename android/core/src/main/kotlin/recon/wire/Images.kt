package recon.wire

/** PID 2: a raw frame; [pixels] are red, green, blue row by row from the upper left, without padding. */
data class Image(val targetFpsHz: Float, val rows: Int, val cols: Int, val pixels: Bytes) : Packet {
    init {
        val expected = 3L * rows * cols
        if (pixels.size.toLong() != expected) {
            throw WireError.OutOfRange("pixels", "$expected bytes for $rows rows of $cols", pixels.size)
        }
    }

    override val pid get() = PID

    override fun write(out: FieldWriter) {
        out.f32(targetFpsHz)
        out.u16("rows", rows)
        out.u16("cols", cols)
        out.bytes(pixels)
    }

    companion object {
        const val PID = 2
        private const val EMPTY_BYTES = 17L

        internal val FORMAT = PacketFormat(
            PID,
            lengthBytes = 8,
            widest = { SizeRule.Between(EMPTY_BYTES, EMPTY_BYTES + 3L * it.maxImageRows * it.maxImageCols) },
            rule = { reader, limits ->
                reader.skip(4)
                imageRule(reader.u16(), reader.u16(), limits)
            },
            read = {
                val fps = it.f32()
                Image(fps, it.u16(), it.u16(), it.bytes(it.remaining))
            },
        )

        private fun imageRule(rows: Int, cols: Int, limits: Limits): SizeRule {
            val isSmall = rows <= limits.maxImageRows && cols <= limits.maxImageCols
            if (isSmall) return SizeRule.Exactly(EMPTY_BYTES + 3L * rows * cols)
            return SizeRule.Over("an image", "${limits.maxImageRows} x ${limits.maxImageCols}", "$rows x $cols")
        }
    }
}

/** PID 5, of the later revisions: one JPEG file. */
data class CompressedImage(val targetFpsHz: Float, val jpeg: Bytes) : Packet {
    override val pid get() = PID

    override fun write(out: FieldWriter) {
        out.f32(targetFpsHz)
        out.bytes(jpeg)
    }

    companion object {
        const val PID = 5
        private const val EMPTY_BYTES = 13L

        internal val FORMAT = PacketFormat(
            PID,
            widest = { SizeRule.Between(EMPTY_BYTES, EMPTY_BYTES + it.maxJpegBytes) },
            read = { CompressedImage(it.f32(), it.bytes(it.remaining)) },
        )
    }
}
