package recon.errors

/**
 * Root of all errors of the companion app; each subtree is declared beside the code that raises it:
 *
 *     ReconError
 *       WireError      a frame, a field or a limit of the drone interface (recon.wire)
 *       KmzError       a mission file that cannot be read (recon.mission)
 *       AddressError   a station's address that cannot be used (recon.link)
 *
 * Each message states what was expected, what came, and what to do where that is not obvious. A
 * refused command is a value (`recon.aircraft.Answer`), not an error.
 */
abstract class ReconError(override val message: String, cause: Throwable? = null) : Exception(message, cause)
