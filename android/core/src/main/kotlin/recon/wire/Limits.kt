package recon.wire

/** Largest sizes that a reader accepts (docs/icd.md, "Reading a stream", rule 1) and how long it waits. */
data class Limits(
    val maxSerialBytes: Int = 256,
    val maxMessageBytes: Int = 65_536,
    val maxJpegBytes: Int = 16_777_216,
    val maxImageRows: Int = 2_160,
    val maxImageCols: Int = 3_840,
    val maxWaypoints: Int = 99,
    val maxUnknownBytes: Int = 65_536,
    /** Half a packet fails when no byte came for this long. */
    val stallTimeoutNs: Long = 2_000_000_000,
    /** Half a packet fails when its first byte is this old. */
    val ageTimeoutNs: Long = 10_000_000_000,
) {
    companion object {
        /**
         * What an app accepts from its station: no images. A false header then holds 64 KiB of a
         * phone's memory at most, instead of 25 MB.
         */
        val FROM_STATION = Limits(maxJpegBytes = 0, maxImageRows = 0, maxImageCols = 0)
    }
}
