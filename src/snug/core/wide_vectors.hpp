// Wide vectors: whether functions can be compiled for processors with wider vectors than every one has.
#pragma once

/// 1: `__attribute__((target("avx2")))` and `__builtin_cpu_supports("avx2")` are there. What is chosen by the processor
/// has the same bytes on all.
#if defined(__x86_64__) && defined(__GNUC__)
#define SNUG_HAS_WIDE_VECTORS 1
#else
#define SNUG_HAS_WIDE_VECTORS 0
#endif
