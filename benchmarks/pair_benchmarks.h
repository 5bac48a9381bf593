#pragma once
/// Benchmarks of single pairs of shapes.

namespace tandem::bench {

/// Registers, by pair of shapes: the scalar distance, and a question to the batch checker about a
/// moving and a standing shape whose bounding spheres overlap while they are apart, by instruction
/// set. Pairs without a vector kernel show what the exact checker costs there.
void add_pairs();

}  // namespace tandem::bench
