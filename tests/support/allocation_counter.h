#pragma once

namespace zwidth::test {

/// Heap allocations of this process so far, by `malloc`, `new` or any library. Always 0 under a sanitizer,
/// which brings an allocator of its own. Link allocation_counter.cpp to count.
long allocations();

}  // namespace zwidth::test
