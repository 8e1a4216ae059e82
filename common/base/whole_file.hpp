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

/// Returns the content of a file. Errors call the file by the noun `what` ("scene", "mesh"). Error
/// (bad input) if the file is a directory or cannot be opened; Error if it cannot be read to its
/// end.
std::string readText(const std::filesystem::path& file, std::string_view what);

/// Follows symbolic links from `file` to a path that is not a link, whether or not that path
/// exists. Returns `file` if it is not a link. Error if the links form a circle.
std::filesystem::path linkTarget(std::filesystem::path file);

/// Replaces `file`, or its target if it is a symbolic link, atomically: at any time the path holds
/// the complete old or the complete new content. `write` must write the new content to the path
/// that it gets (FILE.tmp); this file is then flushed to disk and renamed. If several processes or
/// threads replace one file, they do so one after the other. If `write` throws or the disk fails
/// (Error), FILE.tmp is removed. Error if `file` exists and is not a regular file (for example, a
/// device or a directory).
void replaceFile(const std::filesystem::path& file,
                 const std::function<void(const std::filesystem::path& aside)>& write);

/// Replaces `file` by these bytes. Errors call the file by the noun `what` ("page", "picture").
void replaceFile(const std::filesystem::path& file, std::string_view bytes, std::string_view what);

/// Replaces `file` by the result of `bytes`. That function may read the old content, because no
/// other process can replace the file in the meantime. If `mode` is 0600, other users can never
/// access the file, not even while it is written.
void replaceFile(const std::filesystem::path& file, const std::function<std::string()>& bytes,
                 std::string_view what, mode_t mode);

/// Writes all of `bytes` at `offset` of an open file, in several calls if necessary. Returns false,
/// with errno set, if the system accepts no more bytes.
bool writeAt(int descriptor, std::uint64_t offset, std::string_view bytes);

/// Flushes a folder (empty: the current one), so that files made, renamed or removed in it survive
/// a power failure. Error if the disk fails.
void syncFolder(const std::filesystem::path& folder);

/// Error if `file` is a directory, or unless its folder exists and is writable. Call this before
/// hours of work, so that the result can be written. `option` is the command-line option that the
/// message suggests for choosing another file.
void refuseUnwritable(const std::filesystem::path& file, const char* option);

/// Error (bad input) if `file`, which is about to be written, is one of the inputs, even under
/// another path. `option` is the command-line option that the message names.
void refuseInput(const std::filesystem::path& file, const char* option,
                 std::span<const std::filesystem::path> inputs);

}  // namespace palpate
