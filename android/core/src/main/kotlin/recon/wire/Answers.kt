package recon.wire

/** PID 3: the app's answer to a command; [positive] 1 accepted, anything else refused. */
data class Acknowledgment(val positive: Int, val sourcePid: Int) : Packet {
    override val pid get() = PID

    override fun write(out: FieldWriter) {
        out.u8("positive", positive)
        out.u8("source_pid", sourcePid)
    }

    companion object {
        const val PID = 3
        internal val FORMAT = fixedFormat(PID, 2) { Acknowledgment(it.u8(), it.u8()) }
    }
}

/** PID 4, of the later revisions: a sentence for the operator; [type] 0 debug to 3 error. */
data class MessageString(val type: Int, val text: Bytes) : Packet {
    override val pid get() = PID

    override fun write(out: FieldWriter) {
        out.u8("type", type)
        out.string(text)
    }

    companion object {
        const val PID = 4
        const val DEBUG = 0
        const val INFO = 1
        const val WARNING = 2
        const val ERROR = 3
        private const val EMPTY_BYTES = 14L

        internal val FORMAT = PacketFormat(
            PID,
            lengthBytes = 5,
            widest = { SizeRule.Between(EMPTY_BYTES, EMPTY_BYTES + it.maxMessageBytes) },
            rule = { reader, limits ->
                reader.skip(1)
                textRule("a text", EMPTY_BYTES, reader.u32(), limits.maxMessageBytes)
            },
            read = { MessageString(it.u8(), it.string()) },
        )
    }
}
