#pragma once

namespace lightcull::testing {

/// True if the thread sanitizer instruments this build. Code runs some thirty times slower in it,
/// and what is repeated to find a rare wrong number shows it no more races than the first few times
/// do.
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

}  // namespace lightcull::testing
