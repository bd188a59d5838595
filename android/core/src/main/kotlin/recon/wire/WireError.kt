package recon.wire

import recon.errors.ReconError

/** Bytes that are no frame, or a value that the wire cannot carry (docs/icd.md, "Reading a stream"). */
sealed class WireError(message: String) : ReconError(message) {

    /** Fewer bytes than the frame or field needs. */
    class Short(what: String, expected: Int, came: Int) :
        WireError("$what needs $expected bytes; got $came")

    /** The first two bytes are not DA A7. */
    class Sync(came: Int) : WireError("Sync must be DA A7; got %02X %02X".format(came ushr 8, came and 0xFF))

    /** The size field disagrees with the PID, with the payload's own lengths, or with the limits. */
    class Size(pid: Int, rule: SizeRule, came: Long) :
        WireError("Size of packet $pid must be ${rule.description}; got $came bytes")

    /** The checksum differs. */
    class Hash(expected: Int, came: Int) : WireError("Hash must be %04X; got %04X".format(expected, came))

    /** A value that does not fit its field. */
    class OutOfRange(field: String, expected: String, came: Any) : WireError("$field must be $expected; got $came")
}
