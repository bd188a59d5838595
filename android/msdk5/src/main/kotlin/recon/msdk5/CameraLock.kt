package recon.msdk5

import recon.aircraft.Answer

/** Holds exposure and white balance of the camera as they are, and gives them back. */
internal class CameraLock(private val sdk: DjiSdk) {
    /** White balance before the lock, which the unlock gives back; null when the lock has not changed it. */
    private var before: WhiteBalance? = null

    /** The steps to lock or unlock. The white balance is held at the temperature that the camera tells. */
    fun steps(isLocked: Boolean, present: WhiteBalance?): List<Step> =
        listOfNotNull(Step { sdk.lockExposure(isLocked, it) }, if (isLocked) hold(present) else giveBack())

    private fun hold(present: WhiteBalance?): Step? = when {
        present == null -> refused("the camera does not tell its white balance")
        present.mode != AUTO -> null
        (present.temperature ?: 0) <= 0 -> refused("the camera does not tell its colour temperature")
        else -> Step({ failed("$it", it.code) }) { done ->
            before = present
            sdk.setWhiteBalance(WhiteBalance(MANUAL, present.temperature), done)
        }
    }

    private fun giveBack(): Step? = before?.let { balance ->
        before = null
        Step { sdk.setWhiteBalance(balance, it) }
    }

    private fun refused(reason: String) = Step({ failed(it.description, code = null) }) { it(DjiError("", reason)) }

    private fun failed(reason: String, code: String?) =
        Answer.Refused("the exposure is locked, the white balance is not: $reason. To try: set it in DJI's app", code)
}
