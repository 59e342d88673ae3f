#pragma once

#include <lightcull/export.h>
#include <lightcull/span.h>

#include <string>

namespace lightcull {

/// Writes a file that appears under its name whole or not at all, whatever happens meanwhile: it is
/// written beside the other as .NAME.lightcull-..., brought to the disk and renamed, and the folder
/// is brought to the disk, too. A file that a killed process has left there is removed by the next
/// write of that name. A file of that name is replaced, and where it is a link, what it leads to; a
/// folder, device or pipe is not. Throws Error with the path and the reason.
LIGHTCULL_EXPORT void write_whole_file(const std::string& path, Span<const unsigned char> bytes);

}  // namespace lightcull
