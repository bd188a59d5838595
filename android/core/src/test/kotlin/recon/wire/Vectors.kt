package recon.wire

import com.google.gson.JsonObject
import com.google.gson.JsonParser
import java.io.File

/** One golden packet or damaged stream of `vectors/`: its bytes and their description. */
class Vector(val name: String, val bytes: ByteArray, val description: JsonObject)

private val ROOT = File("../../vectors")

fun vectorFolders(): List<String> =
    ROOT.listFiles { file -> file.isDirectory && file.name != "bad" }.orEmpty().map { it.name }.sorted()

fun vectorsOf(folder: String): List<Vector> =
    ROOT.resolve(folder).listFiles { file -> file.extension == "bin" }.orEmpty().sorted().map { file ->
        val text = file.resolveSibling(file.nameWithoutExtension + ".json").readText()
        Vector("$folder/${file.nameWithoutExtension}", file.readBytes(), JsonParser.parseString(text).asJsonObject)
    }

fun hex(bytes: ByteArray): String = bytes.joinToString("") { "%02x".format(it) }

fun bytesOf(hex: String): ByteArray = hex.chunked(2).map { it.toInt(16).toByte() }.toByteArray()
