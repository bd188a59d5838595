package recon.session

import recon.aircraft.AircraftCommand
import recon.aircraft.Answer
import recon.aircraft.MissionAction

/** How an action ended, for the station. */
internal data class Outcome(
    val action: String, val isOk: Boolean, val code: String? = null, val text: String? = null,
    val missionId: Int? = null,
)

/** The outcome of an action that was accepted; null for those that only a failure tells of. */
internal fun okOutcome(command: AircraftCommand, missionId: Int): Outcome? = when (command) {
    is AircraftCommand.FlyMission -> Outcome("mission_start", isOk = true, missionId = missionId)
    is AircraftCommand.LockCamera -> Outcome(lockWord(command), isOk = true)
    else -> null
}

/** The outcome of an action that was refused; null for what the station has not ordered. */
internal fun failedOutcome(command: AircraftCommand, answer: Answer.Refused): Outcome? {
    val action = when (command) {
        is AircraftCommand.FlyMission -> missionWord(answer.action ?: MissionAction.START)
        is AircraftCommand.LockCamera -> lockWord(command)
        is AircraftCommand.Hover -> "hover"
        is AircraftCommand.Land -> "land"
        is AircraftCommand.GoHome -> "go_home"
        is AircraftCommand.SetStick -> "virtual_stick"
        is AircraftCommand.SetVideo -> "video"
        is AircraftCommand.TakeOff, is AircraftCommand.ConfirmLanding -> return null
    }
    return Outcome(action, isOk = false, answer.code, answer.reason)
}

/** The text of how an action ended. */
internal fun outcomeText(outcome: Outcome): String = text("outcome") {
    word("action", outcome.action)
    flag("ok", outcome.isOk)
    text("code", outcome.code, LONGEST_NAME)
    text("text", outcome.text, LONGEST_SENTENCE)
    whole("mission_id", outcome.missionId?.toLong(), 0, 65_535)
}

private fun missionWord(action: MissionAction): String = when (action) {
    MissionAction.UPLOAD -> "mission_upload"
    MissionAction.LOAD -> "mission_load"
    MissionAction.START -> "mission_start"
}

private fun lockWord(command: AircraftCommand.LockCamera) = if (command.isLocked) "lock_camera" else "unlock_camera"
