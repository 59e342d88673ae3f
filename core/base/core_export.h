#pragma once

#include <lightcull/export.h>

/// Marks names that are private to core, but used by another of its libraries: where those are
/// shared, such names have to be exported. No installed header declares them, and any build may
/// change them. One library of everything would bring Embree to hosts that want lights alone; the
/// same objects in two libraries would give a process two instruction sets in use, and two types of
/// one name.
#define LIGHTCULL_CORE_EXPORT LIGHTCULL_EXPORT
