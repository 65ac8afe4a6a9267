#pragma once
/// BRINK_WIDE before a function: it is compiled for several widths of registers, and the widest that the processor has is
/// taken where the program starts. Nothing is contracted (-ffp-contract=off), so the operations are the same in the same
/// order with any of them, and so are the bits. Not with clang, whose version 14 gives the clones a name that other
/// sources do not find.

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)  // its clones are chosen before that is there
#define BRINK_WIDE __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define BRINK_WIDE
#endif

namespace brink {

/// Four numbers as one register, where there is one that wide: each operation is that of all four.
using Four = double __attribute__((vector_size(32), may_alias));

/// @pre `of` is aligned to 32 bytes
inline Four& four(double (&of)[4]) { return reinterpret_cast<Four&>(of); }
inline const Four& four(const double (&of)[4]) { return reinterpret_cast<const Four&>(of); }

}  // namespace brink
