package recon.app

import android.content.Context
import android.speech.tts.TextToSpeech
import recon.session.Output
import recon.session.Severity
import java.util.Locale

/** Something that says a sentence aloud; [isUrgent] interrupts the sentence before. */
fun interface Voice {
    fun say(text: String, isUrgent: Boolean)
}

/** Which sentences are spoken: warnings and errors, the same one at most every ten seconds. */
class SpokenWarnings(private val voice: Voice) {
    private val spokenNs = LinkedHashMap<String, Long>()

    fun notice(notice: Output.Notice, nowNs: Long) {
        if (notice.severity == Severity.INFO) return
        val last = spokenNs[notice.text]
        if (last != null && nowNs - last < PAUSE_NS) return
        spokenNs.entries.removeAll { nowNs - it.value >= PAUSE_NS }
        spokenNs[notice.text] = nowNs
        voice.say(notice.text, isUrgent = notice.severity == Severity.ERROR)
    }

    private companion object {
        const val PAUSE_NS = 10_000_000_000L
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
