#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>

// Reads and replaces whole files.

namespace palpate {

/// Returns the content of a file. `what` ("scene", "mesh") names it in errors. Error (bad input) if
/// it is a directory or cannot be opened; Error if it cannot be read to its end.
std::string readText(const std::filesystem::path& file, std::string_view what);

/// Follows symbolic links to their target, whether it exists or not; returns `file` if it is no
/// link. Error for a circle of links.
std::filesystem::path linkTarget(std::filesystem::path file);

/// Replaces `file`, or the target of a symbolic link, atomically: it is always the complete old or
/// new one. `write` gets a name beside it (FILE.tmp); the result is flushed to disk and renamed.
/// One process or thread at a time does so; others wait. If `write` throws or the disk fails
/// (Error), FILE.tmp is removed. Error for a device, a directory and the like.
void replaceFile(const std::filesystem::path& file,
                 const std::function<void(const std::filesystem::path& aside)>& write);

/// Replaces `file` by these bytes. `what` ("page", "picture") names it in errors.
void replaceFile(const std::filesystem::path& file, std::string_view bytes, std::string_view what);

/// Replaces `file` by the result of `bytes`, which may read the old content: no other process
/// replaces it in between. `mode` 0600 keeps the file private at all times.
void replaceFile(const std::filesystem::path& file, const std::function<std::string()>& bytes,
                 std::string_view what, mode_t mode);

/// Writes all of `bytes` at `offset` of an open file, in several calls if necessary. Returns false,
/// with errno set, if the system takes no more.
bool writeAt(int descriptor, std::uint64_t offset, std::string_view bytes);

/// Flushes a folder (empty: the current one), so that files made, renamed or removed in it survive
/// a power failure. Error if the disk fails.
void syncFolder(const std::filesystem::path& folder);

/// Error unless the folder of `file` exists and is writable. Call it before hours of work. `option`
/// is the option for another file name, for the message.
void refuseUnwritable(const std::filesystem::path& file, const char* option);

/// Error (bad input) if `file` is, under any name, one of the inputs, because it would replace it.
/// `option` as above.
void refuseInput(const std::filesystem::path& file, const char* option,
                 std::span<const std::filesystem::path> inputs);

}  // namespace palpate
