#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

// Files as wholes: read to their end, or replaced by new ones.

namespace palpate {

/// The whole of a file. `what` ("scene", "mesh") names it in errors: Error (bad input) when it is a
/// directory or cannot be opened, Error when it cannot be read to its end.
std::string readText(const std::filesystem::path& file, std::string_view what);

/// What symbolic links end at, whether it is there or not; `file` itself when it is none. Error for
/// links in a circle.
std::filesystem::path linkTarget(std::filesystem::path file);

/// Makes `file`, or what it is a symbolic link to, the old one or a whole new one, never something
/// between: `write` is given a name beside it (FILE.tmp), what it wrote there is flushed to disk
/// and renamed. One process or thread at a time does so; others wait. When `write` throws, or the
/// disk fails (Error), nothing is left of the attempt. Error for a device, a directory and the
/// like.
void replaceFile(const std::filesystem::path& file,
                 const std::function<void(const std::filesystem::path& aside)>& write);

/// The same with the bytes of the new file, which `what` ("page", "picture") names in errors.
void replaceFile(const std::filesystem::path& file, std::string_view bytes, std::string_view what);

/// The same with bytes that may be made from what `file` holds: nobody replaces it between `bytes`
/// and the new one. `mode`: 0600 where nobody else may read it, at no time.
void replaceFile(const std::filesystem::path& file, const std::function<std::string()>& bytes,
                 std::string_view what, mode_t mode);

/// Writes all of `bytes` at `offset` of an open file, however little the system takes at a time.
/// False, with errno, when it takes no more.
bool writeAt(int descriptor, std::uint64_t offset, std::string_view bytes);

/// So that files made, renamed or removed in `folder` (empty: the current one) are that after a
/// power cut too. Error when the disk fails.
void syncFolder(const std::filesystem::path& folder);

/// Error unless the folder of `file` is there and may be written: to be asked before hours of work.
/// `option`: what names another file, for the message.
void refuseUnwritable(const std::filesystem::path& file, const char* option);

/// Error (bad input) where `file` is, by whatever name, one of those that are read: it would
/// replace it. `option` as above.
void refuseInput(const std::filesystem::path& file, const char* option,
                 std::span<const std::filesystem::path> inputs);

}  // namespace palpate
