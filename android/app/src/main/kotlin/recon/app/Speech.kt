package recon.app

import android.content.Context
import android.speech.tts.TextToSpeech
import recon.session.Severity
import java.util.Locale

/** Speaks a sentence; [isUrgent] interrupts the sentence before. */
fun interface Voice {
    fun say(text: String, isUrgent: Boolean)
}

/**
 * Which sentences are spoken: warnings and errors, the same one at most every ten seconds, and no more in
 * that time than can be listened to.
 */
class SpokenWarnings(private val voice: Voice) {
    private val spokenMs = LinkedHashMap<String, Long>()

    fun notice(severity: Severity, text: String, nowMs: Long) {
        if (severity == Severity.INFO) return
        spokenMs.entries.removeAll { nowMs - it.value >= PAUSE_MS }
        if (text in spokenMs || spokenMs.size >= MOST_IN_PAUSE) return
        spokenMs[text] = nowMs
        voice.say(text, isUrgent = severity == Severity.ERROR)
    }

    private companion object {
        const val PAUSE_MS = 10_000L
        const val MOST_IN_PAUSE = 5
    }
}

/** Android's speech; silent on a device that has none. */
class TextToSpeechVoice(context: Context) : Voice {
    @Volatile
    private var isReady = false
    private val engine: TextToSpeech = TextToSpeech(context) { isReady = it == TextToSpeech.SUCCESS }

    override fun say(text: String, isUrgent: Boolean) {
        if (!isReady) return
        engine.language = Locale.US
        engine.speak(text, if (isUrgent) TextToSpeech.QUEUE_FLUSH else TextToSpeech.QUEUE_ADD, null, text)
    }
}
