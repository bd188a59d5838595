package recon.wire

/** Characters kept of one text from outside; the rest is cut, visibly. */
const val LONGEST_SHOWN_TEXT = 500

/**
 * A text from outside, safe for a screen, a log or a file: bytes that are not UTF-8 and characters
 * that control a terminal or the direction of writing become U+FFFD (docs/icd.md, "Reading a stream").
 */
fun Bytes.shownText(): String = shownText(String(toByteArray(), Charsets.UTF_8))

/** The same for a text that is already decoded, such as a reason from the aircraft's SDK. */
fun shownText(text: String): String {
    val clean = text.map { if (isUnprintable(it)) '\uFFFD' else it }.joinToString("")
    return if (clean.length <= LONGEST_SHOWN_TEXT) clean else clean.take(LONGEST_SHOWN_TEXT - 1) + "…"
}

private val UNPRINTABLE = setOf(
    CharCategory.CONTROL,
    CharCategory.FORMAT,
    CharCategory.LINE_SEPARATOR,
    CharCategory.PARAGRAPH_SEPARATOR,
    CharCategory.UNASSIGNED,
    CharCategory.PRIVATE_USE,
)

private fun isUnprintable(character: Char): Boolean = character.category in UNPRINTABLE
