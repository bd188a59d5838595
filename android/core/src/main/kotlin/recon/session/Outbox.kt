package recon.session

/**
 * Packets that wait for the socket, most urgent first: acknowledgments, telemetry, messages, images.
 * Bounded: of telemetry only the newest waits; the oldest of the others gives way.
 */
class Outbox {
    private val acknowledgments = ArrayDeque<ByteArray>()
    private val messages = ArrayDeque<ByteArray>()
    private val images = ArrayDeque<ByteArray>()
    private var core: ByteArray? = null
    private var extended: ByteArray? = null
    private var isIdentitySent = false

    /** Images that gave way to newer ones. */
    var droppedImages = 0L
        private set

    /** Telemetry packets that gave way to newer ones. */
    var droppedTelemetry = 0L
        private set

    fun addAcknowledgment(packet: ByteArray) {
        addBounded(acknowledgments, packet, MOST_WAITING)
    }

    fun addMessage(packet: ByteArray) {
        addBounded(messages, packet, MOST_WAITING)
    }

    fun addImage(packet: ByteArray) {
        if (addBounded(images, packet, MOST_IMAGES)) droppedImages++
    }

    fun setCore(packet: ByteArray) {
        if (core != null) droppedTelemetry++
        core = packet
    }

    fun setExtended(packet: ByteArray) {
        if (extended != null) droppedTelemetry++
        extended = packet
    }

    /** Whether the packet last given by [poll] was an image. */
    var isImagePolled = false
        private set

    /** The next packet to send, or null. */
    fun poll(): ByteArray? {
        val other = acknowledgments.removeFirstOrNull() ?: pollTelemetry() ?: messages.removeFirstOrNull()
        isImagePolled = other == null
        return other ?: images.removeFirstOrNull()
    }

    fun dropImages() {
        images.clear()
    }

    fun clear() {
        listOf(acknowledgments, messages, images).forEach { it.clear() }
        core = null
        extended = null
        isIdentitySent = false
    }

    /**
     * On a new link the identity precedes everything that belongs to it. Later core telemetry goes first:
     * a mode after touchdown must not arrive before the news that the aircraft is on the ground.
     */
    private fun pollTelemetry(): ByteArray? {
        val isExtendedFirst = !isIdentitySent || core == null
        val packet = if (isExtendedFirst) extended else core
        if (packet == null) return null
        if (isExtendedFirst) extended = null else core = null
        isIdentitySent = true
        return packet
    }

    private fun addBounded(queue: ArrayDeque<ByteArray>, packet: ByteArray, most: Int): Boolean {
        val isFull = queue.size >= most
        if (isFull) queue.removeFirst()
        queue.addLast(packet)
        return isFull
    }

    private companion object {
        const val MOST_WAITING = 64
        const val MOST_IMAGES = 2
    }
}
