//! Large buffers are mapped one by one, so that freeing one gives its memory back to the system.
//!
//! The C library keeps freed blocks of up to 32 MiB for itself once it has seen one of that size: after
//! a large image on each of 40 links the process stayed at 1 GB. This covers the buffers of the codec
//! alone; what other libraries do with their memory is unchanged.
#![allow(unsafe_code)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::ptr::null_mut;

/// Smaller blocks come from the system's allocator.
const MAPPED_FROM_BYTES: usize = 1024 * 1024;
/// Of every mapping.
const ALIGNED_BYTES: usize = 4096;

/// The allocator of this library.
pub struct MappedMemory;

fn is_mapped(size: usize, layout: Layout) -> bool {
    size >= MAPPED_FROM_BYTES && layout.align() <= ALIGNED_BYTES
}

// SAFETY: a block's size and alignment alone decide where it comes from, so it is freed where it was
// taken; `mmap` returns zeroed pages of its own, and `MAP_FAILED` becomes null.
unsafe impl GlobalAlloc for MappedMemory {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if !is_mapped(layout.size(), layout) {
            return unsafe { System.alloc(layout) };
        }
        let (access, kind) = (
            libc::PROT_READ | libc::PROT_WRITE,
            libc::MAP_PRIVATE | libc::MAP_ANONYMOUS,
        );
        or_null(unsafe { libc::mmap(null_mut(), layout.size(), access, kind, -1, 0) })
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        if is_mapped(layout.size(), layout) {
            unsafe { self.alloc(layout) }
        } else {
            unsafe { System.alloc_zeroed(layout) }
        }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        if is_mapped(layout.size(), layout) {
            unsafe { libc::munmap(block.cast(), layout.size()) };
        } else {
            unsafe { System.dealloc(block, layout) };
        }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        match (
            is_mapped(layout.size(), layout),
            is_mapped(new_size, layout),
        ) {
            (false, false) => unsafe { System.realloc(block, layout, new_size) },
            (true, true) => or_null(unsafe {
                libc::mremap(block.cast(), layout.size(), new_size, libc::MREMAP_MAYMOVE)
            }),
            _ => unsafe { self.moved(block, layout, new_size) },
        }
    }
}

impl MappedMemory {
    /// Copies a block to one of another size, and frees it.
    unsafe fn moved(&self, block: *mut u8, layout: Layout, new_size: usize) -> *mut u8 {
        // SAFETY: the caller of `realloc` guarantees that the new size is valid with this alignment.
        let new =
            unsafe { self.alloc(Layout::from_size_align_unchecked(new_size, layout.align())) };
        if !new.is_null() {
            unsafe {
                block.copy_to_nonoverlapping(new, layout.size().min(new_size));
                self.dealloc(block, layout);
            }
        }
        new
    }
}

fn or_null(block: *mut libc::c_void) -> *mut u8 {
    if block == libc::MAP_FAILED {
        null_mut()
    } else {
        block.cast()
    }
}
