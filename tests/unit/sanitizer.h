#pragma once

namespace lightcull::testing {

/// True if the thread sanitizer instruments this build.
#if defined(__SANITIZE_THREAD__)
inline constexpr bool kThreadSanitizer = true;
#elif defined(__clang__)
inline constexpr bool kThreadSanitizer = __has_feature(thread_sanitizer);
#else
inline constexpr bool kThreadSanitizer = false;
#endif

/// True if the address sanitizer does, which ends a process that asks for memory there is not.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kAddressSanitizer = true;
#elif defined(__clang__)
inline constexpr bool kAddressSanitizer = __has_feature(address_sanitizer);
#else
inline constexpr bool kAddressSanitizer = false;
#endif

/// How often a test repeats what finds a rare wrong number, or makes a mean precise: `few` times
/// under a sanitizer. Code runs some thirty times slower there, and later times show it no more
/// races, or bad memory accesses, than the first few do.
template <typename Count>
constexpr Count repetitions(Count many, Count few) {
    return kThreadSanitizer || kAddressSanitizer ? few : many;
}

}  // namespace lightcull::testing
