package recon.msdk5

import org.objectweb.asm.ClassReader
import org.objectweb.asm.ClassVisitor
import org.objectweb.asm.MethodVisitor
import org.objectweb.asm.Opcodes
import org.objectweb.asm.Type
import java.io.File

/** A class of DJI or Android, or a member of it as `name descriptor`, that a compiled class refers to. */
data class Reference(val owner: String, val member: String?, val isField: Boolean)

/** Looks up what compiled classes refer to in the signatures on the class path. */
class Linkage {
    private val provided = ProvidedClasses()

    fun exists(reference: Reference): Boolean = when {
        reference.member == null -> provided.find(reference.owner) != null
        reference.isField -> provided.hasField(reference.owner, reference.member)
        else -> provided.hasMethod(reference.owner, reference.member)
    }

    /** The references of each class file in a folder. */
    fun referencesOf(folder: File): Map<File, List<Reference>> =
        folder.walk().filter { it.extension == "class" }.associateWith(::referencesIn)

    private fun referencesIn(file: File): List<Reference> {
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
