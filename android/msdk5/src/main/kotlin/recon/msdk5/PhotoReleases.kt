package recon.msdk5

import recon.aircraft.ReleasedPhoto

/** What the camera tells of its photos. */
sealed interface CameraEvent {
    /** It began to take a photo. */
    data object Shutter : CameraEvent

    /** It has stored a file; [type] is DJI's name, folder and number are those of its name on the card. */
    data class StoredFile(val type: String?, val folder: Int?, val number: Int?) : CameraEvent
}

/**
 * Releases of the shutter from what the camera tells.
 *
 * Theory of operation. A photo counts when its first file is stored: other lenses, spectral bands and raw
 * files have the same number, or come within 0.4 s, which is shorter than any timer. Time and place are those
 * of the shutter where the camera has told it, the oldest one that waits; one that is not followed by a file
 * within 2 s is forgotten, and a file without one has the time and place at which it was told.
 */
internal class PhotoReleases {
    private val shutters = ArrayDeque<ReleasedPhoto>()
    private val files = ArrayDeque<Pair<Pair<Int?, Int?>, Long>>()
    private var countedNs: Long? = null

    /** The photo that this event completes, or null; [now] is the aircraft at the time of the event. */
    fun of(event: CameraEvent, now: ReleasedPhoto): ReleasedPhoto? = when (event) {
        is CameraEvent.Shutter -> null.also { shutter(now) }
        is CameraEvent.StoredFile -> if (event.type in IMAGES && isFirst(event, now.takenNs)) counted(now) else null
    }

    private fun shutter(now: ReleasedPhoto) {
        shutters.addLast(now)
        if (shutters.size > MOST_WAITING) shutters.removeFirst()
    }

    private fun isFirst(file: CameraEvent.StoredFile, nowNs: Long): Boolean {
        val name = file.folder to file.number
        val isKnown = file.number != null && files.any { (known, ns) -> known == name && nowNs - ns < SAME_NAME_NS }
        val isBeside = countedNs?.let { nowNs - it < BESIDE_NS } ?: false
        files.addLast(name to nowNs)
        if (files.size > MOST_WAITING) files.removeFirst()
        return !isKnown && !isBeside
    }

    private fun counted(now: ReleasedPhoto): ReleasedPhoto {
        countedNs = now.takenNs
        shutters.removeAll { now.takenNs - it.takenNs > FORGOTTEN_NS }
        return shutters.removeFirstOrNull() ?: now
    }

    private companion object {
        val IMAGES = setOf("JPEG", "DNG", "TIFF", "HEIF", "PANORAMA")
        const val MOST_WAITING = 16
        const val FORGOTTEN_NS = 2_000_000_000L
        const val SAME_NAME_NS = 10_000_000_000L
        const val BESIDE_NS = 400_000_000L
    }
}
