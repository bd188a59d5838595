package recon.msdk5

import org.objectweb.asm.ClassReader
import org.objectweb.asm.ClassVisitor
import org.objectweb.asm.FieldVisitor
import org.objectweb.asm.MethodVisitor
import org.objectweb.asm.Opcodes

/** One class as its file declares it: names of its parents, and its members as `name descriptor`. */
class DeclaredClass(val parents: List<String>, val methods: Set<String>, val fields: Set<String>)

/**
 * Classes read from their files on the class path, never loaded: those of DJI's provided jar have bodies
 * that the JVM does not verify.
 */
class ProvidedClasses {
    private val known = mutableMapOf<String, DeclaredClass?>()

    fun find(name: String): DeclaredClass? = known.getOrPut(name) { bytesOf(name)?.let(::declared) }

    fun hasMethod(owner: String, member: String): Boolean = anywhere(owner) { member in it.methods }

    fun hasField(owner: String, member: String): Boolean = anywhere(owner) { member in it.fields }

    private fun anywhere(owner: String, has: (DeclaredClass) -> Boolean): Boolean {
        val found = find(owner) ?: return false
        return has(found) || found.parents.any { anywhere(it, has) }
    }

    private fun declared(bytes: ByteArray): DeclaredClass {
        val parents = mutableListOf<String>()
        val methods = mutableSetOf<String>()
        val fields = mutableSetOf<String>()
        val visitor = object : ClassVisitor(Opcodes.ASM9) {
            override fun visit(v: Int, a: Int, name: String, s: String?, parent: String?, interfaces: Array<String>) {
                parents += listOfNotNull(parent) + interfaces
            }

            override fun visitMethod(
                a: Int, name: String, descriptor: String, s: String?, e: Array<String>?,
            ): MethodVisitor? = null.also { methods += "$name $descriptor" }

            override fun visitField(a: Int, name: String, descriptor: String, s: String?, v: Any?): FieldVisitor? =
                null.also { fields += "$name $descriptor" }
        }
        ClassReader(bytes).accept(visitor, ClassReader.SKIP_CODE)
        return DeclaredClass(parents, methods, fields)
    }
}

fun bytesOf(name: String): ByteArray? =
    ProvidedClasses::class.java.classLoader.getResourceAsStream("$name.class")?.use { it.readBytes() }

/** The names of an enumeration's values, read from its file. */
fun enumNames(type: Class<*>): Set<String> {
    val name = type.name.replace('.', '/')
    val values = ProvidedClasses().find(name)!!.fields.filter { it.endsWith(" L$name;") }
    return values.map { it.substringBefore(' ') }.toSet()
}
