#pragma once

/// Marks what the libraries export: everything else in them is hidden. LIGHTCULL_STATIC is defined
/// while static libraries are compiled, so that a host's own library, linked with them, does not
/// export lightcull in its turn. Hosts define nothing.
#ifdef LIGHTCULL_STATIC
#define LIGHTCULL_EXPORT
#else
#define LIGHTCULL_EXPORT __attribute__((visibility("default")))
#endif
