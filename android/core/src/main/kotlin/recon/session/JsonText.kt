package recon.session

import java.math.BigDecimal
import java.math.RoundingMode

/** One JSON object, key by key; a value that is null, no number or out of its bounds is left out: unknown. */
internal class JsonText {
    private val text = StringBuilder("{")

    fun word(key: String, value: String?) = raw(key, value?.let(::quoted))

    /** A text of strangers: without control characters, cut to [longest] characters. */
    fun text(key: String, value: String?, longest: Int) =
        word(key, value?.let { printable(it).take(longest) }?.ifBlank { null })

    fun flag(key: String, value: Boolean?) = raw(key, value?.toString())

    fun whole(key: String, value: Long?, least: Long, most: Long) =
        raw(key, value?.takeIf { it in least..most }?.toString())

    fun number(key: String, value: Double?, least: Double, most: Double, digits: Int) =
        raw(key, value?.takeIf { it in least..most }?.let { plain(it, digits) })

    fun list(key: String, values: List<String>?) = raw(key, values?.joinToString(",", "[", "]"))

    fun raw(key: String, json: String?): JsonText = apply {
        if (json == null) return@apply
        if (text.length > 1) text.append(',')
        text.append(quoted(key)).append(':').append(json)
    }

    override fun toString() = "$text}"

    companion object {
        /** Plain digits, never an exponent. */
        fun plain(value: Double, digits: Int): String =
            BigDecimal(value).setScale(digits, RoundingMode.HALF_EVEN).stripTrailingZeros().toPlainString()

        fun quoted(text: String): String = buildString {
            append('"')
            for (character in text) when (character) {
                '"', '\\' -> append('\\').append(character)
                in '\u0000'..'\u001f' -> append("\\u%04x".format(character.code))
                else -> append(character)
            }
            append('"')
        }

        /** Half a surrogate pair has no UTF-8. */
        private fun printable(text: String): String =
            text.filterNot { it.isISOControl() || it.isSurrogate() }
    }
}
