#pragma once
/// BRINK_WIDE before a function: it is compiled for several widths of registers, and the widest that the processor has is
/// taken where the program starts. Nothing is contracted (-ffp-contract=off), so the operations are the same in the same
/// order with any of them, and so are the bits. Not with clang, whose version 14 gives the clones a name that other
/// sources do not find.

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define BRINK_WIDE __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define BRINK_WIDE
#endif
