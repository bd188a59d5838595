package recon.mission

import recon.errors.ReconError

/** A mission file that cannot be read; the message states what was expected and what came. */
class KmzError(message: String, cause: Throwable? = null) : ReconError(message, cause)
