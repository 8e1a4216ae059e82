#pragma once

#include <filesystem>
#include <functional>

namespace palpate {

/// Makes `file` the old one or a whole new one, never something between: `write` is given a name
/// beside it (FILE.tmp), what it wrote there is flushed to disk and renamed. When `write` throws,
/// or the disk fails (Error), nothing is left of the attempt.
void replaceFile(const std::filesystem::path& file,
                 const std::function<void(const std::filesystem::path& aside)>& write);

/// Error unless the folder of `file` is there and may be written: to be asked before hours of work.
/// `option`: what names another file, for the message.
void refuseUnwritable(const std::filesystem::path& file, const char* option);

}  // namespace palpate
