package recon.msdk5

import recon.aircraft.ReleasedPhoto
import kotlin.test.Test
import kotlin.test.assertEquals

class PhotoReleasesTest {
    private val releases = PhotoReleases()
    private val taken = mutableListOf<Long>()

    @Test
    fun `files of one release are one photo, by their number or by their time`() {
        file(1_000, "JPEG", 1)
        file(1_100, "JPEG", 2)
        file(2_500, "TIFF", 1)
        file(3_000, "DNG", null)
        file(3_300, "JPEG", null)
        file(4_000, "MP4", 3)
        assertEquals(listOf<Long>(1_000, 3_000), taken)
    }

    @Test
    fun `the shutter that waits longest is that of a file, unless its photo has failed`() {
        shutter(1_000)
        shutter(1_700)
        file(2_000, "JPEG", 1)
        file(2_600, "JPEG", 2)
        file(3_400, "JPEG", 3)
        shutter(10_000)
        shutter(12_500)
        file(12_900, "JPEG", 4)
        assertEquals(listOf<Long>(1_000, 1_700, 3_400, 12_500), taken)
    }

    @Test
    fun `a number that comes again after long is another photo, and what waits is bounded`() {
        file(1_000, "JPEG", 1)
        file(12_000, "JPEG", 1)
        repeat(100) { shutter(20_000L + it) }
        file(20_100, "HEIF", 2)
        assertEquals(listOf<Long>(1_000, 12_000, 20_084), taken)
    }

    private fun shutter(ms: Long) = tell(CameraEvent.Shutter, ms)

    private fun file(ms: Long, type: String, number: Int?) = tell(CameraEvent.StoredFile(type, 100, number), ms)

    private fun tell(event: CameraEvent, ms: Long) {
        releases.of(event, ReleasedPhoto(ms * 1_000_000, 0))?.let { taken += it.takenNs / 1_000_000 }
    }
}
