#pragma once

#include <experimental/simd>

namespace meltscope {

/// Doubles that are worked on together. MELTSCOPE_SIMD_WIDTH sets it; otherwise the width of this target's
/// registers.
#if defined(MELTSCOPE_SIMD_WIDTH)
inline constexpr int lane_count = MELTSCOPE_SIMD_WIDTH;
#elif defined(__AVX512F__)
inline constexpr int lane_count = 8;
#elif defined(__AVX__)
inline constexpr int lane_count = 4;
#else
inline constexpr int lane_count = 2;
#endif

/// One lane group of doubles; `lane_count` = 1 is the scalar reference that tests compare with.
using Lanes = std::experimental::simd<double, std::experimental::simd_abi::deduce_t<double, lane_count>>;

/// Loads the lanes that start at `first`, any alignment.
inline Lanes load(const double* first) {
    return Lanes(first, std::experimental::element_aligned);
}

/// Stores the lanes from `first` on, any alignment.
inline void store(const Lanes& lanes, double* first) {
    lanes.copy_to(first, std::experimental::element_aligned);
}

/// Lane by lane: `yes` where `condition` holds, else `no`.
inline Lanes select(const Lanes::mask_type& condition, const Lanes& yes, const Lanes& no) {
#if defined(__clang__) && defined(__AVX512F__)
    // Under Clang, libstdc++ 12 blends by a bit mask as if it were one yes or no for all lanes (simd_x86.h,
    // _S_blend_avx512); hence also: no where() besides this one.
    return Lanes([&](int lane) { return condition[lane] ? yes[lane] : no[lane]; });
#else
    Lanes result = no;
    where(condition, result) = yes;
    return result;
#endif
}

/// For code that serves both a single double and a lane group.
inline double select(bool condition, double yes, double no) {
    return condition ? yes : no;
}

} // namespace meltscope
