package recon.msdk5

import org.objectweb.asm.ClassReader
import org.objectweb.asm.ClassVisitor
import org.objectweb.asm.MethodVisitor
import org.objectweb.asm.Opcodes
import org.objectweb.asm.Type
import java.io.File
import kotlin.test.Test
import kotlin.test.assertEquals
import kotlin.test.assertTrue

/**
 * Every class, method and field of DJI's SDK and of Android that the adapter refers to exists in the
 * signatures it was compiled against, and only `Msdk5` refers to DJI at all. DJI's own runtime is packed:
 * more than this cannot be checked without a phone.
 */
class LinkageTest {
    private val provided = ProvidedClasses()
    private val references = classFiles().associateWith(::referencesOf)

    @Test
    fun `nothing that the adapter refers to is missing`() {
        val all = references.values.flatten().toSet()
        assertTrue(all.count { it.owner.startsWith("dji/") } > 60, "${all.size} references")
        println("${all.size} references to DJI's SDK and Android, checked")
        assertEquals(emptyList(), all.filterNot(::exists).map { it.toString() })
    }

    @Test
    fun `only the thin layer refers to DJI`() {
        val files = references.filterValues { found -> found.any { it.owner.startsWith("dji/") } }.keys
        val isThinLayer = Regex("""Msdk5(\$.*)?\.class""")
        assertEquals(emptyList(), files.map { it.name }.filterNot(isThinLayer::matches))
    }

    @Test
    fun `a missing member would be found`() {
        assertTrue(!exists(Reference("dji/v5/manager/KeyManager", "getInstance ()V", isField = false)))
        assertTrue(!exists(Reference("dji/v5/manager/Absent", null, isField = false)))
        assertTrue(!exists(Reference("dji/sdk/keyvalue/key/FlightControllerKey", "KeyAbsent I", isField = true)))
    }

    private data class Reference(val owner: String, val member: String?, val isField: Boolean)

    private fun exists(reference: Reference): Boolean = when {
        reference.member == null -> provided.find(reference.owner) != null
        reference.isField -> provided.hasField(reference.owner, reference.member)
        else -> provided.hasMethod(reference.owner, reference.member)
    }

    private fun classFiles(): List<File> = File("target/classes").walk().filter { it.extension == "class" }.toList()

    private fun referencesOf(file: File): List<Reference> {
        val found = mutableListOf<Reference>()
        fun note(owner: String, member: String? = null, isField: Boolean = false) {
            if (owner.startsWith("dji/") || owner.startsWith("android/")) found += Reference(owner, member, isField)
        }
        fun noteTypes(descriptor: String) {
            val type = Type.getType(descriptor)
            val parts = if (type.sort == Type.METHOD) type.argumentTypes.toList() + type.returnType else listOf(type)
            parts.filter { it.sort == Type.OBJECT }.forEach { note(it.internalName) }
        }
        ClassReader(file.readBytes()).accept(ReferenceVisitor(::note, ::noteTypes), 0)
        return found
    }

    private class ReferenceVisitor(
        private val note: (String, String?, Boolean) -> Unit,
        private val noteTypes: (String) -> Unit,
    ) : ClassVisitor(Opcodes.ASM9) {
        override fun visit(v: Int, a: Int, name: String, s: String?, parent: String?, interfaces: Array<String>) {
            (listOfNotNull(parent) + interfaces).forEach { note(it, null, false) }
        }

        override fun visitMethod(
            a: Int, name: String, descriptor: String, s: String?, e: Array<String>?,
        ): MethodVisitor {
            noteTypes(descriptor)
            return Calls()
        }

        private inner class Calls : MethodVisitor(Opcodes.ASM9) {
            override fun visitMethodInsn(o: Int, owner: String, name: String, descriptor: String, i: Boolean) {
                note(owner, "$name $descriptor", false)
                noteTypes(descriptor)
            }

            override fun visitFieldInsn(o: Int, owner: String, name: String, descriptor: String) {
                note(owner, "$name $descriptor", true)
                noteTypes(descriptor)
            }

            override fun visitTypeInsn(o: Int, type: String) {
                if (!type.startsWith("[")) note(type, null, false)
            }
        }
    }
}
