package recon.wire

/** What a frame's size field must satisfy, in bytes of the whole frame. */
sealed interface SizeRule {
    val description: String

    fun allows(size: Long): Boolean

    data class Exactly(val size: Long) : SizeRule {
        override val description get() = "$size"

        override fun allows(size: Long) = size == this.size
    }

    /** From [least] to [most], and a whole number of [step] above [least]. */
    data class Between(val least: Long, val most: Long, val step: Long = 1) : SizeRule {
        override val description get() = "$least to $most" + if (step > 1) " in steps of $step" else ""

        override fun allows(size: Long) = size in least..most && (size - least) % step == 0L
    }

    /** A length inside the payload is over its limit: no size could be right. */
    data class Over(val what: String, val most: String, val came: String) : SizeRule {
        override val description get() = "that of a packet with $what of at most $most, not $came"

        override fun allows(size: Long) = false
    }
}
