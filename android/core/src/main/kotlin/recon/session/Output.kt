package recon.session

import recon.aircraft.AircraftCommand
import recon.aircraft.VideoFrame

enum class Severity { INFO, WARNING, ERROR }

/** What a session asks of its surroundings after an input. */
sealed interface Output {
    /** Pass the command to the aircraft, and its answer back with [callId]. */
    data class Execute(val callId: Long, val command: AircraftCommand) : Output

    /** Encode a frame as an image packet and pass it back; [quality] is a JPEG file's, in percent. */
    data class Encode(val frame: VideoFrame, val targetFpsHz: Float, val quality: Int) : Output

    /** A text of the extension that goes to the station, for the log. */
    data class Told(val text: String) : Output

    data class CloseLink(val reason: String) : Output

    /** A sentence for the person beside the phone: screen, speech and log. */
    data class Notice(val severity: Severity, val text: String) : Output
}
